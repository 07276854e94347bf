// Which routes to a destination cannot lead back to us: the condition of Babel (RFC 8966 2.4).
#pragma once

#include <cstdint>

#include "network/wire.hpp"

namespace rubicon::network {

/// The best route to one destination that this node has ever advertised to others. The destination
/// counts a sequence number up; who receives (sequence, cost) may only use it if it is newer, or
/// nearer at the same sequence number, than all that the node itself has advertised. Along a path
/// of such choices that pair gets strictly better, so no path is a loop and no node counts to
/// infinity; a node without such a route waits for the next sequence number.
class feasibility {
public:
  [[nodiscard]] bool admits(std::uint16_t sequence, std::uint16_t cost) const {
    return !has_advertised_ || is_newer(sequence, sequence_) ||
           (sequence == sequence_ && cost < cost_);
  }

  /// This node advertises (sequence, cost).
  void advertise(std::uint16_t sequence, std::uint16_t cost) {
    if (admits(sequence, cost))
      *this = feasibility(sequence, cost);
  }

  /// @returns whether anything has been advertised
  [[nodiscard]] bool has_advertised() const { return has_advertised_; }
  [[nodiscard]] std::uint16_t sequence() const { return sequence_; }

  feasibility() = default;

private:
  feasibility(std::uint16_t sequence, std::uint16_t cost)
      : has_advertised_(true), sequence_(sequence), cost_(cost) {}

  bool has_advertised_ = false;
  std::uint16_t sequence_ = 0;
  std::uint16_t cost_ = 0;
};

} // namespace rubicon::network
