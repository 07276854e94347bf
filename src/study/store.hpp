// The results of a study, in a SQLite database.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "study/series.hpp"

struct sqlite3;

namespace rubicon::study {

/// Which values a run was given, by their paths.
using run_parameters = std::vector<std::pair<std::string, std::string>>;

struct expectation_result {
  std::string expect;
  std::optional<bool> met; ///< unset: the run was too short to judge
  std::string measured;
};

struct violation_result {
  double at_s = 0;
  std::string invariant;
  std::string detail;
};

/// A run and what came of it.
struct run_result {
  std::string key; ///< equal for runs that must be equal: of file, seed and binary
  std::string file;
  std::uint64_t seed = 0; ///< below 2^63
  double real_s = 0;
  run_parameters parameters;
  std::map<std::string, double> scalars; ///< numbers of its report, by their path there
  std::vector<expectation_result> expectations;
  std::vector<violation_result> violations;
  std::vector<series_point> series; ///< each name has a time once
};

/// What a query answers.
struct answer {
  static constexpr std::size_t rows_max = 100'000;

  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows; ///< the first rows_max
  bool has_more = false;
};

/// Each run is one transaction: whatever ends the process, a run is in the database as a whole or
/// not at all; what ends the machine may take the newest with it. Several processes may use one.
///
/// @throws std::runtime_error from add() and so on if the database cannot be read or written
class store {
public:
  enum class access : std::uint8_t { read, write };

  /// With `write` one that is not there is made. @returns the reason if it cannot be opened, or is
  /// another's
  [[nodiscard]] static std::variant<store, std::string> open(const std::string& path, access how);

  /// Whether there is a run of this key.
  [[nodiscard]] bool has(const std::string& key);

  /// Leaves a run as it is that is there.
  void add(const run_result& x);

  /// Names a run, which is there, also by these parameters.
  void add_parameters(const std::string& key, const run_parameters& all);

  /// The values of one scalar of the runs with these keys; unset for one that has none.
  [[nodiscard]] std::vector<std::optional<double>> values(const std::vector<std::string>& keys,
                                                          const std::string& scalar);

  /// Calls `take` with the key, seed, parameters and scalars of each run, in the order in which
  /// they were added.
  void for_each_run(const std::function<void(const run_result&)>& take);

  /// One statement that changes nothing. @returns the reason if it is refused
  [[nodiscard]] std::variant<answer, std::string> query(const std::string& sql);

private:
  struct closer {
    void operator()(sqlite3* x) const;
  };
  using handle = std::unique_ptr<sqlite3, closer>;

  explicit store(handle database) : database_(std::move(database)) {}

  handle database_;
};

} // namespace rubicon::study
