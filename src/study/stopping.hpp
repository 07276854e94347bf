// When a variant of a study has enough runs: at a few numbers of runs, known before, its interval
// is looked at, each time with so much more confidence that all looks together have the usual one.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "study/statistics.hpp"

namespace rubicon::study {

/// The half-width of the interval of a figure's mean is below a limit.
struct stop_rule {
  std::string figure;
  double limit = 0;
  bool is_relative = false; ///< it is a part of the mean
};

/// `messages.delivery ci < 1%`, `events ci < 50`; or the reason why it is neither.
[[nodiscard]] std::variant<stop_rule, std::string> parse_stop_rule(std::string_view text);

/// The looks at the variants of one study.
class stopping {
public:
  static constexpr std::size_t first_look = 8;

  /// @pre runs_max > 0
  stopping(stop_rule rule, std::size_t runs_max);

  /// Numbers of runs, ascending: 8, 16, 32 and so on, the last runs_max.
  [[nodiscard]] const std::vector<std::size_t>& looks() const { return looks_; }

  /// Of the interval at each look: the usual one, its error divided by the number of looks
  /// (Bonferroni).
  [[nodiscard]] double confidence() const;

  /// Whether these values, unset of runs that lack the figure, are precise.
  [[nodiscard]] bool is_precise(std::span<const std::optional<double>> values) const;

  /// How many runs a variant must have after those, as many as a look has.
  /// @returns as many: it has enough
  [[nodiscard]] std::size_t needed(std::span<const std::optional<double>> values) const;

private:
  stop_rule rule_;
  std::vector<std::size_t> looks_;
};

} // namespace rubicon::study
