#include "study/grid.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace rubicon::study {

namespace {

/// A decimal number times a power of ten, and its unit: exact, unlike sums of binary fractions.
struct quantity {
  std::int64_t digits = 0;
  unsigned decimals = 0;
  std::string_view unit;
};

constexpr unsigned decimals_max = 9;
constexpr std::int64_t digits_max = 1'000'000'000;

std::optional<quantity> parse_quantity(std::string_view text) {
  quantity out;
  const bool is_negative = text.starts_with('-');
  std::size_t i = is_negative ? 1 : 0;
  const auto first = i;
  bool has_point = false;
  for (; i < text.size() && ((text[i] >= '0' && text[i] <= '9') || text[i] == '.'); ++i) {
    if (text[i] == '.') {
      if (has_point)
        return std::nullopt;
      has_point = true;
      continue;
    }
    out.digits = 10 * out.digits + (text[i] - '0');
    out.decimals += has_point ? 1 : 0;
    if (out.digits > digits_max || out.decimals > decimals_max)
      return std::nullopt;
  }
  if (i == first || text[i - 1] == '.' || text[first] == '.')
    return std::nullopt;
  out.unit = text.substr(i);
  const bool is_unit =
      std::ranges::all_of(out.unit, [](char x) { return x != ' ' && x != '/' && x != ','; });
  if (is_negative)
    out.digits = -out.digits;
  return is_unit ? std::optional(out) : std::nullopt;
}

std::int64_t scaled(quantity x, unsigned decimals) {
  for (; x.decimals < decimals; ++x.decimals)
    x.digits *= 10; // below 1e18
  return x.digits;
}

std::string text_of(std::int64_t digits, unsigned decimals, std::string_view unit) {
  auto text = std::to_string(digits < 0 ? -digits : digits);
  if (decimals > 0) {
    if (text.size() <= decimals)
      text.insert(0, decimals + 1 - text.size(), '0');
    text.insert(text.size() - decimals, 1, '.');
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.'))
      text.pop_back();
  }
  return (digits < 0 ? "-" : "") + text + std::string(unit);
}

/// The values of `15m..40m/5`; nothing if that is no range.
std::optional<std::vector<std::string>> range_of(std::string_view text) {
  const auto dots = text.find("..");
  const auto slash = text.rfind('/');
  if (dots == std::string_view::npos || slash == std::string_view::npos || slash < dots)
    return std::nullopt;
  const auto first = parse_quantity(text.substr(0, dots));
  const auto last = parse_quantity(text.substr(dots + 2, slash - dots - 2));
  const auto step = parse_quantity(text.substr(slash + 1));
  if (!first || !last || !step || first->unit != last->unit ||
      (!step->unit.empty() && step->unit != first->unit))
    return std::nullopt;
  const auto decimals = std::max({first->decimals, last->decimals, step->decimals});
  const auto from = scaled(*first, decimals);
  const auto to = scaled(*last, decimals);
  const auto by = scaled(*step, decimals);
  std::vector<std::string> out;
  if (by <= 0 || to < from)
    return std::nullopt;
  for (auto i = from; i <= to && out.size() <= values_max; i += by)
    out.push_back(text_of(i, decimals, first->unit));
  return out;
}

std::vector<std::string> list_of(std::string_view text) {
  std::vector<std::string> out(1);
  int depth = 0;
  char quote = 0;
  for (const char x : text) {
    if (quote != 0)
      quote = x == quote ? '\0' : quote;
    else if (x == '"' || x == '\'')
      quote = x;
    else if (x == '[' || x == '{')
      ++depth;
    else if (x == ']' || x == '}')
      --depth;
    if (x == ',' && depth == 0 && quote == 0)
      out.emplace_back();
    else
      out.back() += x;
  }
  return out;
}

} // namespace

std::variant<variation, std::string> parse_variation(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0)
    return "needs a key and its values, as in loss=0,0.1,0.2 or range=15m..40m/5";
  variation out{std::string(text.substr(0, equals)), {}};
  const auto values = text.substr(equals + 1);
  if (auto range = range_of(values)) {
    out.values = *std::move(range);
  } else {
    out.values = list_of(values);
    if (out.values.size() == 1 && values.find("..") != std::string_view::npos)
      return "is not a range: give first, last and step in one unit, as in range=15m..40m/5";
  }
  if (out.values.size() > values_max)
    return "has more than " + std::to_string(values_max) + " values";
  auto sorted = out.values;
  std::ranges::sort(sorted);
  if (std::ranges::find(sorted, std::string()) != sorted.end())
    return "has an empty value";
  if (std::ranges::adjacent_find(sorted) != sorted.end())
    return "has a value twice";
  return out;
}

std::variant<std::vector<variant_values>, std::string>
variants_of(const std::vector<variation>& all) {
  std::vector<variant_values> out(1);
  for (const auto& each : all) {
    if (out.size() * each.values.size() > variants_max)
      return "there are more than " + std::to_string(variants_max) + " variants";
    std::vector<variant_values> longer;
    longer.reserve(out.size() * each.values.size());
    for (const auto& before : out) {
      for (const auto& value : each.values) {
        longer.push_back(before);
        longer.back().push_back(value);
      }
    }
    out = std::move(longer);
  }
  return out;
}

} // namespace rubicon::study
