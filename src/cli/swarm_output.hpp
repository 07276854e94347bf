// What a swarm tells while it runs and at its end, wherever its runs are.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "cli/command_line.hpp"
#include "cli/console.hpp"
#include "cli/exit_status.hpp"
#include "cli/swarm.hpp"
#include "cli/swarm_text.hpp"
#include "core/time.hpp"

namespace rubicon::cli {

class swarm_output {
public:
  /// @param x, seeds outlive it
  swarm_output(const swarm_command& x, const swarm& seeds, swarm_words words)
      : command_(x), seeds_(seeds), words_(std::move(words)) {}

  [[nodiscard]] swarm_words& words() { return words_; }

  /// Outcomes in the order of their seeds.
  void tell(const std::vector<seed_outcome>& due);

  /// False once nobody reads.
  [[nodiscard]] bool is_read() const { return is_read_; }

  void draw_progress();
  void erase_progress();

  /// How often the progress is to be drawn.
  [[nodiscard]] duration drawn_every() const;

  [[nodiscard]] exit_status finish(bool interrupted);

private:
  using steady = std::chrono::steady_clock;

  [[nodiscard]] duration elapsed() const { return steady::now() - started_; }

  const swarm_command& command_;
  const swarm& seeds_;
  swarm_words words_;
  swarm_json json_;
  const console errors_ = console_of(stderr);
  const steady::time_point started_ = steady::now();
  std::optional<duration> drawn_at_;
  bool is_read_ = true;
};

} // namespace rubicon::cli
