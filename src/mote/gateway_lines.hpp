// Which of the gateways at its serial lines leads a sink's island (GW-14).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "network/sink_event.hpp"

namespace rubicon::mote {

struct gateway_lines_config {
  std::size_t lines = 1;     ///< each to another gateway, in the order in which they take over
  std::int64_t slowness = 1; ///< serial::slowness() of the slowest; the next two times are so much
                             ///< longer
  duration poll_gap = 500ms; ///< between two questions to each gateway
  duration silence_max = 2s; ///< a gateway that has not answered for so long is not there
  duration steadiness = 15s; ///< one that has answered for so long takes the lead back: longer
                             ///< than it needs to learn of its ecology after a start
};

/// Send this event up that line.
struct line_event {
  std::size_t line = 0;
  network::gateway_poll what;
};

/// Asks each gateway whether it is there, and notifies one of them that it leads: the first that
/// is. The lead is lost by silence or a restart, and goes back to an earlier line that has been
/// steady.
///
/// Every handing over begins a new term. A gateway that leads is another incarnation of the PC of
/// its island, which Transport distinguishes by the term; so none of its messages is passed up
/// twice. A gateway that was not notified for a while that it leads holds itself for deposed,
/// before another one is notified (gateway::leadership).
///
/// With one line there is nothing to ask.
class gateway_lines {
public:
  gateway_lines() = default;
  /// @param last_term the last one of earlier lives; each life begins a new one
  gateway_lines(gateway_lines_config config, instant now, std::uint32_t last_term = 0);

  void on_answer(std::size_t line, const network::gateway_answer& x, instant now);

  [[nodiscard]] std::vector<line_event> on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// The line whose gateway leads, or led last.
  [[nodiscard]] std::size_t leader() const { return leader_; }
  [[nodiscard]] std::size_t lines() const { return config_.lines; }
  [[nodiscard]] std::uint32_t term() const { return term_; }

private:
  struct state {
    std::optional<instant> last_answer; ///< nothing: never
    instant steady_since;               ///< it has answered all the time since then
    std::optional<std::uint32_t> life;  ///< of its gateway
  };

  [[nodiscard]] bool is_there(std::size_t line, instant now) const;
  void review(instant now);
  void begin_term(std::size_t line, instant now);

  gateway_lines_config config_;
  std::vector<state> lines_; ///< empty if there is only one
  std::size_t leader_ = 0;
  std::uint32_t term_ = 1;
  std::optional<instant> due_; ///< of the next questions
};

} // namespace rubicon::mote
