#include "radio/medium/reception.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/numbers/math.hpp"
#include "radio/medium/power.hpp"

namespace rubicon::radio {

namespace {

// Over a step of sinr damage falls by at most 4 %, so a straight line is off by 0.02 %.
constexpr double steps_per_unit = 256;
constexpr double damage_max = 1e4; // sure loss

constexpr int tossim_power = 46;

/// The chance whose 46th power is TOSSIM's curve: 1 - erfc(x) / 2 = erfc(-x) / 2.
double tossim_base(double snr_db) {
  constexpr double sqrt_2 = 1.41421356237309504880;
  return 0.5 * math::erfc(-0.9794 * (snr_db - 2.3851) / sqrt_2);
}

double exact_damage(error_curve curve, double sinr) {
  switch (curve) {
  case error_curve::oqpsk:
    return -math::log(1 - bit_error_rate(sinr));
  case error_curve::tossim:
    if (const auto chance = sinr > 0 ? tossim_base(to_db(sinr)) : 0; chance > 0)
      return std::min(-tossim_power * math::log(chance), damage_max);
    return damage_max;
  }
  return damage_max;
}

/// @param end the sinr from which on damage is nothing
std::vector<float> damage_table(error_curve curve, double end) {
  std::vector<float> table;
  const auto steps = static_cast<std::size_t>(end * steps_per_unit);
  table.reserve(steps + 1);
  for (std::size_t i = 0; i <= steps; ++i)
    table.push_back(
        static_cast<float>(exact_damage(curve, static_cast<double>(i) / steps_per_unit)));
  return table;
}

std::span<const float> shared_table(error_curve curve) {
  static const auto oqpsk = damage_table(error_curve::oqpsk, 3);     // 4.8 dB
  static const auto tossim = damage_table(error_curve::tossim, 8.5); // 9.3 dB
  return curve == error_curve::oqpsk ? oqpsk : tossim;
}

} // namespace

double bit_error_rate(double sinr) {
  constexpr std::array<double, 17> choose{1,     16,   120,  560,  1820, 4368, 8008, 11440, 12870,
                                          11440, 8008, 4368, 1820, 560,  120,  16,   1};
  assert(sinr >= 0);
  double sum = 0;
  for (std::size_t k = 16; k >= 2; --k) {
    const auto term = choose[k] * math::exp(20 * sinr * (1 / static_cast<double>(k) - 1));
    sum += k % 2 == 0 ? term : -term;
  }
  return std::clamp(sum * 8 / 15 / 16, 0.0, 0.5);
}

double tossim_reception_rate(double snr_db) {
  const auto chance = tossim_base(snr_db);
  const auto square = chance * chance;
  const auto fourth = square * square;
  const auto eighth = fourth * fourth;
  const auto sixteenth = eighth * eighth;
  static_assert(tossim_power == 2 * 16 + 8 + 4 + 2);
  return sixteenth * sixteenth * eighth * fourth * square;
}

double sinr_at_sensitivity(error_curve curve) {
  constexpr double octets = 6 + 20; // preamble, SFD and length are on the air, too
  const auto parts = curve == error_curve::oqpsk ? 8 * octets : 2;
  const auto allowed = -math::log(0.99) / parts;
  double low = 0;
  double high = 16;
  for (int i = 0; i < 60; ++i) {
    const auto middle = (low + high) / 2;
    (exact_damage(curve, middle) > allowed ? low : high) = middle;
  }
  return high;
}

error_model::error_model(error_curve curve) : curve_(curve), table_(shared_table(curve)) {}

double error_model::damage(double sinr) const {
  assert(sinr >= 0);
  const auto at = sinr * steps_per_unit;
  if (at >= static_cast<double>(table_.size() - 1))
    return 0;
  const auto step = static_cast<std::size_t>(at);
  const double low = table_[step];
  const double high = table_[step + 1];
  return low + (high - low) * (at - static_cast<double>(step));
}

} // namespace rubicon::radio
