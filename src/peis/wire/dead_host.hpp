// The message of port 9: a peer exits, or has been given up (peis-wire.md 11).
#pragma once

#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/codec.hpp"
#include "core/error.hpp"

namespace rubicon::peis {

struct dead_host_message {
  enum class reason : std::int32_t {
    message = 0, ///< deleted because of such a message; never sent
    route = 1,   ///< exit, or no route any more: delete the host named
    reborn = 2,  ///< the sender has forgotten the receiver's subscriptions
  };

  peer_id host;
  reason why = reason::route;
};

/// 8 octets.
[[nodiscard]] inline bytes encode(const dead_host_message& x) {
  byte_writer to;
  to.big(x.host.value).big(static_cast<std::int32_t>(x.why));
  return to.finish();
}

/// truncated; bad_value for a reason that does not exist.
[[nodiscard]] inline result<dead_host_message> decode_dead_host(byte_view octets) {
  byte_reader from(octets);
  const peer_id host{from.big<std::int32_t>()};
  const auto why = from.big<std::int32_t>();
  if (!from.ok())
    return errc::truncated;
  if (why < 0 || why > 2)
    return errc::bad_value;
  return dead_host_message{host, static_cast<dead_host_message::reason>(why)};
}

} // namespace rubicon::peis
