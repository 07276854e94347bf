// A study over parameters on one page to send: its figures with their intervals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rubicon::page {

/// A mean or quantile of a variant.
struct study_figure {
  std::size_t runs = 0; ///< none: the rest means nothing
  double value = 0;
  std::optional<std::pair<double, double>> interval;
};

/// One number of the reports.
struct study_scalar {
  struct run {
    std::uint64_t seed = 0;
    double value = 0;
  };

  std::string name;
  std::vector<study_figure> figures;  ///< by variant
  std::vector<std::vector<run>> runs; ///< by variant
};

struct study_page {
  std::string file;
  std::string command;
  std::string figure = "mean";     ///< what figures are: `90 % quantile`
  std::string confidence = "95 %"; ///< of their intervals
  std::vector<std::string> parameters;
  std::vector<std::vector<std::string>> variants; ///< a value of each parameter
  std::vector<study_scalar> scalars;
  /// The command that repeats the run of a variant with a seed.
  std::function<std::string(std::size_t variant, std::uint64_t seed)> replay;
};

/// The whole document: of each scalar its curves over each parameter, a map over the first two,
/// the values of all runs, and the commands that repeat its extremes.
[[nodiscard]] std::string html_of(const study_page& x);

} // namespace rubicon::page
