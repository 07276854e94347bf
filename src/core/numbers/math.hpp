// Transcendental functions with the same bits on every machine. libm's differ in the last place
// from one machine to the next; what decides anything in a run must use these (design.md section
// 5).
#pragma once

namespace rubicon::math {

/// Natural logarithm, relative error below 1e-14. @pre x > 0 and finite
[[nodiscard]] double log(double x);

/// Decimal logarithm. @pre x > 0 and finite
[[nodiscard]] double log10(double x);

/// e to the x; 0 below -745, infinity above 709.
[[nodiscard]] double exp(double x);

/// Sine of an angle in turns: sine_of_turns(0.25) is 1. Error below 1e-14 for |x| < 2^31.
[[nodiscard]] double sine_of_turns(double x);

/// Complementary error function, relative error below 1e-12; 0 above 26, where it is below 1e-295.
[[nodiscard]] double erfc(double x);

/// The number that a standard normal deviate is below with chance p, relative error below 1e-13
/// away from 0. @pre 1e-10 <= p <= 1 - 1e-10
[[nodiscard]] double normal_quantile(double p);

/// Distance from the origin of (x, y, z).
[[nodiscard]] double length(double x, double y, double z);

} // namespace rubicon::math
