// Many runs of one file on one page to send: what differs between their seeds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "report/report.hpp"

namespace rubicon::page {

/// Figures of runs by title, of each seed one.
class seed_figures {
public:
  static constexpr std::size_t seeds_max = 100'000; ///< of more the first

  struct entry {
    double value = 0;
    std::uint64_t seed = 0;
  };

  void add(std::uint64_t seed, const std::map<std::string, double>& figures);

  [[nodiscard]] const std::map<std::string, std::vector<entry>>& all() const { return all_; }

private:
  std::map<std::string, std::vector<entry>> all_;
};

struct failed_seed {
  std::uint64_t seed = 0;
  std::vector<report::violation> violations;
  std::string command;     ///< that repeats it
  std::string varied = {}; ///< what the seed has decided of the file, `outage=12.3s, without crash`
};

/// A situation that some run is to come into ([[expect]] kind = "sometimes").
struct wanted_situation {
  std::string name;
  std::uint64_t runs = 0;                  ///< that have
  std::optional<std::uint64_t> first_seed; ///< of these
};

struct swarm_page {
  std::string file;
  std::string seeds; ///< `1..100`
  std::uint64_t runs = 0;
  std::uint64_t failures = 0;
  const std::map<std::string, std::uint64_t>& violations; ///< by invariant
  const seed_figures& figures;
  const std::vector<failed_seed>& failed; ///< some at least, ascending
  std::string command = {};
  double real_s = 0;
  std::uint64_t events = 0;
  bool interrupted = false;
  std::vector<wanted_situation> situations = {};
  std::map<std::string, std::uint64_t> faults = {}; ///< runs with each kind, if runs leave them out
};

/// The whole document.
[[nodiscard]] std::string html_of(const swarm_page& x);

} // namespace rubicon::page
