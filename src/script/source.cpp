#include "script/source.hpp"

#include <algorithm>

#include "script/state.hpp"

namespace rubicon::script {

namespace {

/// Goes through a text, part by part.
class scanner {
public:
  explicit scanner(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] unsigned line() const { return line_; }
  [[nodiscard]] bool starts_with(std::string_view x) const {
    return text_.substr(at_).starts_with(x);
  }

  char take() {
    const char x = text_[at_++];
    line_ += x == '\n' ? 1 : 0;
    return x;
  }

  /// `[[` or `[==[`: to the end of what it opens. @returns whether there was one
  bool skip_long() {
    const auto rest = text_.substr(at_);
    const auto level = rest.find_first_not_of('=', 1);
    if (!rest.starts_with('[') || level == std::string_view::npos || rest[level] != '[')
      return false;
    const auto closing = ']' + std::string(level - 1, '=') + ']';
    while (!at_end() && !starts_with(closing))
      take();
    for (std::size_t i = 0; i < closing.size() && !at_end(); ++i)
      take();
    return true;
  }

  void skip_comment() {
    at_ += 2;
    if (skip_long())
      return;
    while (!at_end() && !starts_with("\n"))
      take();
  }

  void skip_quoted() {
    const char quote = take();
    while (!at_end()) {
      const char x = take();
      if (x == quote || x == '\n')
        return;
      if (x == '\\' && !at_end())
        take();
    }
  }

private:
  std::string_view text_;
  std::size_t at_ = 0;
  unsigned line_ = 1;
};

/// `x:12: message` as Lua writes it.
source_problem problem_of(const std::string& text) {
  const auto first = text.find(':');
  const auto second = text.find(": ", first + 1);
  if (first == std::string::npos || second == std::string::npos)
    return {0, text};
  unsigned line = 0;
  for (const char x : text.substr(first + 1, second - first - 1)) {
    if (x < '0' || x > '9')
      return {0, text};
    line = line * 10 + static_cast<unsigned>(x - '0');
  }
  return {line, text.substr(second + 2)};
}

} // namespace

unsigned line_of_power(std::string_view text) {
  scanner in(text);
  while (!in.at_end()) {
    if (in.starts_with("--"))
      in.skip_comment();
    else if (in.starts_with("\"") || in.starts_with("'"))
      in.skip_quoted();
    else if (in.starts_with("^"))
      return in.line();
    else if (!in.skip_long())
      in.take();
  }
  return 0;
}

std::optional<source_problem> check(const source& x, const limits& most) {
  state compiler(most, random_stream());
  if (!compiler.load({"x", x.text}))
    return problem_of(compiler.failure());
  return std::nullopt;
}

} // namespace rubicon::script
