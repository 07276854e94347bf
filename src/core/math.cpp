#include "core/math.hpp"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

// Only + - * / and sqrt below: IEEE 754 fixes their results, and the build turns contraction off.
namespace rubicon::math {

namespace {

constexpr double ln2 = 0.69314718055994530942;
constexpr double ln2_high = 0.693147180369123816490; // trailing zeros: k * ln2_high is exact
constexpr double ln2_low = 1.90821492927058770002e-10;
constexpr double ln10 = 2.30258509299404568402;

double times_power_of_two(double x, int k) {
  while (k > 1000) {
    x *= 0x1p1000;
    k -= 1000;
  }
  while (k < -1000) {
    x *= 0x1p-1000;
    k += 1000;
  }
  return x * std::bit_cast<double>(static_cast<std::uint64_t>(1023 + k) << 52);
}

} // namespace

double log(double x) {
  assert(x > 0 && x <= std::numeric_limits<double>::max());
  int exponent = 0;
  if (x < 0x1p-1022) { // subnormal
    x *= 0x1p54;
    exponent = -54;
  }
  const auto bits = std::bit_cast<std::uint64_t>(x);
  exponent += static_cast<int>(bits >> 52) - 1023;
  auto mantissa = std::bit_cast<double>((bits & 0x000fffffffffffffULL) | 0x3ff0000000000000ULL);
  if (mantissa > 1.4142135623730951) {
    mantissa /= 2;
    ++exponent;
  }
  // ln m = 2 artanh t, t = (m - 1) / (m + 1), |t| < 0.172
  const auto t = (mantissa - 1) / (mantissa + 1);
  const auto t2 = t * t;
  double sum = 0;
  for (int n = 21; n >= 1; n -= 2)
    sum = sum * t2 + 1.0 / n;
  return 2 * t * sum + exponent * ln2;
}

double log10(double x) {
  return log(x) / ln10;
}

double exp(double x) {
  if (x < -745)
    return 0;
  if (x > 709)
    return std::numeric_limits<double>::infinity();
  const auto k = static_cast<int>(x / ln2 + (x < 0 ? -0.5 : 0.5));
  const auto r = (x - k * ln2_high) - k * ln2_low; // |r| <= 0.35
  double sum = 1;
  for (int n = 15; n >= 1; --n)
    sum = 1 + sum * r / n;
  return times_power_of_two(sum, k);
}

double sine_of_turns(double x) {
  auto turns = x - static_cast<double>(static_cast<std::int64_t>(x)); // (-1, 1)
  if (turns > 0.5)
    turns -= 1;
  else if (turns < -0.5)
    turns += 1;
  if (turns > 0.25) // sin(pi - a) = sin a
    turns = 0.5 - turns;
  else if (turns < -0.25)
    turns = -0.5 - turns;
  const auto angle = turns * 6.28318530717958647693; // |angle| <= pi/2
  const auto square = angle * angle;
  double sum = 1;
  for (int n = 22; n >= 2; n -= 2)
    sum = 1 - sum * square / (n * (n + 1));
  return angle * sum;
}

double length(double x, double y, double z) {
  return std::sqrt(x * x + y * y + z * z);
}

} // namespace rubicon::math
