// The end of a run at the first flat battery.
#pragma once

#include <string>
#include <vector>

#include "actors/supervision/ecology.hpp"
#include "config/plan/ecology.hpp"
#include "core/time.hpp"
#include "scheduler/world.hpp"

namespace rubicon {

/// Ends a run in the very moment in which a mote's battery is flat, on any number of threads: while
/// one may be, all islands and PCs keep to the same time, and else they may run ahead of each other
/// up to when one may be.
class lifetime {
public:
  /// @param world outlives this
  lifetime(scheduler::world& world, config::run_end end);

  /// When to look again. The run must not go further before; instant::max(): that need not be.
  [[nodiscard]] instant next_look() const { return next_look_; }

  /// @pre as look_at()
  void look(const ecology_state& all);

  /// Somebody has planned the end of a battery beside the plan of the file.
  void expect_end(instant at);

  /// A mote's battery is flat.
  void on_flat(const std::string& mote);

  /// From now on no battery ends anything.
  void close() { is_open_ = false; }

  /// The mote whose battery has ended the run; empty: none has.
  [[nodiscard]] const std::string& ended_by() const { return ended_by_; }

private:
  scheduler::world& world_;
  bool is_open_;
  instant next_look_ = instant::max();
  std::vector<instant> expected_; ///< ends of batteries
  std::string ended_by_;
};

} // namespace rubicon
