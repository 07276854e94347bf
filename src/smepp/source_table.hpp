// Senders who have not shown who they are: what was heard of each, and what may be done for it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/address.hpp"
#include "smepp/allowance.hpp"

namespace rubicon::smepp {

/// Each sender with its own allowance: who speaks in many names spoils none of the others'. Who has
/// been silent for a minute gives way; those that find no room share one allowance.
class source_table {
public:
  /// So long a counter that was heard keeps lower ones out. Who has the network's keys can make a
  /// mote unheard for that long with one frame, and no longer.
  static constexpr duration memory = 60s;
  static constexpr duration pause = 2s; ///< in the long run, between what is done for one sender

  explicit source_table(std::size_t capacity = 12, unsigned burst = 8)
      : capacity_(capacity), burst_(burst), others_(burst, pause) {}

  /// Whether a frame with that counter may be what was heard before.
  [[nodiscard]] bool is_old(mote_id who, std::uint64_t counter, instant now) const {
    const auto found = std::ranges::find(all_, who, &source::who);
    return found != all_.end() && found->has_counter && now < found->heard + memory &&
           counter <= found->counter;
  }

  /// It was authentic.
  void hear(mote_id who, std::uint64_t counter, instant now) {
    auto* const x = entry(who, now);
    if (x == nullptr)
      return;
    x->counter = counter;
    x->heard = now;
    x->has_counter = true;
  }

  /// @returns whether one more thing may be done for it now, and then counts it
  [[nodiscard]] bool take(mote_id who, instant now) {
    auto* const x = entry(who, now);
    return x != nullptr ? x->may.take(now) : others_.take(now);
  }

  /// Octets on a mote: mote, counter, seconds since it was heard and until its allowance is whole.
  [[nodiscard]] std::size_t footprint() const { return capacity_ * (2 + 8 + 2 + 2); }

private:
  struct source {
    mote_id who;
    bool has_counter = false;
    std::uint64_t counter = 0;
    instant heard;
    allowance may;
  };

  source* entry(mote_id who, instant now) {
    const auto found = std::ranges::find(all_, who, &source::who);
    if (found != all_.end())
      return &*found;
    if (all_.size() >= capacity_)
      std::erase_if(all_, [&](const source& x) { return x.heard + memory <= now; });
    if (all_.size() >= capacity_)
      return nullptr;
    return &all_.emplace_back(source{who, false, 0, now, allowance(burst_, pause)});
  }

  std::size_t capacity_;
  unsigned burst_;
  std::vector<source> all_;
  allowance others_;
};

} // namespace rubicon::smepp
