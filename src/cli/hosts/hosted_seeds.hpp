// Runs of an experiment that this computer executes for a swarm over several.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <list>
#include <optional>
#include <string>

#include "cli/hosts/hosted_part.hpp"
#include "deploy/messages.hpp"
#include "io/loop.hpp"
#include "io/process/process.hpp"

namespace rubicon::cli {

class hosted_seeds {
public:
  static constexpr std::size_t seeds_max = 4096; ///< given and not run; more are refused

  /// @param loop must outlive it
  hosted_seeds(io::loop& loop, const hosting& with);
  ~hosted_seeds();
  hosted_seeds(const hosted_seeds&) = delete;
  hosted_seeds& operator=(const hosted_seeds&) = delete;

  /// A later experiment takes the place of an earlier one.
  [[nodiscard]] deploy::verdict offer(const deploy::offer_seeds& x);
  [[nodiscard]] deploy::seeds_news run(const deploy::run_seeds& x);

  /// To be called now and then: ends runs that have had their time, and all that nobody asks for
  /// any more.
  void on_time();

private:
  using steady = std::chrono::steady_clock;

  struct seed_run {
    deploy::seed_result result;
    steady::time_point began;
    std::optional<io::process> process;
  };
  struct numbered_result {
    std::uint64_t number = 0;
    deploy::seed_result result;
  };
  struct experiment {
    std::string id;
    duration timeout{};
    std::deque<std::uint64_t> waiting;
    std::list<seed_run> runs; ///< processes refer to them
    std::deque<numbered_result> results;
    std::uint64_t last_number = 0;
    steady::time_point asked;
  };

  [[nodiscard]] std::filesystem::path file() const;
  void start_some();
  void start(std::uint64_t seed);
  void take_output(seed_run& x, io::process::output from, byte_view octets);
  void on_end(seed_run& x, io::process_end how);
  void finish(seed_run& x);

  io::loop& loop_;
  const hosting& with_;
  const std::uint32_t jobs_;
  std::optional<experiment> experiment_;
};

} // namespace rubicon::cli
