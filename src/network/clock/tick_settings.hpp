// The settings of the RUBICON clock that a mote knows: the one in force, and the one that follows
// it (CLK-03).
#pragma once

#include <chrono>
#include <optional>

#include "core/island_time.hpp"

namespace rubicon::network {

class tick_settings {
public:
  /// From a round of the root: the newest round has the newest setting, and the one before it only
  /// if that was never the root's.
  void learn(const tick_setting& x);

  /// The island's time is another: what held in it before says nothing now.
  void replace(const tick_setting& x);

  /// The same ticks where the time is another by `by`. @pre known()
  void move(std::chrono::microseconds by);

  [[nodiscard]] bool known() const { return current_.has_value(); }

  /// The one that holds then, or the first one known. @param time nothing: the time is not known
  [[nodiscard]] std::optional<tick_setting> at(std::optional<island_time> time) const;

  /// For a stamp: the newest one.
  [[nodiscard]] tick_setting newest() const;

private:
  std::optional<tick_setting> current_;
  std::optional<tick_setting> next_; ///< current_ is known too
};

} // namespace rubicon::network
