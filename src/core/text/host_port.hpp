// Where something listens, as people write it: `host:9002`, `127.0.0.1:9002`.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace rubicon {

struct host_port {
  std::string host; ///< whatever stands before the last colon
  std::uint16_t port = 0;
};

/// Nothing: there is no colon with a port from 1 to 65535 behind it.
[[nodiscard]] inline std::optional<host_port> parse_host_port(std::string_view text) {
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos)
    return std::nullopt;
  host_port x{std::string(text.substr(0, colon))};
  const auto* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, x.port);
  return error == std::errc{} && stop == end && x.port > 0 ? std::optional(x) : std::nullopt;
}

} // namespace rubicon
