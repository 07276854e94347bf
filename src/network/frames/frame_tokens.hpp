// The tokens of the frames that a router hands to the radio, and what each stands for.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/small_map.hpp"

namespace rubicon::network {

enum class frame_purpose : std::uint8_t { beacon, packet, channel, direct };

class frame_tokens {
public:
  [[nodiscard]] std::uint64_t issue(frame_purpose x) {
    return frames_++ << purpose_bits | static_cast<std::uint64_t>(x);
  }
  [[nodiscard]] static frame_purpose purpose_of(std::uint64_t token) {
    return static_cast<frame_purpose>(token & ((1U << purpose_bits) - 1));
  }

  /// The frame is a unicast that has been handed to the radio.
  void on_unicast(std::uint64_t token, mote_id to) { unicasts_[token] = to; }
  /// Its end. @returns to whom it was sent; nothing: it was no unicast
  [[nodiscard]] std::optional<mote_id> on_sent(std::uint64_t token) {
    return unicasts_.extract(token);
  }

private:
  static constexpr unsigned purpose_bits = 2;

  std::uint64_t frames_ = 0;
  small_map<std::uint64_t, mote_id> unicasts_;
};

} // namespace rubicon::network
