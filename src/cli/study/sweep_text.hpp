// What a sweep reads of a report, and what it prints.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "study/grid.hpp"
#include "study/statistics.hpp"
#include "study/store.hpp"

namespace rubicon::cli {

/// Numbers, expectations and violations of a report in JSON; nothing if it is none, or of a run
/// that was interrupted.
[[nodiscard]] std::optional<study::run_result> result_of(const std::string& report);

/// The scalars that a summary shows unless others are asked for.
[[nodiscard]] const std::vector<std::string>& usual_scalars();

/// One scalar, by variant and seed; unset where a run has none.
struct scalar_values {
  std::string name;
  std::vector<std::vector<std::optional<double>>> of_variants;
};

/// What is said of a study.
struct study_summary {
  std::vector<std::string> paths; ///< that vary
  std::vector<study::variant_values> variants;
  std::vector<scalar_values> scalars;
  std::optional<double> quantile; ///< shown in the place of the mean
  double confidence = study::usual_confidence;
};

/// A mean or quantile and its interval.
struct shown_figure {
  std::size_t runs = 0;
  double value = 0;
  std::optional<study::interval> around;
};

struct variant_figures {
  shown_figure own;
  shown_figure difference; ///< from the first variant; without runs for the first itself
};

/// Of one of the summary's scalars.
[[nodiscard]] variant_figures figures_of(const study_summary& x, const scalar_values& scalar,
                                         std::size_t variant);

/// `mean`, `90 % quantile`
[[nodiscard]] std::string figure_name(const study_summary& x);

/// A table for each scalar: mean or quantile of each variant with its interval, and its difference
/// from the first variant, seed by seed.
[[nodiscard]] std::string summary_text(const study_summary& x, std::size_t width, bool colour);

/// A line for each scalar and variant.
[[nodiscard]] std::string summary_csv(const study_summary& x);

} // namespace rubicon::cli
