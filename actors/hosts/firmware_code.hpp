// The code of a mote's firmware, loaded.
#pragma once

#include <memory>

#include "firmware/code.hpp"
#include "firmware/program_config.hpp"

namespace rubicon {

/// A copy of the library for one mote. @pre x has code
/// @throws std::runtime_error if it cannot be loaded
[[nodiscard]] std::unique_ptr<firmware::code> load_firmware(const firmware::program_config& x);

} // namespace rubicon
