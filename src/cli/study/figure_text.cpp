#include "cli/study/figure_text.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/decimal.hpp"

namespace rubicon::cli {

std::string number_text(double x) {
  constexpr int digits = 5;
  constexpr int decimals_max = 6;
  int decimals = decimals_max;
  if (x != 0)
    decimals = digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(x))));
  return decimal_text(x, std::clamp(decimals, 0, decimals_max));
}

std::string interval_text(const study::interval& x) {
  return number_text(x.low) + " to " + number_text(x.high);
}

std::string interval_text(const study::estimate& x) {
  return x.half_width
             ? interval_text(study::interval{x.mean - *x.half_width, x.mean + *x.half_width})
             : std::string();
}

std::string percent_text(double ratio) {
  auto text = decimal_text(100 * ratio, 2);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.'))
    text.pop_back();
  return text + " %";
}

} // namespace rubicon::cli
