// What waits to be sent, until those it is for are awake.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/numbers/random.hpp"
#include "smepp/actions.hpp"

namespace rubicon::smepp {

/// Messages in the order in which they came, each held until its time and its window. At the begin
/// of a window not everybody sends at once: each waits a random part of a spread.
class outbox {
public:
  struct pause {
    duration left{};   ///< until a message may leave; 0: now
    duration spread{}; ///< a random part of it more, with left > 0
  };
  using waiting_time = std::function<pause(const to_send&, instant)>;

  explicit outbox(std::size_t capacity = 32) : capacity_(capacity) {}
  outbox(std::size_t capacity, duration spread, random_stream rng)
      : capacity_(capacity), spread_(spread), rng_(rng) {}

  /// @returns false if it is full: then `x` is dropped
  bool push(to_send x, instant now);

  /// The next message that may leave now. One with copies left stays, for later.
  [[nodiscard]] std::optional<to_send> take(instant now, const waiting_time& wait);

  /// When take() has something, at the earliest.
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Messages of that group. @returns the tokens of those that have one
  std::vector<std::uint64_t> forget(group_id group);

  /// Whether something waits that needs no window.
  [[nodiscard]] bool has_urgent() const;
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] std::size_t footprint() const { return capacity_ * (message_max / 2 + 16); }

private:
  struct entry {
    to_send what;
    instant due;
  };

  std::size_t capacity_;
  duration spread_ = 20ms;
  random_stream rng_;
  std::vector<entry> entries_;
};

} // namespace rubicon::smepp
