// Serial devices of this computer, such as basestation motes on USB.
#pragma once

#include <string>
#include <vector>

namespace rubicon::io {

struct serial_device {
  std::string path;    ///< `/dev/ttyUSB0`
  std::string problem; ///< why we cannot open it; empty: we could
};

/// Why this file cannot be opened for reading and writing; empty: it can.
[[nodiscard]] std::string why_closed(const std::string& path);

/// USB ones, in the order of their names.
[[nodiscard]] std::vector<serial_device> serial_devices();

} // namespace rubicon::io
