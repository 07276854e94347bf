#include "io/serial_devices.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <unistd.h>

namespace rubicon::io {

std::vector<serial_device> serial_devices() {
  std::vector<serial_device> out;
  std::error_code error;
  for (const auto& each : std::filesystem::directory_iterator("/dev", error)) {
    const auto name = each.path().filename().string();
    if (!name.starts_with("ttyUSB") && !name.starts_with("ttyACM"))
      continue;
    const bool usable = ::access(each.path().c_str(), R_OK | W_OK) == 0;
    out.push_back({each.path().string(), usable ? "" : std::generic_category().message(errno)});
  }
  std::ranges::sort(out, {}, &serial_device::path);
  return out;
}

} // namespace rubicon::io
