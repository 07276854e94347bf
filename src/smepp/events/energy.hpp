// When a peer's radio has to be on: the union of the duty cycles that it takes part in (D1.1 3.4.4,
// SMP-23, SMP-24).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "core/time.hpp"

namespace rubicon::smepp {

/// Windows that come back: from first + k * period, for k = 0, 1, ..., each for `length`. Before
/// the first there are none. On the clock of their owner.
struct duty_cycle {
  instant first;
  duration period{}; ///< > 0
  duration length{}; ///< > 0; from `period` on: always on

  friend bool operator==(const duty_cycle&, const duty_cycle&) = default;
};

struct energy_config {
  /// The radio stays on between windows that are less apart than this.
  duration tolerance = 10ms;
  /// It is switched on so long before a window and off so long after it: time to switch, and the
  /// error of the schedule.
  duration radio_delay = 5ms;
};

/// The union of all cycles: on in each window, between windows closer than the tolerance, and for
/// the radio delay around them (Figure 11). It keeps no history: is_on() is a function of time.
class energy {
public:
  using cycle_key = std::uint64_t;

  explicit energy(energy_config config = {}) : config_(config) {}

  /// @param key chosen by the owner
  void set(cycle_key key, const duty_cycle& x);
  void remove(cycle_key key);
  void clear() { cycles_.clear(); }

  [[nodiscard]] bool is_on(instant now) const;

  /// The next time after `now` at which is_on() is another, or a while before it: ask again then.
  /// Nothing: never.
  [[nodiscard]] std::optional<instant> next_change(instant now) const;

  [[nodiscard]] std::size_t size() const { return cycles_.size(); }

private:
  /// From the first window of a stretch to the end of its last one, the radio delay not counted.
  struct stretch {
    instant begin;
    instant end;
  };

  /// The last window that has begun at `t` or before, if any.
  [[nodiscard]] static std::optional<stretch> last_window(const duty_cycle& x, instant t);
  [[nodiscard]] static stretch next_window(const duty_cycle& x, instant t);
  [[nodiscard]] std::optional<instant> last_end(instant t) const;
  [[nodiscard]] std::optional<instant> next_begin(instant t) const;
  [[nodiscard]] bool merges(instant end, instant begin) const;

  energy_config config_;
  std::map<cycle_key, duty_cycle> cycles_;
};

} // namespace rubicon::smepp
