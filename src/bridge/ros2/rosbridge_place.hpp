// Where a rosbridge is, as people write it.
#pragma once

#include <optional>
#include <string_view>

#include "core/text/host_port.hpp"

namespace rubicon::bridge {

struct rosbridge_place {
  host_port where;
  bool tls = false;
};

/// `robot.local:9090`, `ws://robot.local:9090`, or `wss://robot.local:9090` with TLS.
/// @returns nothing if it is none of them
[[nodiscard]] inline std::optional<rosbridge_place> parse_rosbridge_place(std::string_view text) {
  constexpr std::string_view plain = "ws://";
  constexpr std::string_view secure = "wss://";
  rosbridge_place out;
  out.tls = text.starts_with(secure);
  if (out.tls)
    text.remove_prefix(secure.size());
  else if (text.starts_with(plain))
    text.remove_prefix(plain.size());
  const auto where = parse_host_port(text);
  if (!where || where->host.empty() || where->host.find('/') != std::string::npos)
    return std::nullopt;
  out.where = *where;
  return out;
}

} // namespace rubicon::bridge
