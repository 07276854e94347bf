// Arithmetic on one number, as somebody writes it into a file: `(x - 400) * 0.5` (SVC-09).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rubicon::translate {

/// What is wrong with the text of an expression.
struct expression_problem {
  std::size_t at = 0; ///< octets before the mistake
  std::string message;

  friend bool operator==(const expression_problem&, const expression_problem&) = default;
};

/// From the loosest to the tightest: `+` and `-`, `*` and `/`, a sign. Then decimal numbers, `x`,
/// parentheses, and abs(a), floor(a), ceil(a), round(a), sqrt(a), min(a, b), max(a, b); blanks mean
/// nothing. Only operations that IEEE 754 rounds exactly, so that every machine comes to the same.
class expression {
public:
  static constexpr std::size_t text_max = 200; ///< octets
  static constexpr std::size_t depth_max = 32; ///< of parentheses, calls and signs

  /// The number itself: `x`.
  expression() : steps_{{operation::variable, 0}} {}

  [[nodiscard]] static std::variant<expression, expression_problem> parse(std::string_view text);

  /// @returns nothing unless the result is finite
  [[nodiscard]] std::optional<double> operator()(double x) const;

private:
  class parser;

  enum class operation : std::uint8_t {
    number,
    variable, // put on a stack; the next take one from it, the others two
    negate,
    abs,
    floor,
    ceil,
    round,
    sqrt,
    add,
    subtract,
    multiply,
    divide,
    min,
    max
  };

  struct step {
    operation what = operation::number;
    double value = 0; ///< of a number
  };

  std::vector<step> steps_; ///< in the order in which they are done
};

} // namespace rubicon::translate
