// What a swarm prints while it runs and at its end, wherever its runs are.
#pragma once

#include <chrono>
#include <cstdint>
#include <fstream>
#include <optional>
#include <vector>

#include "cli/print/console.hpp"
#include "cli/print/swarm_text.hpp"
#include "cli/swarm.hpp"
#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"
#include "core/time.hpp"
#include "page/swarm_page.hpp"

namespace rubicon::cli {

class swarm_output {
public:
  /// @param x, seeds outlive it
  /// @throws std::runtime_error if the page's file cannot be made
  swarm_output(const swarm_command& x, const swarm& seeds, swarm_words words);

  [[nodiscard]] swarm_words& words() { return words_; }

  /// Adds outcomes in the order of their seeds.
  void add(const std::vector<seed_outcome>& due);

  /// False once nobody reads.
  [[nodiscard]] bool is_read() const { return is_read_; }

  void draw_progress();
  void erase_progress();

  /// How often the progress is to be drawn.
  [[nodiscard]] duration drawn_every() const;

  [[nodiscard]] exit_status finish(bool interrupted);

private:
  using steady = std::chrono::steady_clock;

  /// @returns whether it is all there, or nobody wants it
  [[nodiscard]] bool write_page(bool interrupted);
  [[nodiscard]] duration elapsed() const { return steady::now() - started_; }

  const swarm_command& command_;
  const swarm& seeds_;
  swarm_words words_;
  swarm_json json_;
  page::seed_figures figures_;
  std::vector<page::failed_seed> failed_; ///< the first `swarm::listed_max`
  std::ofstream page_;
  const console errors_ = console_of(stderr);
  const steady::time_point started_ = steady::now();
  std::optional<duration> drawn_at_;
  bool is_read_ = true;
};

} // namespace rubicon::cli
