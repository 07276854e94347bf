// A condition on the value of a tuple, as `rubicon tuples wait` takes it (SVC-08).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rubicon::cli {

/// Numbers are compared as numbers where both are some. Only numbers are less or greater.
struct condition {
  enum class relation : std::uint8_t {
    equal,
    unequal,
    less,
    less_or_equal,
    greater,
    greater_or_equal
  };

  relation kind = relation::equal;
  std::string value;

  [[nodiscard]] bool holds(std::string_view text) const;
};

/// `on`, `= on`, `!= off`, `> 20`, `<=3`: a relation, = if there is none, and a value. Nothing:
/// `<`,
/// `<=`, `>` and `>=` need a number.
[[nodiscard]] std::optional<condition> parse_condition(std::string_view text);

} // namespace rubicon::cli
