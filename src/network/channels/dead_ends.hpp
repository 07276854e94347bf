// Set-ups of channels that a mote has sent back, and refuses when they come again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "network/channels/channel_message.hpp"

namespace rubicon::network {

class dead_ends {
public:
  static constexpr std::size_t count_max = 3;

  /// Where there are too many the oldest is forgotten: its message may pass here again.
  void add(channel_id channel, instant until) {
    if (all_.size() >= count_max)
      all_.erase(all_.begin());
    all_.push_back({channel, until});
  }

  [[nodiscard]] bool contains(channel_id channel) const {
    return std::ranges::find(all_, channel, &dead_end::channel) != all_.end();
  }

  void on_time(instant now) {
    std::erase_if(all_, [now](const dead_end& x) { return x.until <= now; });
  }

  [[nodiscard]] std::optional<instant> deadline() const {
    std::optional<instant> next;
    for (const auto& x : all_)
      next = earliest(next, x.until);
    return next;
  }

private:
  struct dead_end {
    channel_id channel;
    instant until;
  };

  std::vector<dead_end> all_; ///< the oldest first
};

} // namespace rubicon::network
