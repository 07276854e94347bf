// Which counters of which senders have been seen.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "smepp/group_id.hpp"

namespace rubicon::smepp {

/// A pair of session keys as its receiver numbers it: those it has learned later are higher.
using key_order = std::uint32_t;

/// For each sender in each group, under each pair of session keys, the highest counter accepted and
/// which of the 31 below it were (RFC 4303 3.4.3). One window a group: who has the keys of one
/// cannot spoil another's. One window a pair of keys: whatever a member does to the windows of
/// others ends with the keys that it had.
///
/// A sender without a window is not believed: it may be a recording. It gets one when it has proven
/// that it is speaking now (security.hpp). So nothing need be stored: a mote that has lost its
/// windows with its memory, and a table that had to give one up, ask again. Under keys that were
/// learned while a sender had a window it goes on with a new one: what was recorded under them has
/// not been taken before.
///
/// A counter far from the window is not believed either: no single frame moves a window further.
class replay_windows {
public:
  enum class verdict : std::uint8_t { fresh, replayed, unknown };
  static constexpr std::uint64_t jump_max = 1U << 16;

  explicit replay_windows(std::size_t capacity = 24) : capacity_(capacity) {}

  /// Changes nothing: what is not authentic yet must not move a window.
  [[nodiscard]] verdict judge(mote_id sender, group_id group, key_order under,
                              std::uint64_t counter) const;

  /// It was authentic and fresh. @pre judge() said so
  void accept(mote_id sender, group_id group, key_order under, std::uint64_t counter);

  /// It has proven that this is its counter now, whatever its window was. A full table gives up the
  /// windows of the sender that was received longest ago.
  /// @param newest of the keys that are known
  void begin(mote_id sender, group_id group, key_order under, key_order newest,
             std::uint64_t counter);

  void forget(group_id group, key_order under); ///< nothing is accepted under those keys any more
  void forget(group_id group);

  [[nodiscard]] std::size_t size() const { return windows_.size(); }
  [[nodiscard]] std::uint64_t evicted() const { return evicted_; }
  /// Octets on a mote: mote, group, keys (2 of 16 bits), counter, bits, and its place in the order.
  [[nodiscard]] std::size_t footprint() const { return capacity_ * (2 + 2 + 2 + 2 + 8 + 4 + 1); }

private:
  struct window {
    mote_id sender;
    group_id group;
    key_order under = 0;
    key_order newest = 0; ///< when it began: its sender may have sent under these before
    std::uint64_t highest = 0;
    std::uint32_t seen = 0; ///< bit i: highest - i
  };

  [[nodiscard]] std::optional<std::size_t> find(mote_id sender, group_id group,
                                                key_order under) const;
  [[nodiscard]] bool may_go_on(mote_id sender, group_id group, key_order under) const;
  window& to_front(std::size_t at);
  void make_room();
  void insert(const window& x);

  std::size_t capacity_;
  std::vector<window> windows_; ///< last used first
  std::uint64_t evicted_ = 0;
};

} // namespace rubicon::smepp
