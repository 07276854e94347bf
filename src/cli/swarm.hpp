// One ecology under many seeds: which run is next, what became of each, and the sum of all. Knows
// neither processes, clocks nor terminals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/child_process.hpp"
#include "config/toml/settings.hpp"
#include "core/time.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

/// Both included.
struct seed_range {
  std::uint64_t first = 0;
  std::uint64_t last = 0; ///< not below `first`
};

/// A situation of the file ([[expect]] kind = "sometimes"), and whether a run has come into it.
struct situation_outcome {
  std::string name;
  bool is_reached = false;
};

/// What became of the run with one seed.
struct seed_outcome {
  std::uint64_t seed = 0;
  std::vector<report::violation> violations;
  duration real{}; ///< time it took
  std::uint64_t events = 0;
  double simulated_s = 0;
  /// What is compared between seeds, by title; empty of a run without a report.
  std::map<std::string, double> figures = {};
  std::vector<situation_outcome> situations = {}; ///< in the order of the file
};

/// The words of `rubicon run` that make the run with one seed of a file.
/// @param length as for `--for`; empty: the file's
[[nodiscard]] std::vector<std::string> run_words(const std::string& file, std::uint64_t seed,
                                                 const std::string& length = {},
                                                 const config::settings& settings = {});

/// Reads what these words left behind. A run without a report counts as one with a
/// violation: it overran its time ("no end"), a signal ended it ("no crash", with the last line of
/// its standard error), or its output makes no sense ("a report").
/// @param overran the run was killed because `real` was all the time it had
/// @returns nothing if a signal ended the run early, and cleanly: it says nothing about its seed
[[nodiscard]] std::optional<seed_outcome> judge(std::uint64_t seed, const child_end& how,
                                                duration real, bool overran);

/// Seeds of a range in ascending order, with bounded memory: no run starts while `ahead_max` later
/// ones than the oldest unfinished have ended or run. Outcomes come back in the order of their
/// seeds, whatever the order in which runs end.
class swarm {
public:
  static constexpr std::uint64_t ahead_max = 4096;
  static constexpr std::size_t listed_max = 1000;

  /// Of all runs with a report.
  struct coverage {
    std::string name;
    std::uint64_t runs = 0;                  ///< that have come into it
    std::optional<std::uint64_t> first_seed; ///< of these
  };

  struct totals {
    std::uint64_t runs = 0;                          ///< that have ended and been returned
    std::uint64_t failures = 0;                      ///< of these, with violations
    std::vector<std::uint64_t> failed_seeds;         ///< the first `listed_max`
    std::map<std::string, std::uint64_t> violations; ///< by invariant
    std::uint64_t events = 0;
    double simulated_s = 0;
    std::vector<coverage> situations; ///< in the order of the file
    std::optional<std::uint64_t> slowest_seed;
    duration slowest{};
  };

  explicit swarm(seed_range seeds) : seeds_(seeds), next_(seeds.first), due_(seeds.first) {}

  /// The seed to run next; nothing if there is none, or none yet.
  [[nodiscard]] std::optional<std::uint64_t> next();

  /// Takes the outcome of a seed that next() gave.
  /// @returns those whose turn it is now
  [[nodiscard]] std::vector<seed_outcome> ended(seed_outcome x);

  /// What has ended but waits for lower seeds, when these will not end any more.
  [[nodiscard]] std::vector<seed_outcome> give_up();

  [[nodiscard]] const totals& so_far() const { return totals_; }

  /// A situation that no run has come into.
  [[nodiscard]] bool misses_situations() const;
  [[nodiscard]] seed_range seeds() const { return seeds_; }

  /// Of all, at most 2^64 - 1.
  [[nodiscard]] std::uint64_t count() const {
    const auto more = seeds_.last - seeds_.first;
    return more + (more == ~std::uint64_t{0} ? 0 : 1);
  }

  /// Runs that have ended, returned or not.
  [[nodiscard]] std::uint64_t finished() const { return totals_.runs + waiting_.size(); }

private:
  void count(const seed_outcome& x);
  void count_situations(const seed_outcome& x);

  seed_range seeds_;
  std::uint64_t next_;
  std::uint64_t due_;
  bool all_given_ = false; ///< also when the last seed is 2^64 - 1
  std::map<std::uint64_t, seed_outcome> waiting_;
  totals totals_;
};

} // namespace rubicon::cli
