#include "cli/words/condition.hpp"

#include <algorithm>
#include <array>

#include "core/text/decimal.hpp"

namespace rubicon::cli {

namespace {

using relation = condition::relation;

struct sign {
  std::string_view text;
  relation kind;
};
constexpr std::array<sign, 6> signs{{{"!=", relation::unequal},
                                     {"<=", relation::less_or_equal},
                                     {">=", relation::greater_or_equal},
                                     {"=", relation::equal},
                                     {"<", relation::less},
                                     {">", relation::greater}}};

bool is_equality(relation x) {
  return x == relation::equal || x == relation::unequal;
}

} // namespace

bool condition::holds(std::string_view text) const {
  const auto is = number_in(text);
  const auto wanted = number_in(value);
  if (!is || !wanted)
    return is_equality(kind) && (text == value) == (kind == relation::equal);
  switch (kind) {
  case relation::equal:
    return *is == *wanted;
  case relation::unequal:
    return *is != *wanted;
  case relation::less:
    return *is < *wanted;
  case relation::less_or_equal:
    return *is <= *wanted;
  case relation::greater:
    return *is > *wanted;
  case relation::greater_or_equal:
    return *is >= *wanted;
  }
  return false;
}

std::optional<condition> parse_condition(std::string_view text) {
  condition x;
  for (const auto& each : signs) {
    if (text.starts_with(each.text)) {
      x.kind = each.kind;
      text.remove_prefix(each.text.size());
      text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
      break;
    }
  }
  x.value = text;
  if (!is_equality(x.kind) && !number_in(x.value))
    return std::nullopt;
  return x;
}

} // namespace rubicon::cli
