// What repeated runs say of one figure: means, differences and quantiles with their confidence.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/numbers/random.hpp"

namespace rubicon::study {

inline constexpr double usual_confidence = 0.95;

struct interval {
  double low = 0;
  double high = 0;
};

/// A mean and what is known of it.
struct estimate {
  std::size_t runs = 0;
  double mean = 0;
  std::optional<double> half_width; ///< of the confidence interval; unset below two runs
};

/// The t with P(|T| <= t) = confidence, T distributed as Student's t; relative error below 1e-6.
/// @pre freedom >= 1, 0 < confidence < 1
[[nodiscard]] double student_t(double confidence, std::size_t freedom);

/// P(|T| >= |t|), T distributed as Student's t: the chance of such a t where there is no
/// difference. Absolute error below 1e-4 above 1000 degrees of freedom, else below 1e-9. @pre
/// freedom >= 1
[[nodiscard]] double student_tail(double t, std::size_t freedom);

/// Of independent values, by Student's t. Of none the mean is 0.
[[nodiscard]] estimate mean_of(std::span<const double> values,
                               double confidence = usual_confidence);

/// Of b - a, whose values belong together in pairs, such as by their seeds: what both have in
/// common widens no interval. @pre as many of each
[[nodiscard]] estimate paired_difference(std::span<const double> a, std::span<const double> b,
                                         double confidence = usual_confidence);

/// Linear between the two nearest of the values. @pre there are values, 0 <= q <= 1
[[nodiscard]] double quantile(std::span<const double> values, double q);

/// The interval of a quantile by the percentile bootstrap, from so many samples drawn with
/// replacement. @pre there are values and samples
[[nodiscard]] interval bootstrap_quantile(std::span<const double> values, double q,
                                          random_stream& random, std::size_t samples = 1000,
                                          double confidence = usual_confidence);

/// The interval of quantile of b - quantile of a, from samples of pairs. @pre as many of each, at
/// least one, and samples
[[nodiscard]] interval bootstrap_difference(std::span<const double> a, std::span<const double> b,
                                            double q, random_stream& random,
                                            std::size_t samples = 1000,
                                            double confidence = usual_confidence);

} // namespace rubicon::study
