// What a file may say about the firmware of a mote.
#pragma once

#include <memory>

#include "firmware/library.hpp"

namespace rubicon::firmware {

struct program_config {
  std::shared_ptr<const library> code; ///< nullptr: its file was not read
  bool isolate = false;                ///< it runs in a process of its own
};

} // namespace rubicon::firmware
