#include "radio/medium/power.hpp"

#include <cassert>
#include <cmath>
#include <limits>

#include "core/numbers/math.hpp"

namespace rubicon::radio {

namespace {

constexpr double units_per_mw = 1e16;
constexpr double ln10 = 2.30258509299404568402;

} // namespace

power_units to_units(double dbm) {
  assert(dbm <= 30);
  if (dbm < -160)
    return 0;
  return static_cast<power_units>(
      static_cast<float>(std::floor(from_db(dbm) * units_per_mw + 0.5)));
}

double to_dbm(power_units x) {
  return x == 0 ? -std::numeric_limits<double>::infinity()
                : to_db(static_cast<double>(x) / units_per_mw);
}

double from_db(double db) {
  return math::exp(db * (ln10 / 10));
}

double to_db(double ratio) {
  return 10 * math::log10(ratio);
}

} // namespace rubicon::radio
