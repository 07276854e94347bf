// What is to be written and shown of a run beside its report.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace rubicon::cli {

/// Where a live page is served.
struct page_place {
  std::string address = "127.0.0.1";   ///< IPv4
  std::uint16_t port = 0;              ///< 0: the system chooses
  std::vector<std::string> hosts = {}; ///< other names under which browsers may reach it
};

/// Where metrics are served.
struct metrics_place {
  page_place at;
  bool motes = false; ///< of each mote too
};

/// What the command line asks for; empty names: nothing.
struct watch_options {
  std::string page_file;                ///< HTML goes here
  std::string csv_folder;               ///< tables go here
  std::optional<duration> csv_every;    ///< between two samples; unset: a hundredth of the run
  std::optional<page_place> view;       ///< serves the live page
  std::optional<metrics_place> metrics; ///< serves metrics
  bool control = false;                 ///< which lets faults happen, and tuples be set
  bool control_kernel = false;          ///< also those by which kernels are steered
};

} // namespace rubicon::cli
