// A stand-in for a component with a purpose, a robot above all: its face in the tuple space without
// its body (SVC-10).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "goal/pursuer_config.hpp"

namespace rubicon::goal {

/// Set this own tuple.
struct publish {
  std::string key;
  std::string text;
};

/// Make this own tuple a meta tuple, unless it is one already.
struct declare {
  std::string key;
  std::string reference; ///< where it points; empty: at the own tuple `target`
  std::string target;
};

/// A goal is pursued from now on.
struct begun {
  std::string goal;
};

enum class goal_outcome : std::uint8_t { succeeded, failed, preempted };

/// Why a goal has not been reached.
enum class goal_cause : std::uint8_t {
  none,      ///< it has
  unknown,   ///< no such goal: failed
  timeout,   ///< it took too long: failed
  broken,    ///< a state failed, by chance: failed
  newer,     ///< another goal has come: preempted
  cancelled, ///< somebody wants no goal: preempted
};

[[nodiscard]] std::string_view to_string(goal_outcome x);
[[nodiscard]] std::string_view to_string(goal_cause x);

/// A goal has come to its end; once for each.
struct ended {
  std::string goal;
  goal_outcome outcome = goal_outcome::failed;
  goal_cause cause = goal_cause::none;
};

using output = std::variant<publish, declare, begun, ended>;
using outputs = std::vector<output>;

/// Which tuple a value is of. Keys have no letter case (TUP-03).
struct source {
  peer_id owner;
  std::string key;
};

/// Every goal has one outcome: goals = succeeded + failed + preempted + open_goals().
struct pursuer_counters {
  std::uint64_t goals = 0;
  std::uint64_t succeeded = 0;
  std::uint64_t failed = 0; ///< the next ones included
  std::uint64_t preempted = 0;
  std::uint64_t timed_out = 0;
  std::uint64_t unknown = 0;
};
RUBICON_FIELDS(pursuer_counters, goals, succeeded, failed, preempted, timed_out, unknown);

/// Pursues one goal at a time, by going through its states:
///
///   idle --goal--> waiting --needs hold--> busy --over, and there is a next state--> waiting
///   busy --last state is over--> idle, succeeded
///   busy --state fails--> idle, failed              busy, waiting --timeout--> idle, failed
///   busy, waiting --`none`--> idle, preempted       busy, waiting --other goal--> waiting,
///   preempted
///
/// A state that needs nothing, or whose needs hold, is not waited for. A goal that it does not know
/// fails at once, and the one in progress goes on.
///
/// Own tuples, below its name:
///   goal            others write a goal here, again too; `none`: no goal. `none` at the start
///   state           `idle`, `waiting`, or the name of the state
///   outcome         `at kitchen succeeded`: the goal, the last blank, the outcome; set once for
///                   each goal, after the others; `?` for an unknown goal that is long or not plain
///   outcome.cause   why not, in one word; `none` if it succeeded
///   INPUT, mi-INPUT `none`, which others may write over; and the meta tuple that says which tuple
///                   the input is (META-04)
///   OUTPUT          published at the start, then every period, and when a state sets it
class pursuer {
public:
  enum class phase : std::uint8_t { idle, waiting, busy };

  pursuer() = default;
  /// @pre names of inputs and outputs are unique; conditions and `sets` name such
  pursuer(pursuer_config config, random_stream rng);

  [[nodiscard]] outputs start(instant now);

  [[nodiscard]] std::string goal_key() const { return key_of("goal"); }
  [[nodiscard]] std::string meta_key(std::size_t input) const {
    return key_of("mi-" + config_.inputs[input].name);
  }

  /// Somebody has written the goal tuple; also an equal text is a new goal.
  [[nodiscard]] outputs on_goal(std::string_view text, instant now);

  /// The tuple that an input is has this value. @pre input < config().inputs.size(), also below
  [[nodiscard]] outputs on_input(std::size_t input, source from, std::string_view text,
                                 instant now);
  void on_input_gone(std::size_t input, const source& from);

  /// An input is this tuple from now on: values of others mean nothing any more.
  void on_reference(std::size_t input, const std::optional<source>& to);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] phase doing() const { return phase_; }
  [[nodiscard]] std::uint64_t open_goals() const { return goal_ ? 1 : 0; }
  [[nodiscard]] const pursuer_config& config() const { return config_; }
  [[nodiscard]] const pursuer_counters& counters() const { return counters_; }

private:
  struct input_value {
    source from;
    std::string text;
  };
  struct output_value {
    std::string text;
    instant due;
  };

  [[nodiscard]] std::string key_of(std::string_view name) const {
    return config_.name + '.' + std::string(name);
  }
  [[nodiscard]] const goal_config& pursued() const { return config_.goals[*goal_]; }
  [[nodiscard]] bool holds(const condition& x) const;
  void say(std::string_view name, std::string text, outputs& out) const;
  void say_state(std::string_view name, outputs& out);
  void begin(std::size_t goal, instant now, outputs& out);
  void enter_state(instant now, outputs& out);
  void leave_state(instant now, outputs& out);
  void set_outputs(const state_config& x, outputs& out);
  void publish_outputs(instant now, outputs& out);
  void rest(outputs& out);
  void end(goal_outcome outcome, goal_cause cause, outputs& out);
  void publish_end(std::string goal, goal_outcome outcome, goal_cause cause, outputs& out);

  pursuer_config config_;
  random_stream rng_;
  std::vector<std::optional<input_value>> inputs_; ///< as in config_
  std::vector<output_value> outputs_;              ///< as in config_
  phase phase_ = phase::idle;
  std::string published_state_;
  std::optional<std::size_t> goal_; ///< in config_; set unless idle
  std::size_t state_ = 0;           ///< of the goal
  instant timeout_{};               ///< of the goal
  std::optional<instant> due_;      ///< while busy: when the state is over
  pursuer_counters counters_;
};

} // namespace rubicon::goal
