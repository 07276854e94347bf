// Serial devices of this computer, such as basestation motes on USB.
#pragma once

#include <string>
#include <vector>

namespace rubicon::io {

struct serial_device {
  std::string path;    ///< `/dev/ttyUSB0`
  std::string problem; ///< why we cannot open it; empty: we could
};

/// USB ones, in the order of their names.
[[nodiscard]] std::vector<serial_device> serial_devices();

} // namespace rubicon::io
