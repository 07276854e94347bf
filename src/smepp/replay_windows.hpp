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

/// For each sender in each group the highest counter accepted and which of the 31 below it were
/// (RFC 4303 3.4.3). One window a group: who has the keys of one cannot spoil another's.
///
/// A sender without a window is not believed: it may be a recording. It gets one when it has proven
/// that it is speaking now (security.hpp). So nothing need be stored: a mote that has lost its
/// windows with its memory, and a table that had to give one up, ask again.
class replay_windows {
public:
  enum class verdict : std::uint8_t { fresh, replayed, unknown };

  explicit replay_windows(std::size_t capacity = 24) : capacity_(capacity) {}

  /// Changes nothing: what is not authentic yet must not move a window.
  [[nodiscard]] verdict judge(mote_id sender, group_id group, std::uint32_t counter) const;

  /// It was authentic and fresh. @pre judge() said so
  void accept(mote_id sender, group_id group, std::uint32_t counter);

  /// It has proven that this is its counter now. A full table gives up the window that was used
  /// longest ago.
  void begin(mote_id sender, group_id group, std::uint32_t counter);

  void forget(group_id group);

  [[nodiscard]] std::size_t size() const { return windows_.size(); }
  [[nodiscard]] std::uint64_t evicted() const { return evicted_; }
  /// Octets on a mote: mote, group, counter, bits, and its place in the order.
  [[nodiscard]] std::size_t footprint() const { return capacity_ * (2 + 2 + 4 + 4 + 1); }

private:
  struct window {
    mote_id sender;
    group_id group;
    std::uint32_t highest = 0;
    std::uint32_t seen = 0; ///< bit i: highest - i
  };

  [[nodiscard]] std::optional<std::size_t> find(mote_id sender, group_id group) const;
  window& to_front(std::size_t at);

  std::size_t capacity_;
  std::vector<window> windows_; ///< last used first
  std::uint64_t evicted_ = 0;
};

} // namespace rubicon::smepp
