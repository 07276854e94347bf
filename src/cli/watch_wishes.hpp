// What is to be written of a run beside its report.
#pragma once

#include <optional>
#include <string>

#include "core/time.hpp"

namespace rubicon::cli {

/// What the command line asks for; empty names: nothing.
struct watch_wishes {
  std::string page_file;             ///< HTML goes here
  std::string csv_folder;            ///< tables go here
  std::optional<duration> csv_every; ///< between two samples; unset: a hundredth of the run
};

} // namespace rubicon::cli
