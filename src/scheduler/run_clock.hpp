// The clock of an actor system: ecology time, and everything that is to happen at a time.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <type_traits>

#include <caf/actor_clock.hpp>
#include <caf/execution_unit.hpp>

#include "core/time.hpp"
#include "scheduler/outside.hpp"
#include "scheduler/process.hpp"
#include "scheduler/timeout.hpp"

namespace rubicon::scheduler {

enum class time_mode : std::uint8_t { virtual_time, wall };

static_assert(std::is_same_v<caf::actor_clock::duration_type, duration>);

/// CAF's time points count from the start of the run, as ours do.
[[nodiscard]] constexpr instant to_instant(caf::actor_clock::time_point x) {
  return instant(x.time_since_epoch());
}

[[nodiscard]] constexpr caf::actor_clock::time_point to_clock_time(instant x) {
  return caf::actor_clock::time_point(x.time_since_epoch());
}

/// now() and schedule() may be called from any thread: they are those of the process that it
/// executes, of the supervisor's outside of all processes. The rest belongs to the home thread of
/// the `outside`. What CAF's own kinds of actors ask of a clock is refused: ours ask by schedule().
class run_clock final : public caf::actor_clock {
public:
  using real_time = std::chrono::steady_clock::time_point;

  /// @param speed ecology seconds per real second; 0: virtual time is not paced, wall time has 1
  /// @param supervisor must outlive the last call
  run_clock(outside& others, process& supervisor, time_mode mode, double speed);

  /// A run to `end` begins. Wall time starts to pass with the first.
  void begin(instant end);

  /// A run ends before its time: now() stays where it is until the next begins.
  void halt();

  /// Whether `x` has come, or in virtual time without pace may be jumped to.
  [[nodiscard]] bool reached(instant x) const;

  /// When `x` comes in real time; at most an hour from now.
  [[nodiscard]] real_time real_time_of(instant x) const;

  /// Delivers it at `due`, or now if that is past.
  void schedule(instant due, timeout what);

  /// The same, once it is this clock's thread that asks.
  void apply(add_timeout x);

  // caf::actor_clock
  [[nodiscard]] time_point now() const noexcept override;
  void set_ordinary_timeout(time_point t, caf::abstract_actor* self, caf::atom_value type,
                            std::uint64_t id) override;
  void set_multi_timeout(time_point t, caf::abstract_actor* self, caf::atom_value type,
                         std::uint64_t id) override;
  void set_request_timeout(time_point t, caf::abstract_actor* self, caf::message_id id) override;
  void cancel_ordinary_timeout(caf::abstract_actor* self, caf::atom_value type) override;
  void cancel_request_timeout(caf::abstract_actor* self, caf::message_id id) override;
  void cancel_timeouts(caf::abstract_actor* self) override;
  void schedule_message(time_point t, caf::strong_actor_ptr receiver,
                        caf::mailbox_element_ptr content) override;
  void schedule_message(time_point t, caf::group target, caf::strong_actor_ptr sender,
                        caf::message content) override;
  void cancel_all() override;

  /// The process that the calling thread executes, or the supervisor.
  [[nodiscard]] process& here() const;

private:
  outside& others_;
  process& supervisor_;
  const time_mode mode_;
  const double speed_;
  bool started_ = false;
  std::atomic<std::int64_t> horizon_ns_ = 0;     ///< end of the current or last run
  std::atomic<std::int64_t> anchor_real_ns_ = 0; ///< steady clock at anchor_ecology_ns_
  std::int64_t anchor_ecology_ns_ = 0;
};

/// @pre the system has our coordinator
[[nodiscard]] run_clock& run_clock_of(caf::actor_system& system);

} // namespace rubicon::scheduler
