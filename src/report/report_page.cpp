#include "report/report_page.hpp"

#include <algorithm>

namespace rubicon::report {

namespace {

constexpr std::size_t width_min = 60;

} // namespace

report_page::report_page(std::size_t width, bool colour)
    : width_(std::max(width, width_min)), colour_(colour) {}

void report_page::heading(std::string_view title) {
  const auto used = display_width(title) + 4;
  text_ += '\n' + painted("──", look::faint, colour_) + ' ' +
           painted(title, look::strong, colour_) + ' ';
  std::string rule;
  for (auto i = used; i < width_; ++i)
    rule += "─";
  text_ += painted(rule, look::faint, colour_) + '\n';
}

void report_page::line(std::string_view text, look how) {
  text_ += painted(cut(printable(text), width_), how, colour_) + '\n';
}

void report_page::flow(const std::vector<std::string>& parts, look how) {
  constexpr std::string_view margin = "  ";
  constexpr std::string_view dot = "  ·  ";
  std::string current;
  for (const auto& x : parts) {
    if (x.empty())
      continue;
    const auto part = printable(x);
    const auto wider = display_width(current) + display_width(dot) + display_width(part);
    if (!current.empty() && wider > width_) {
      line(current, how);
      current.clear();
    }
    current.append(current.empty() ? margin : dot).append(part);
  }
  if (!current.empty())
    line(current, how);
}

void report_page::add(const table& x) {
  text_ += x.render(width_, colour_);
}

} // namespace rubicon::report
