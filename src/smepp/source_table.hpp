// Senders that are not authenticated: what was last received from each, and its rate limit.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/address.hpp"
#include "smepp/rate_limiter.hpp"

namespace rubicon::smepp {

/// Each sender has its own rate limiter: who sends in many names does not use up that of others.
/// The entry of one silent for a minute is reused; senders without an entry share one rate limiter.
class source_table {
public:
  /// For so long a received counter keeps lower ones out. Who has the network's keys can suppress a
  /// mote's frames for that long with one frame, and no longer.
  static constexpr duration memory = 60s;
  static constexpr duration pause = 2s; ///< in the long run, between what is done for one sender

  explicit source_table(std::size_t capacity = 12, unsigned burst = 8)
      : capacity_(capacity), burst_(burst), others_(burst, pause) {}

  /// Whether a frame with that counter may be one that was received before.
  [[nodiscard]] bool is_old(mote_id who, std::uint64_t counter, instant now) const {
    const auto found = std::ranges::find(all_, who, &source::who);
    return found != all_.end() && found->has_counter && now < found->received_at + memory &&
           counter <= found->counter;
  }

  /// It was authentic.
  void note(mote_id who, std::uint64_t counter, instant now) {
    auto* const x = entry(who, now);
    if (x == nullptr)
      return;
    x->counter = counter;
    x->received_at = now;
    x->has_counter = true;
  }

  /// @returns whether one more thing may be done for it now, and then counts it
  [[nodiscard]] bool take(mote_id who, instant now) {
    auto* const x = entry(who, now);
    return x != nullptr ? x->limiter.take(now) : others_.take(now);
  }

  /// Octets on a mote: mote, counter, seconds since it was received and until its limiter has its
  /// full burst.
  [[nodiscard]] std::size_t footprint() const { return capacity_ * (2 + 8 + 2 + 2); }

private:
  struct source {
    mote_id who;
    bool has_counter = false;
    std::uint64_t counter = 0;
    instant received_at;
    rate_limiter limiter;
  };

  source* entry(mote_id who, instant now) {
    const auto found = std::ranges::find(all_, who, &source::who);
    if (found != all_.end())
      return &*found;
    if (all_.size() >= capacity_)
      std::erase_if(all_, [&](const source& x) { return x.received_at + memory <= now; });
    if (all_.size() >= capacity_)
      return nullptr;
    return &all_.emplace_back(source{who, false, 0, now, rate_limiter(burst_, pause)});
  }

  std::size_t capacity_;
  unsigned burst_;
  std::vector<source> all_;
  rate_limiter others_;
};

} // namespace rubicon::smepp
