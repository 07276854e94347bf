#include "core/numbers/math.hpp"

#include <array>
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

/// c[0] + c[1] x + c[2] x^2 + ...
double polynomial(const std::array<double, 8>& c, double x) {
  double sum = 0;
  for (auto each = c.rbegin(); each != c.rend(); ++each)
    sum = sum * x + *each;
  return sum;
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

double erfc(double x) {
  constexpr double sqrt_pi = 1.77245385090551602730;
  if (x < 0)
    return 2 - erfc(-x);
  if (x > 26)
    return 0;
  const auto square = x * x;
  if (x < 2) { // Abramowitz and Stegun 7.1.6: all terms have one sign
    auto term = x;
    auto sum = x;
    for (int n = 1; n <= 40; ++n) {
      term *= 2 * square / (2 * n + 1);
      sum += term;
    }
    return 1 - 2 / sqrt_pi * exp(-square) * sum;
  }
  auto fraction = x; // Abramowitz and Stegun 7.1.14
  for (int n = 60; n >= 1; --n)
    fraction = x + n / (2 * fraction);
  return exp(-square) / (sqrt_pi * fraction);
}

double normal_quantile(double p) { // Wichura 1988, AS 241, PPND16
  constexpr std::array<double, 8> a{3.3871328727963666080,    1.3314166789178437745e+2,
                                    1.9715909503065514427e+3, 1.3731693765509461125e+4,
                                    4.5921953931549871457e+4, 6.7265770927008700853e+4,
                                    3.3430575583588128105e+4, 2.5090809287301226727e+3};
  constexpr std::array<double, 8> b{1,
                                    4.2313330701600911252e+1,
                                    6.8718700749205790830e+2,
                                    5.3941960214247511077e+3,
                                    2.1213794301586595867e+4,
                                    3.9307895800092710610e+4,
                                    2.8729085735721942674e+4,
                                    5.2264952788528545610e+3};
  constexpr std::array<double, 8> c{1.42343711074968357734,    4.63033784615654529590,
                                    5.76949722146069140550,    3.64784832476320460504,
                                    1.27045825245236838258,    2.41780725177450611770e-1,
                                    2.27238449892691845833e-2, 7.74545014278341407640e-4};
  constexpr std::array<double, 8> d{1,
                                    2.05319162663775882187,
                                    1.67638483018380384940,
                                    6.89767334985100004550e-1,
                                    1.48103976427480074590e-1,
                                    1.51986665636164571966e-2,
                                    5.47593808499534494600e-4,
                                    1.05075007164441684324e-9};
  assert(p >= 1e-10 && p <= 1 - 1e-10);
  const auto from_middle = p - 0.5;
  if (std::abs(from_middle) <= 0.425) {
    const auto x = 0.180625 - from_middle * from_middle;
    return from_middle * polynomial(a, x) / polynomial(b, x);
  }
  const auto x = std::sqrt(-log(p < 0.5 ? p : 1 - p)) - 1.6;
  const auto size = polynomial(c, x) / polynomial(d, x);
  return p < 0.5 ? -size : size;
}

double length(double x, double y, double z) {
  return std::sqrt(x * x + y * y + z * z);
}

} // namespace rubicon::math
