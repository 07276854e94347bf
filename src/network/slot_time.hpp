// How long packets of synaptic vectors are under way: what a slot must hold (SYN-16).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/time.hpp"
#include "network/channels/channel_message.hpp"
#include "network/clock/tick_plan.hpp"
#include "network/wire.hpp"

namespace rubicon::network {

/// What medium access adds to a frame's time on the air. By default that of IEEE 802.15.4-2006
/// 7.5.1.4: seven periods of 320 us; an assessment and a turnaround, and 544 us for the
/// acknowledgement; and a LIFS of 640 us.
struct access_times {
  duration back_off = 2240us; ///< the longest first one
  duration exchange = 864us;  ///< assessment, turnaround and acknowledgement
  duration space = 640us;     ///< between two frames of one mote
  /// Where radios listen at low power a frame is repeated for so long until its receiver is on,
  /// half of it on average; 0: radios are on.
  duration wake{};

  /// For time-outs: what frames there and back may take longer.
  [[nodiscard]] constexpr duration answer_slack(unsigned hops) const {
    return static_cast<duration::rep>(2 + hops) * wake;
  }

  friend bool operator==(const access_times&, const access_times&) = default;
};

/// Where radios listen at low power, rounds of the clock are so many times access_times::wake apart
/// at least.
inline constexpr int round_lengths = 60;

/// From the end of a mote's acknowledgement until its receiver is ready to assess the channel (IEEE
/// 802.15.4-2006 6.9.2): the next hop's back-off begins then.
inline constexpr duration turn_back = 192us;

/// On the air, with an acknowledgement. @param payload octets of the radio frame
[[nodiscard]] constexpr duration exchange_time(std::size_t payload, const access_times& access) {
  constexpr duration octet = 32us;
  constexpr std::size_t headers = 6 + 11 + 2; // preamble to length, MAC to AM type, FCS
  return static_cast<duration::rep>(payload + headers) * octet + access.exchange;
}

/// A packet of a channel is handed on by one mote after the other. The first has its slot and needs
/// no back-off; the next packet begins when this one has arrived, so that they never meet where
/// motes do not receive each other.
/// @param octets content of the packet @pre hops > 0
[[nodiscard]] constexpr duration passage(std::size_t octets, std::size_t hops,
                                         const access_times& access) {
  const auto frame = exchange_time(octets + channel_header_size + 1, access);
  const auto more = static_cast<duration::rep>(hops) - 1;
  return frame + access.space + more * (turn_back + access.back_off + frame);
}

/// The same of content for the sink or another island, which needs a slot for its first hop only:
/// further ones are in the free part. It may go in several frames.
[[nodiscard]] constexpr duration passage_up(std::size_t octets, const access_times& access) {
  constexpr std::size_t headers = 24; // of a tunnel, an island packet and the tree
  constexpr std::size_t in_one = 80;  // else it is cut
  const auto frames = (octets + in_one - 1) / in_one;
  return static_cast<duration::rep>(frames) *
         (exchange_time(octets / frames + headers, access) + access.space);
}

/// Clocks of motes differ, and programs take their time.
inline constexpr duration slot_guard = 800us;

/// Units of a slot that holds passages of so long, none of which has been followed by another's.
[[nodiscard]] constexpr std::uint16_t units_for(duration passages, const access_times& access) {
  if (passages <= 0ns)
    return 0;
  const auto whole = passages - access.space + slot_guard + tick_plan::unit - 1ns;
  return static_cast<std::uint16_t>(std::min<duration::rep>(whole / tick_plan::unit, UINT16_MAX));
}

} // namespace rubicon::network
