// What a host's peisinit decides: which of its components run, and what its tuples say of them
// (SVC-01, SVC-03 to SVC-05).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peisinit/component.hpp"

namespace rubicon::peisinit {

/// How a component is asked to end, from the gentlest step on.
enum class stop_step : std::uint8_t {
  do_quit,     ///< the tuple `do-quit` at its kernel
  kernel_quit, ///< the tuple `kernel.do-quit`
  interrupt,   ///< SIGINT
  terminate,   ///< SIGTERM
  kill,        ///< SIGKILL
};

inline constexpr duration stop_step_time = 500ms;
/// Of what a component has written, so much is a tuple.
inline constexpr std::size_t tail_octets_max = 4096;
/// Between two changes of such a tuple.
inline constexpr duration tail_period = 200ms;
/// Of a value that others write into the tuple `extra-arguments`.
inline constexpr std::size_t arguments_octets_max = 1000;

enum class phase : std::uint8_t { off, starting, on, stopping, waiting };

[[nodiscard]] std::string_view to_string(phase x);

enum class channel : std::uint8_t { out, err };

/// An own tuple is to have this value.
struct publish {
  std::string key;
  std::string text;

  friend bool operator==(const publish&, const publish&) = default;
};

/// on_started() or on_ended() with this life follows.
struct start {
  std::size_t component = 0;
  std::uint64_t life = 0;
  std::string arguments; ///< the extra ones

  friend bool operator==(const start&, const start&) = default;
};

struct stop {
  std::size_t component = 0;
  stop_step step = stop_step::do_quit;

  friend bool operator==(const stop&, const stop&) = default;
};

/// For a component's standard input.
struct feed {
  std::size_t component = 0;
  std::string text;

  friend bool operator==(const feed&, const feed&) = default;
};

/// A line for the event log: `camera on`.
struct notice {
  std::string what;

  friend bool operator==(const notice&, const notice&) = default;
};

/// After shut_down(): no component runs any more.
struct all_off {
  friend bool operator==(const all_off&, const all_off&) = default;
};

using output = std::variant<publish, start, stop, feed, notice, all_off>;
using outputs = std::vector<output>;

struct counters {
  std::uint64_t starts = 0;
  std::uint64_t ends = 0;    ///< that were not requested, failed starts included
  std::uint64_t kills = 0;   ///< stops that came to SIGKILL
  std::uint64_t refused = 0; ///< requests that are not understood, or that come too late
};

/// Components are known by their place in the list. Each is
///
///   off --on--> starting --started--> on      starting, on --ended--> waiting --delay--> starting
///   starting, on --off--> stopping --ended--> off, or starting if it is wanted again
///   waiting --off--> off
///
/// A stop begins with the gentlest step and takes the next one each stop_step_time until the end of
/// the component is reported; SIGKILL is repeated. Of a component there is never more than one
/// life.
class supervisor {
public:
  supervisor() = default;
  explicit supervisor(std::vector<component> components);

  [[nodiscard]] const std::vector<component>& components() const { return components_; }

  /// Publishes all tuples and starts what is to be on. Called once, first.
  [[nodiscard]] outputs begin(instant now);

  /// Somebody has written `reqState`: `on` or `off`; real ones also take `start`, which is `on`,
  /// and `abort`, which is `off` by SIGKILL at once. Letter case does not count. Harmless if
  /// repeated.
  [[nodiscard]] outputs on_request(std::size_t component, std::string_view word, instant now);

  /// Somebody has written `stdin`: a line for the component, which runs, or else it is refused. An
  /// empty text is no line.
  [[nodiscard]] outputs on_input(std::size_t component, std::string_view text);

  /// Somebody has written `extra-arguments`: they count from the next start on.
  [[nodiscard]] outputs on_arguments(std::size_t component, std::string_view text);

  /// @param process its number; 0: it is a peer of this process
  [[nodiscard]] outputs on_started(std::size_t component, std::uint64_t life, std::int64_t process);

  /// A life has come to its end, or to no beginning. Ignored if it is none, or an earlier one.
  /// @param how `status 1`, `signal 9`; may be empty
  [[nodiscard]] outputs on_ended(std::size_t component, std::uint64_t life, std::string_view how,
                                 instant now);

  /// The component has written something.
  [[nodiscard]] outputs on_output(std::size_t component, channel from, byte_view octets,
                                  instant now);

  /// Stops all, and starts none any more; all_off follows.
  [[nodiscard]] outputs shut_down(instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()

  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] phase phase_of(std::size_t component) const { return states_[component].at; }
  [[nodiscard]] const counters& counted() const { return counters_; }

private:
  /// The last octets of one of the outputs.
  struct tail {
    std::string text;
    bool changed = false; ///< since it was published
  };

  struct state {
    phase at = phase::off;
    bool wanted = false;
    std::uint64_t life = 0;
    instant due; ///< of the next start while waiting, of the next step while stopping
    stop_step step = stop_step::do_quit;
    std::string arguments;
    std::array<tail, 2> tails; ///< by channel
    instant tails_due;         ///< when they may be published again
  };

  void become(std::size_t component, phase next);
  void set(std::size_t component, std::string_view field, std::string text);
  void begin_start(std::size_t component);
  void begin_stop(std::size_t component, stop_step step, instant now);
  void take_step(std::size_t component, stop_step step, instant now);
  void publish_tails(std::size_t component, instant now);
  void refuse(std::size_t component, std::string why);
  void check_all_off();
  [[nodiscard]] outputs finish() { return std::exchange(out_, {}); }

  std::vector<component> components_;
  std::vector<state> states_; ///< of each
  bool shutting_down_ = false;
  counters counters_;
  outputs out_;
};

} // namespace rubicon::peisinit
