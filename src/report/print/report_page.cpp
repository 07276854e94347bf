#include "report/print/report_page.hpp"

#include <algorithm>
#include <limits>

#include "report/figures.hpp"

namespace rubicon::report {

namespace {

constexpr std::size_t width_min = 60;

} // namespace

report_page::report_page(const text_options& options)
    : width_(std::max(options.width, width_min)),
      room_(options.cuts ? width_ : std::numeric_limits<std::size_t>::max()),
      colour_(options.colour), full_(options.full), labels_(options.labels) {}

void report_page::heading(std::string_view title, std::string_view purpose) {
  constexpr std::size_t rule_min = 2;
  const auto used = display_width(title) + 4;
  const auto end = display_width(purpose) + 4;
  const bool fits = used + rule_min + end <= width_;
  text_ += '\n' + painted("──", look::faint, colour_) + ' ' +
           painted(title, look::strong, colour_) + ' ';
  std::string rule;
  for (auto i = used; i < width_ - (fits ? end : 0); ++i)
    rule += "─";
  if (fits)
    rule.append(" ").append(purpose).append(" ──");
  text_ += painted(rule, look::faint, colour_) + '\n';
  if (!fits)
    line("  " + std::string(purpose), look::faint);
}

std::string report_page::proxy(const proxy_report& x) const {
  using kind = config::label_table::kind;
  auto mote = x.name;
  std::ranges::replace(mote, '.', '/');
  auto label = labels_.of(kind::proxy, x.proxy_class);
  if (label.empty())
    label = labels_.of(kind::mote, mote);
  return label.empty() ? x.name : x.name + " (" + label + ')';
}

std::string report_page::anybody(const std::string& who) const {
  using kind = config::label_table::kind;
  return named(who.find('/') == std::string::npos ? kind::peer : kind::mote, who);
}

void report_page::line(std::string_view text, look how) {
  text_ += painted(cut(printable(text), room_), how, colour_) + '\n';
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
  text_ += x.render(room_, colour_);
}

std::size_t report_page::shown(std::size_t rows, std::size_t at_most) const {
  return full_ ? rows : std::min(rows, at_most);
}

void report_page::add_rest(table& rows, std::size_t all, std::size_t shown) {
  if (all > shown)
    rows.add_note("… and " + with_thousands(all - shown) + " more; --full shows all");
}

} // namespace rubicon::report
