// The clock that all peers share (docs/peis-wire.md 12, CLK-06, CLK-07).
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "core/network_time.hpp"
#include "core/time.hpp"

namespace rubicon::peis {

/// The message of port 11. Real kernels leave garbage in the last three octets; between marked
/// peers they hold the microseconds that the message has been in flight, which each link's end adds
/// up.
struct clock_message {
  duration network_time{}; ///< since 1970, whole microseconds
  bool master = false;
  duration in_flight{}; ///< 0 to 16.7 s; only marked peers' means anything
};

/// Of the seconds the wire has the low 32 bits.
[[nodiscard]] bytes encode(const clock_message& x);

/// @param known our network time: of all times with these low 32 bits of seconds the nearest to it
/// is meant
/// @returns truncated, or bad_value for microseconds beyond a second, and a time that is not from
/// 1970 until network_time_end
[[nodiscard]] result<clock_message> decode_clock(byte_view octets, duration known);

struct clock_config {
  bool master = false;  ///< its time is that of all peers, forwards and backwards
  duration period = 2s; ///< between two broadcasts
  duration offset{};    ///< of the local clock: network time at ecology time zero
  std::int64_t ppb = 0; ///< by which the local clock runs fast, parts per billion
  duration quiet = 7s;  ///< no broadcast for so long after a better one was received
};

/// Network time as one peer sees it. Between equals the fastest clock wins; the highest id keeps
/// broadcasting and the others are quiet while they agree with it. Only tuples' times use it: all
/// timers run on ecology time, so that a step fires none of them (SCH-07).
class network_clock {
public:
  network_clock() = default;
  network_clock(clock_config config, peer_id self, instant now);

  /// What is added to ecology time.
  [[nodiscard]] duration offset() const { return offset_; }
  /// Network time at an ecology time.
  [[nodiscard]] duration at(instant x) const { return x.time_since_epoch() + offset_; }
  /// How far the last broadcast received was from our time, after it was corrected for its route.
  [[nodiscard]] duration last_error() const { return last_error_; }

  /// @param in_transit how long the message was in flight; 0 if not known
  /// @param marked the sender is of our kind: its route is measured, so a millisecond counts
  void on_message(const clock_message& x, peer_id source, duration in_transit, bool marked,
                  instant now);

  /// The broadcast that is due.
  [[nodiscard]] std::optional<clock_message> on_time(instant now);
  [[nodiscard]] instant deadline() const { return next_; }
  void put_off(instant until) { next_ = std::max(next_, until); }

  /// The local clock was set to another time: what others will see of us from now on. It is not
  /// set to a time before 1970, nor from network_time_end on.
  void step(duration by, instant now);

private:
  void drift(instant now);

  clock_config config_;
  peer_id self_;
  duration offset_{};
  instant drifted_; ///< until when it is in the offset
  duration last_error_{};
  instant next_;
};

} // namespace rubicon::peis
