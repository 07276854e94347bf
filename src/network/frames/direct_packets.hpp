// Content for neighbours, which goes to them without the tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/small_map.hpp"
#include "network/frames/frame_out.hpp"

namespace rubicon::network {

struct direct_packet {
  mote_id to;
  bytes content;
  provenance from = {};
};

/// Bounded: at most packets_max, those that wait for their turn and those that are on the air.
class direct_packets {
public:
  direct_packets() = default;
  explicit direct_packets(std::size_t packets_max) : packets_max_(packets_max) {}

  [[nodiscard]] bool is_full() const { return packets_.size() >= packets_max_; }
  [[nodiscard]] bool has_waiting() const { return !waiting_.empty(); }

  /// @param frame in which the content goes @pre !is_full()
  void add(frame_out frame, bytes content) {
    packets_[frame.token] = {frame.next_hop, std::move(content)};
    waiting_.push_back(std::move(frame));
  }

  /// There is a turn: all may leave, in the order of add().
  [[nodiscard]] std::vector<frame_out> take_waiting() { return std::exchange(waiting_, {}); }

  /// @returns what was sent with this token, if anything
  [[nodiscard]] std::optional<direct_packet> on_sent(std::uint64_t token) {
    return packets_.extract(token);
  }

private:
  std::size_t packets_max_ = 0;
  small_map<std::uint64_t, direct_packet> packets_; ///< by token
  std::vector<frame_out> waiting_;
};

} // namespace rubicon::network
