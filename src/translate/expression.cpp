#include "translate/expression.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <utility>

namespace rubicon::translate {

/// Recursive descent; each rule appends its steps, or notes the first problem.
class expression::parser {
public:
  explicit parser(std::string_view text) : text_(text) {}

  std::variant<expression, expression_problem> run() {
    if (text_.size() > expression::text_max)
      return expression_problem{expression::text_max,
                                "more than " + std::to_string(expression::text_max) + " octets"};
    sum();
    if (!problem_ && !at_end())
      complain("an operator is expected, not `" + here() + '`');
    if (problem_)
      return *problem_;
    expression out;
    out.steps_ = std::move(steps_);
    return out;
  }

private:
  struct function {
    std::string_view name;
    operation what;
    unsigned arguments;
  };

  static constexpr std::array<function, 7> functions{{{"abs", operation::abs, 1},
                                                      {"floor", operation::floor, 1},
                                                      {"ceil", operation::ceil, 1},
                                                      {"round", operation::round, 1},
                                                      {"sqrt", operation::sqrt, 1},
                                                      {"min", operation::min, 2},
                                                      {"max", operation::max, 2}}};

  void complain(std::string message) {
    if (!problem_)
      problem_ = expression_problem{at_, std::move(message)};
  }

  void skip_blanks() {
    while (at_ < text_.size() && text_[at_] == ' ')
      ++at_;
  }

  bool at_end() {
    skip_blanks();
    return at_ == text_.size();
  }

  bool take(char c) {
    if (at_end() || text_[at_] != c)
      return false;
    ++at_;
    return true;
  }

  void expect(char c) {
    if (!problem_ && !take(c))
      complain(std::string("`") + c + "` is expected");
  }

  /// What stands here, in a complaint.
  [[nodiscard]] std::string here() const { return std::string(text_.substr(at_, 1)); }

  void sum() {
    product();
    while (!problem_) {
      if (take('+'))
        then(operation::add, [this] { product(); });
      else if (take('-'))
        then(operation::subtract, [this] { product(); });
      else
        return;
    }
  }

  void product() {
    factor();
    while (!problem_) {
      if (take('*'))
        then(operation::multiply, [this] { factor(); });
      else if (take('/'))
        then(operation::divide, [this] { factor(); });
      else
        return;
    }
  }

  template <class Operand>
  void then(operation what, Operand operand) {
    operand();
    steps_.push_back({what, 0});
  }

  void factor() {
    if (at_end()) {
      complain("a number, `x`, a function or `(` is expected");
      return;
    }
    if (depth_ == expression::depth_max) {
      complain("nested more than " + std::to_string(expression::depth_max) + " deep");
      return;
    }
    ++depth_;
    const char c = text_[at_];
    if (take('-')) {
      factor();
      steps_.push_back({operation::negate, 0});
    } else if (take('(')) {
      sum();
      expect(')');
    } else if (c >= 'a' && c <= 'z') {
      word();
    } else {
      number();
    }
    --depth_;
  }

  void number() {
    double value = 0;
    const auto rest = text_.substr(at_);
    const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) {
      complain("a number, `x`, a function or `(` is expected, not `" + here() + '`');
      return;
    }
    at_ += static_cast<std::size_t>(stop - rest.data());
    steps_.push_back({operation::number, value});
  }

  void word() {
    const auto rest = text_.substr(at_);
    const auto end = std::ranges::find_if_not(rest, [](char c) { return c >= 'a' && c <= 'z'; });
    const auto name = rest.substr(0, static_cast<std::size_t>(end - rest.begin()));
    if (name == "x") {
      ++at_;
      steps_.push_back({operation::variable, 0});
      return;
    }
    const auto* const found = std::ranges::find(functions, name, &function::name);
    if (found == functions.end()) {
      complain("`" + std::string(name) + "` is neither `x` nor a function: there are " +
               "abs, floor, ceil, round, sqrt, min and max");
      return;
    }
    at_ += name.size();
    expect('(');
    for (unsigned i = 0; i < found->arguments && !problem_; ++i) {
      if (i > 0)
        expect(',');
      if (!problem_)
        sum();
    }
    expect(')');
    steps_.push_back({found->what, 0});
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t depth_ = 0;
  std::vector<step> steps_;
  std::optional<expression_problem> problem_;
};

std::variant<expression, expression_problem> expression::parse(std::string_view text) {
  return parser(text).run();
}

std::optional<double> expression::operator()(double x) const {
  std::vector<double> stack;
  const auto pop = [&stack] {
    assert(!stack.empty());
    const auto value = stack.back();
    stack.pop_back();
    return value;
  };
  for (const auto& [what, value] : steps_) {
    if (what == operation::number || what == operation::variable) {
      stack.push_back(what == operation::number ? value : x);
      continue;
    }
    const auto b = pop();
    const auto a = what >= operation::add ? pop() : b;
    switch (what) {
    case operation::negate:
      stack.push_back(-b);
      break;
    case operation::abs:
      stack.push_back(std::fabs(b));
      break;
    case operation::floor:
      stack.push_back(std::floor(b));
      break;
    case operation::ceil:
      stack.push_back(std::ceil(b));
      break;
    case operation::round:
      stack.push_back(std::round(b));
      break;
    case operation::sqrt:
      stack.push_back(std::sqrt(b));
      break;
    case operation::add:
      stack.push_back(a + b);
      break;
    case operation::subtract:
      stack.push_back(a - b);
      break;
    case operation::multiply:
      stack.push_back(a * b);
      break;
    case operation::divide:
      stack.push_back(a / b);
      break;
    case operation::min:
      stack.push_back(std::min(a, b));
      break;
    case operation::max:
      stack.push_back(std::max(a, b));
      break;
    case operation::number:
    case operation::variable:
      break; // above
    }
  }
  const auto result = pop();
  assert(stack.empty());
  return std::isfinite(result) ? std::optional(result) : std::nullopt;
}

} // namespace rubicon::translate
