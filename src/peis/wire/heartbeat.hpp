// What marked neighbours send each other on port 8 (KH-05): a sign of life, and what the
// round trip is measured with. Real kernels have no use for this port.
#pragma once

#include <cstdint>

#include "core/bytes.hpp"
#include "core/codec.hpp"
#include "core/error.hpp"
#include "core/time.hpp"

namespace rubicon::peis {

/// Times are of the clocks of those who took them, in nanoseconds; only differences mean anything.
struct heartbeat {
  instant sent;    ///< by the sender's clock
  instant echoed;  ///< `sent` of the last one that came, by the receiver's clock; zero: none came
  duration held{}; ///< between its arrival and this sending
};

/// 24 octets.
[[nodiscard]] inline bytes encode(const heartbeat& x) {
  byte_writer to;
  to.big(std::int64_t{x.sent.time_since_epoch().count()});
  to.big(std::int64_t{x.echoed.time_since_epoch().count()});
  to.big(std::int64_t{x.held.count()});
  return to.finish();
}

[[nodiscard]] inline result<heartbeat> decode_heartbeat(byte_view octets) {
  byte_reader from(octets);
  const instant sent{duration(from.big<std::int64_t>())};
  const instant echoed{duration(from.big<std::int64_t>())};
  const duration held{from.big<std::int64_t>()};
  if (!from.ok())
    return errc::truncated;
  constexpr duration century = 24h * 365 * 100; // beyond it sums could overflow
  for (const auto x : {sent.time_since_epoch(), echoed.time_since_epoch(), held}) {
    if (x < 0s || x > century)
      return errc::bad_value;
  }
  return heartbeat{sent, echoed, held};
}

} // namespace rubicon::peis
