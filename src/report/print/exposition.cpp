#include "report/print/exposition.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "core/text/printable.hpp"

namespace rubicon::report {

namespace {

/// As the format wants a value between quotes.
std::string quoted(std::string_view x) {
  std::string text = "\"";
  for (const char each : printable(x)) {
    if (each == '\\' || each == '"')
      text += '\\';
    text += each;
  }
  return text += '"';
}

void append_number(std::string& out, double x) {
  if (std::isnan(x)) {
    out += "NaN";
    return;
  }
  if (std::isinf(x)) {
    out += x > 0 ? "+Inf" : "-Inf";
    return;
  }
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), x);
  out.append(digits.data(), end.ptr);
}

} // namespace

void exposition::add(const std::string& name, metric_kind kind, std::string_view help,
                     const metric_labels& labels, double value) {
  const auto [place, is_new] = places_.try_emplace(name, families_.size());
  if (is_new)
    families_.push_back("# HELP " + name + ' ' + printable(help) + "\n# TYPE " + name +
                        (kind == metric_kind::counter ? " counter\n" : " gauge\n"));
  auto& lines = families_[place->second];
  lines += name;
  char before = '{';
  for (const auto& [label, text] : labels) {
    lines += before;
    lines += label;
    lines += '=';
    lines += quoted(text);
    before = ',';
  }
  lines += labels.empty() ? " " : "} ";
  append_number(lines, value);
  lines += '\n';
}

std::string exposition::finish() {
  std::string text;
  for (const auto& each : families_)
    text += each;
  return text;
}

} // namespace rubicon::report
