#include "page/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "report/figures.hpp"

namespace rubicon::page {

std::string number(double x, double step) {
  const auto digits = step > 0 ? static_cast<int>(std::ceil(-std::log10(step) - 1e-9)) : 3;
  return report::fixed(x, std::clamp(digits, 0, 9));
}

std::vector<tick> ticks(double low, double high, int count) {
  std::vector<tick> all;
  const auto wide = high - low;
  if (!(wide > 0) || !std::isfinite(wide))
    return all;
  const auto rough = wide / std::max(count, 1);
  const auto decade = std::pow(10.0, std::floor(std::log10(rough)));
  auto step = 10 * decade;
  for (const auto each : {1.0, 2.0, 5.0})
    if (each * decade >= rough * 0.999) {
      step = each * decade;
      break;
    }
  for (auto i = std::ceil(low / step - 1e-9); i * step <= high + step * 1e-9; ++i)
    all.push_back({i * step, number(i * step + 0.0, step)}); // -0 is 0
  return all;
}

std::vector<tick> time_ticks(duration length, int count) {
  constexpr std::array<duration, 22> steps{
      1s,    2s,    5s, 10s, 15s, 30s, 1min, 2min, 5min,    10min,    15min,
      30min, 60min, 2h, 3h,  6h,  12h, 24h,  48h,  7 * 24h, 14 * 24h, 28 * 24h};
  const auto rough = length / std::max(count, 1);
  auto step = steps.back();
  const auto found = std::ranges::lower_bound(steps, rough);
  if (found != steps.end())
    step = *found;
  else if (rough > step)
    step *= (rough / step + 1);
  if (length < 2s) {
    auto all = ticks(0, seconds(length), count);
    for (auto& x : all)
      x.label += " s";
    return all;
  }
  std::vector<tick> all;
  for (duration at{}; at <= length; at += step)
    all.push_back({seconds(at), report::clock_text(at)});
  return all;
}

} // namespace rubicon::page
