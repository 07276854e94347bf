#include "study/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/numbers/math.hpp"

namespace rubicon::study {

namespace {

/// P(|T| <= t) by the finite series for whole degrees of freedom (Abramowitz and Stegun 26.7.3 and
/// 26.7.4), where t is the tangent of `turns` times the root of `freedom`.
double within(double turns, std::size_t freedom) {
  const double sine = math::sine_of_turns(turns);
  const double cosine = math::sine_of_turns(turns + 0.25);
  const bool is_odd = freedom % 2 == 1;
  double term = is_odd ? cosine : 1;
  double sum = freedom == 1 ? 0 : term;
  for (std::size_t i = is_odd ? 3 : 2; i < freedom; i += 2) {
    const auto n = static_cast<double>(i);
    term *= cosine * cosine * (n - 1) / n;
    sum += term;
  }
  return is_odd ? 4 * turns + 2 / std::numbers::pi * sine * sum : sine * sum;
}

/// For many degrees of freedom: Abramowitz and Stegun 26.7.5.
double near_normal(double confidence, double freedom) {
  const double x = math::normal_quantile((1 + confidence) / 2);
  const double x3 = x * x * x;
  return x + (x3 + x) / (4 * freedom) +
         (5 * x3 * x * x + 16 * x3 + 3 * x) / (96 * freedom * freedom);
}

} // namespace

double student_t(double confidence, std::size_t freedom) {
  assert(freedom >= 1 && confidence > 0 && confidence < 1);
  constexpr std::size_t few = 1000;
  if (freedom > few)
    return near_normal(confidence, static_cast<double>(freedom));
  double low = 0;
  double high = 0.25;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (within(middle, freedom) < confidence ? low : high) = middle;
  }
  return std::sqrt(static_cast<double>(freedom)) * math::sine_of_turns(low) /
         math::sine_of_turns(low + 0.25);
}

double student_tail(double t, std::size_t freedom) {
  assert(freedom >= 1);
  const double size = std::abs(t);
  const auto n = static_cast<double>(freedom);
  constexpr std::size_t few = 1000;
  if (freedom > few) // Abramowitz and Stegun 26.7.8
    return math::erfc(size * (1 - 1 / (4 * n)) / std::sqrt((1 + size * size / (2 * n)) * 2));
  double low = 0;
  double high = 0.25;
  for (int i = 0; i < 60; ++i) { // the angle whose tangent is t over the root of the freedom
    const double middle = (low + high) / 2;
    const bool is_below =
        std::sqrt(n) * math::sine_of_turns(middle) < size * math::sine_of_turns(middle + 0.25);
    (is_below ? low : high) = middle;
  }
  return std::clamp(1 - within(low, freedom), 0.0, 1.0);
}

estimate mean_of(std::span<const double> values, double confidence) {
  estimate out{values.size(), 0, std::nullopt};
  double squares = 0; // of the distances from the mean, updated value by value
  double count = 0;
  for (const double x : values) {
    ++count;
    const double before = x - out.mean;
    out.mean += before / count;
    squares += before * (x - out.mean);
  }
  if (values.size() >= 2)
    out.half_width =
        student_t(confidence, values.size() - 1) * std::sqrt(squares / (count - 1) / count);
  return out;
}

estimate paired_difference(std::span<const double> a, std::span<const double> b,
                           double confidence) {
  assert(a.size() == b.size());
  std::vector<double> differences;
  differences.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    differences.push_back(b[i] - a[i]);
  return mean_of(differences, confidence);
}

namespace {

double quantile_of_sorted(const std::vector<double>& sorted, double q) {
  const double place = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const auto above = std::min(below + 1, sorted.size() - 1);
  const double part = place - static_cast<double>(below);
  return sorted[below] + part * (sorted[above] - sorted[below]);
}

} // namespace

double quantile(std::span<const double> values, double q) {
  assert(!values.empty() && q >= 0 && q <= 1);
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  return quantile_of_sorted(sorted, q);
}

namespace {

interval middle_of(std::vector<double>& found, double confidence) {
  std::ranges::sort(found);
  return {quantile_of_sorted(found, (1 - confidence) / 2),
          quantile_of_sorted(found, (1 + confidence) / 2)};
}

} // namespace

interval bootstrap_quantile(std::span<const double> values, double q, random_stream& random,
                            std::size_t samples, double confidence) {
  assert(!values.empty() && samples > 0);
  std::vector<double> found;
  found.reserve(samples);
  std::vector<double> sample(values.size());
  for (std::size_t i = 0; i < samples; ++i) {
    for (auto& each : sample)
      each = values[random.below(values.size())];
    found.push_back(quantile(sample, q));
  }
  return middle_of(found, confidence);
}

interval bootstrap_difference(std::span<const double> a, std::span<const double> b, double q,
                              random_stream& random, std::size_t samples, double confidence) {
  assert(!a.empty() && a.size() == b.size() && samples > 0);
  std::vector<double> found;
  found.reserve(samples);
  std::vector<double> of_a(a.size());
  std::vector<double> of_b(b.size());
  for (std::size_t i = 0; i < samples; ++i) {
    for (std::size_t j = 0; j < a.size(); ++j) {
      const auto pair = random.below(a.size());
      of_a[j] = a[pair];
      of_b[j] = b[pair];
    }
    found.push_back(quantile(of_b, q) - quantile(of_a, q));
  }
  return middle_of(found, confidence);
}

} // namespace rubicon::study
