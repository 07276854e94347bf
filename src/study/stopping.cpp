#include "study/stopping.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/text/decimal.hpp"

namespace rubicon::study {

namespace {

std::string_view trimmed(std::string_view x) {
  while (!x.empty() && x.front() == ' ')
    x.remove_prefix(1);
  while (!x.empty() && x.back() == ' ')
    x.remove_suffix(1);
  return x;
}

} // namespace

std::variant<stop_rule, std::string> parse_stop_rule(std::string_view text) {
  constexpr std::string_view needed =
      "needs a figure, `ci`, and a limit above zero, as in 'messages.delivery ci < 1%'";
  const auto sign = text.find('<');
  if (sign == std::string_view::npos)
    return std::string(needed);
  const auto left = trimmed(text.substr(0, sign));
  auto right = trimmed(text.substr(sign + 1));
  stop_rule out;
  if (!left.ends_with(" ci"))
    return std::string(needed);
  out.figure = trimmed(left.substr(0, left.size() - 3));
  out.is_relative = right.ends_with('%');
  if (out.is_relative)
    right.remove_suffix(1);
  const auto limit = number_in(trimmed(right));
  if (out.figure.empty() || out.figure.find(' ') != std::string::npos || !limit || *limit <= 0)
    return std::string(needed);
  out.limit = out.is_relative ? *limit / 100 : *limit;
  return out;
}

stopping::stopping(stop_rule rule, std::size_t runs_max) : rule_(std::move(rule)) {
  assert(runs_max > 0);
  for (auto runs = first_look; runs < runs_max; runs *= 2)
    looks_.push_back(runs);
  looks_.push_back(runs_max);
}

double stopping::confidence() const {
  return 1 - (1 - usual_confidence) / static_cast<double>(looks_.size());
}

bool stopping::is_precise(std::span<const std::optional<double>> values) const {
  std::vector<double> known;
  for (const auto& each : values)
    if (each)
      known.push_back(*each);
  const auto x = mean_of(known, confidence());
  return x.half_width && *x.half_width < rule_.limit * (rule_.is_relative ? std::abs(x.mean) : 1);
}

std::size_t stopping::needed(std::span<const std::optional<double>> values) const {
  const auto later = std::ranges::upper_bound(looks_, values.size());
  return later == looks_.end() || (!values.empty() && is_precise(values)) ? values.size() : *later;
}

} // namespace rubicon::study
