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

/// Distance from the origin of (x, y, z).
[[nodiscard]] double length(double x, double y, double z);

} // namespace rubicon::math
