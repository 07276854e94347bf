// What `rubicon swarm` prints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "cli/swarm.hpp"

namespace rubicon::cli {

/// What of the command line the text needs.
struct swarm_words {
  std::string file;
  std::string length = {}; ///< as given to --for, or empty
  std::uint64_t jobs = 1;
  bool from_wall = false;                 ///< the file says wall: a replay must say virtual
  std::vector<std::string> settings = {}; ///< of --set
  std::string text = {};                  ///< the file's octets
  /// That each run leaves out by chance ([ecology] vary_faults).
  std::vector<std::string> fault_kinds = {};
};

/// ` --set PATH=VALUE` for each setting, for a POSIX shell.
[[nodiscard]] std::string setting_options(const swarm_words& x);

/// The command that repeats one run, for a POSIX shell: `rubicon run home.toml --seed 7`.
[[nodiscard]] std::string replay_command(const swarm_words& x, std::uint64_t seed);

/// One line a violation: seed, invariant, detail, and the command that replays it.
[[nodiscard]] std::string violation_lines(const swarm_words& x, const seed_outcome& outcome);

/// `84 of 200 runs  42%  3 with violations: 7 12 90  12 s left`, at most `width` characters.
[[nodiscard]] std::string swarm_progress(const swarm& x, duration real, std::size_t width);

/// Of kinds that runs leave out by chance, how many runs have each; nothing after an interruption,
/// when seeds between others are missing.
[[nodiscard]] std::map<std::string, std::uint64_t>
runs_with_faults(const swarm& x, const swarm_words& words, bool interrupted);

/// The lines at the end.
[[nodiscard]] std::string swarm_summary(const swarm& x, const swarm_words& words, duration real,
                                        bool interrupted);

/// The object of `--json` (docs/report.md). Of the violations it holds the first
/// `swarm::listed_max`.
class swarm_json {
public:
  swarm_json();
  ~swarm_json();

  void add(const swarm_words& words, const seed_outcome& x);
  [[nodiscard]] std::string text(const swarm& x, const swarm_words& words, duration real,
                                 bool interrupted) const;

private:
  std::vector<nlohmann::ordered_json> violations_;
  std::uint64_t left_out_ = 0;
};

} // namespace rubicon::cli
