// When a mote's radio has to be on: the union of what all channels through it need (NRG-02..04).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "core/island_time.hpp"

namespace rubicon::network {

/// A need for the radio that comes back: from `before` ahead of first + k * interval until `after`
/// behind it, for all k; on either side longer by the guard, which grows with the doubt that its
/// owner is in about the time.
struct radio_need {
  island_time first;
  std::chrono::microseconds interval{}; ///< > 0
  std::chrono::microseconds before{};   ///< time to switch on
  std::chrono::microseconds after{}; ///< longest wait for a late packet; before + after < interval
};

class radio_schedule {
public:
  using microseconds = std::chrono::microseconds;

  /// @param key chosen by the owner
  void set(std::uint64_t key, const radio_need& x) { needs_[key] = {x, island_time::min()}; }
  void remove(std::uint64_t key) { needs_.erase(key); }

  /// What this need was waiting for has come and gone on: it is over until its next time.
  void served(std::uint64_t key, island_time now, microseconds guard = {});

  [[nodiscard]] bool is_on(island_time now, microseconds guard = {}) const;

  /// The next time after `now` at which is_on() may be another; nothing without needs.
  [[nodiscard]] std::optional<island_time> next_change(island_time now,
                                                       microseconds guard = {}) const;

  [[nodiscard]] std::size_t size() const { return needs_.size(); }

private:
  struct entry {
    radio_need need;
    island_time served_until; ///< nothing is needed before
  };

  /// One turn of a need.
  struct turn {
    island_time begin;
    island_time end;
  };
  /// The turn that has not ended at that time.
  [[nodiscard]] static turn turn_at(const entry& x, island_time now, microseconds guard);

  std::map<std::uint64_t, entry> needs_;
};

} // namespace rubicon::network
