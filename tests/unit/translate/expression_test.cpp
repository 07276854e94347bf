#include <string>
#include <variant>

#include "support/catch.hpp"
#include "translate/expression.hpp"

using rubicon::translate::expression;
using rubicon::translate::expression_problem;

namespace {

double value(const std::string& text, double x) {
  const auto parsed = expression::parse(text);
  REQUIRE(std::holds_alternative<expression>(parsed));
  return std::get<expression>(parsed)(x).value();
}

std::string problem(const std::string& text) {
  const auto parsed = expression::parse(text);
  if (const auto* wrong = std::get_if<expression_problem>(&parsed))
    return std::to_string(wrong->at) + ": " + wrong->message;
  return "none";
}

} // namespace

TEST_CASE("an expression is arithmetic as it is written", "[translate][SVC-09]") {
  struct row {
    const char* text;
    double x;
    double result;
  };
  const auto r = GENERATE(values<row>({
      {"x", 3, 3},
      {"x + 2 * 3", 1, 7},
      {"(x + 2) * 3", 1, 9},
      {"10 - x - 3", 2, 5},
      {"100 / x / 5", 4, 5},
      {"-x", 3, -3},
      {"--x", 3, 3},
      {"2 * -x + 1", 3, -5},
      {"1.5e2 + .5", 0, 150.5},
      {"abs(x)", -4.5, 4.5},
      {"floor(x)", -1.5, -2},
      {"ceil(x)", 1.25, 2},
      {"round(x)", 2.5, 3},
      {"sqrt(x)", 9, 3},
      {"min(x, 4) + max(x, 4)", 7, 11},
      {"max(0,min(100,(x-400)*0.5))", 500, 50},
      {"  x  ", 1, 1},
  }));
  CAPTURE(r.text);
  CHECK(value(r.text, r.x) == r.result);
}

TEST_CASE("a mistake in an expression is reported with its place", "[translate][SVC-09][GEN-06]") {
  struct row {
    std::string text;
    const char* problem;
  };
  const auto r = GENERATE(values<row>({
      {"", "0: a number, `x`, a function or `(` is expected"},
      {"x +", "3: a number, `x`, a function or `(` is expected"},
      {"x 2", "2: an operator is expected, not `2`"},
      {"(x", "2: `)` is expected"},
      {"x)", "1: an operator is expected, not `)`"},
      {"y",
       "0: `y` is neither `x` nor a function: there are abs, floor, ceil, round, sqrt, min and "
       "max"},
      {"xx", "0: `xx` is neither `x` nor a function: there are abs, floor, ceil, round, sqrt, min "
             "and max"},
      {"abs x", "4: `(` is expected"},
      {"min(x)", "5: `,` is expected"},
      {"abs(x, 1)", "5: `)` is expected"},
      {"2 + #", "4: a number, `x`, a function or `(` is expected, not `#`"},
      {"1e999", "0: a number, `x`, a function or `(` is expected, not `1`"},
      {"2nan", "1: an operator is expected, not `n`"},
      {std::string(201, 'x'), "200: more than 200 octets"},
  }));
  CAPTURE(r.text);
  CHECK(problem(r.text) == r.problem);
}

TEST_CASE("an expression is nested at most so deep", "[translate][SVC-09]") {
  const std::size_t most = expression::depth_max - 1; // the innermost is `x`
  CHECK(problem(std::string(most, '(') + "x" + std::string(most, ')')) == "none");
  CHECK(problem(std::string(most + 1, '(') + "x" + std::string(most + 1, ')')) ==
        "32: nested more than 32 deep");
  CHECK(problem(std::string(most, '-') + "x") == "none");
  CHECK(problem(std::string(most + 1, '-') + "x") == "32: nested more than 32 deep");
}

TEST_CASE("a result that is no finite number is none", "[translate][SVC-09]") {
  const auto f = [](const char* text) { return std::get<expression>(expression::parse(text)); };
  CHECK(!f("1 / x")(0));
  CHECK(f("1 / x")(2) == 0.5);
  CHECK(!f("sqrt(x)")(-1));
  CHECK(!f("x * x")(1e200));
  CHECK(!f("x / x")(0));
}
