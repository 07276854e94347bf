// The message of ports 1 and 2: which peers a package passes (peis-wire.md 13, API-12).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/codec.hpp"
#include "core/error.hpp"

namespace rubicon::peis {

inline constexpr std::size_t trace_hosts_max = 15;

struct trace_message {
  std::vector<peer_id> hosts; ///< the asker first, 1 to 15
};

/// 64 octets. @pre 1 to 15 hosts
[[nodiscard]] inline bytes encode(const trace_message& x) {
  byte_writer to;
  to.big(static_cast<std::int32_t>(x.hosts.size()));
  for (std::size_t i = 0; i < trace_hosts_max; ++i)
    to.big(i < x.hosts.size() ? x.hosts[i].value : 0);
  return to.finish();
}

/// truncated; bad_value unless there are 1 to 15 hosts.
[[nodiscard]] inline result<trace_message> decode_trace(byte_view octets) {
  byte_reader from(octets);
  const auto count = from.big<std::int32_t>();
  trace_message x;
  for (std::size_t i = 0; i < trace_hosts_max; ++i) {
    const peer_id host{from.big<std::int32_t>()};
    if (count > 0 && i < static_cast<std::size_t>(count))
      x.hosts.push_back(host);
  }
  if (!from.ok())
    return errc::truncated;
  if (count < 1 || static_cast<std::size_t>(count) > trace_hosts_max)
    return errc::bad_value;
  return x;
}

} // namespace rubicon::peis
