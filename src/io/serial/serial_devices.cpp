#include "io/serial/serial_devices.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <unistd.h>

namespace rubicon::io {

std::string why_closed(const std::string& path) {
  return ::access(path.c_str(), R_OK | W_OK) == 0 ? "" : std::generic_category().message(errno);
}

std::vector<serial_device> serial_devices() {
  std::vector<serial_device> out;
  std::error_code error;
  for (const auto& each : std::filesystem::directory_iterator("/dev", error)) {
    const auto name = each.path().filename().string();
    if (!name.starts_with("ttyUSB") && !name.starts_with("ttyACM"))
      continue;
    out.push_back({each.path().string(), why_closed(each.path().string())});
  }
  std::ranges::sort(out, {}, &serial_device::path);
  return out;
}

} // namespace rubicon::io
