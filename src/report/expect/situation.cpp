#include "report/expect/situation.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace rubicon::report {

namespace {

bool is_line(const config::event_line& what, const logged_event& x) {
  return x.what.find(what.text) != std::string::npos && x.who.find(what.who) != std::string::npos;
}

} // namespace

bool equal_keys(std::string_view a, std::string_view b) {
  const auto folded = [](char x) { return x >= 'A' && x <= 'Z' ? static_cast<char>(x + 32) : x; };
  return std::ranges::equal(a, b, {}, folded, folded);
}

bool holds(const config::tuple_condition& x, const std::string* text) {
  if (text == nullptr)
    return false;
  if (!x.equals.empty())
    return std::ranges::find(x.equals, *text) != x.equals.end();
  double value = 0;
  const auto [stop, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  return error == std::errc{} && stop == text->data() + text->size() && std::isfinite(value) &&
         (!x.above || value >= *x.above) && (!x.below || value < *x.below);
}

void situation::on_tuple(const config::sometimes_expectation& what, std::string_view key,
                         const std::string* text, instant now) {
  if (!what.during || !equal_keys(key, what.during->key))
    return;
  const bool held = std::exchange(holds_, holds(*what.during, text));
  if (!held && holds_ && what.line.text.empty())
    reach(now);
}

void situation::on_event(const config::sometimes_expectation& what, const logged_event& x) {
  const bool is_soon =
      !what.after || (before_ && x.at - *before_ <= what.within); // a line is not after itself
  if (!what.line.text.empty() && is_line(what.line, x) && is_soon && (!what.during || holds_))
    reach(x.at);
  if (what.after && is_line(*what.after, x))
    before_ = x.at;
}

void situation::reach(instant now) {
  ++times_;
  if (!first_)
    first_ = now;
}

} // namespace rubicon::report
