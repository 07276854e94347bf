// Packets of channels with a schedule, which wait for the turns of their channels.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bytes.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "stream/events.hpp"

namespace rubicon::mote {

/// Where radios sleep, a channel with a schedule carries a packet each time that the next mote
/// wakes up for it. One leaves at each turn, in order: who reads a stream drops what newer records
/// have overtaken.
class channel_pacer {
public:
  static constexpr std::size_t packets_max = 4; ///< of one channel; the oldest is dropped

  /// @param turn the next of the channel
  /// @returns whether a packet was dropped
  [[nodiscard]] bool push(stream::channel_handle channel, instant turn, bytes octets,
                          provenance from);

  /// Calls `send(channel, octets)` for each packet whose turn has come, and then
  /// `next_turn(channel)`, which returns nothing if packets of it may leave at any time.
  template <class Send, class NextTurn>
  void send_due(instant now, Send send, NextTurn next_turn) {
    for (auto x = waiting_.begin(); x != waiting_.end();) {
      auto& [channel, its] = *x;
      if (its.due > now) {
        ++x;
        continue;
      }
      for (auto left = at_a_turn(its); left > 0; --left) {
        auto& [octets, from] = its.packets.front();
        const acting_on packet(from);
        send(channel, std::move(octets));
        its.packets.erase(its.packets.begin());
      }
      if (its.packets.empty()) {
        x = waiting_.erase(x);
        continue;
      }
      const std::optional<instant> next = next_turn(channel);
      its.due = next.value_or(now); // there are no turns any more: all may leave
      x = next ? std::next(x) : x;
    }
  }

  [[nodiscard]] std::optional<instant> deadline() const;

private:
  static constexpr std::size_t usual_max = 2; ///< packets of one channel without hurry

  struct queue {
    instant due;                                       ///< the channel's turn
    std::vector<std::pair<bytes, provenance>> packets; ///< few, the oldest first
  };

  /// Turns may come a little less often than packets: then two leave one after the other.
  [[nodiscard]] static int at_a_turn(const queue& x) {
    return x.packets.size() > usual_max ? 2 : 1;
  }

  small_map<stream::channel_handle, queue> waiting_; ///< none without packets
};

} // namespace rubicon::mote
