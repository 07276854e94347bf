#include "report/print/text_layout.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace rubicon::report {

namespace {

constexpr std::size_t indent = 2;
constexpr std::size_t gap = 2;
constexpr std::size_t text_width_min = 8;

bool is_continuation(char x) {
  return (static_cast<unsigned char>(x) & 0xC0U) == 0x80U;
}

bool is_number(std::string_view x) {
  return !x.empty() && x.find_first_not_of("+-.,0123456789") == std::string_view::npos;
}

/// Blanks that follow `x` so that its point stands above those of a column with `tail_max`
/// characters from the point on.
std::string to_point(const std::string& x, std::size_t tail_max) {
  const auto point = std::min(x.find('.'), x.size());
  return x + std::string(tail_max - (x.size() - point), ' ');
}

void trim_end(std::string& x) {
  x.erase(x.find_last_not_of(' ') + 1);
}

} // namespace

std::size_t display_width(std::string_view x) {
  return x.size() - static_cast<std::size_t>(std::count_if(x.begin(), x.end(), is_continuation));
}

std::string blanks(std::string_view x, std::size_t width) {
  return std::string(width - std::min(width, display_width(x)), ' ');
}

std::string cut(std::string_view x, std::size_t width) {
  if (display_width(x) <= width)
    return std::string(x);
  if (width == 0)
    return {};
  std::size_t end = 0;
  for (std::size_t count = 0; count + 1 < width; ++count) {
    ++end;
    while (end < x.size() && is_continuation(x[end]))
      ++end;
  }
  return std::string(x.substr(0, end)) + "…";
}

std::string painted(std::string_view x, look how, bool colour) {
  if (!colour || x.empty())
    return std::string(x);
  const auto escape = [how]() -> std::string_view {
    switch (how) {
    case look::plain:
      return {};
    case look::strong:
      return "\033[1m";
    case look::faint:
      return "\033[2m";
    case look::good:
      return "\033[32m";
    case look::bad:
      return "\033[1;31m";
    }
    return {};
  }();
  if (escape.empty())
    return std::string(x);
  return std::string(escape).append(x).append("\033[0m");
}

void table::add(std::vector<cell> row) {
  assert(row.size() <= columns_.size());
  row.resize(columns_.size());
  for (auto& x : row)
    x.text = printable(x.text);
  rows_.push_back({std::move(row), false});
}

void table::add_note(std::string_view text, look how) {
  rows_.push_back({{cell(printable(text), how)}, true});
}

std::vector<table::line> table::aligned() const {
  line heading;
  for (const auto& x : columns_)
    heading.cells.emplace_back(x.heading, look::faint);
  std::vector<line> lines{std::move(heading)};
  lines.insert(lines.end(), rows_.begin(), rows_.end());
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].where != align::point)
      continue;
    std::size_t head_max = 0;
    std::size_t tail_max = 0;
    const auto each_number = [&](auto visit) {
      for (auto& x : lines)
        if (!x.is_note && is_number(x.cells[i].text))
          visit(x.cells[i].text);
    };
    each_number([&](const std::string& text) {
      const auto point = std::min(text.find('.'), text.size());
      head_max = std::max(head_max, point);
      tail_max = std::max(tail_max, text.size() - point);
    });
    each_number([&](std::string& text) {
      text = to_point(text, tail_max);
      text.insert(0, blanks(text, head_max + tail_max));
    });
  }
  return lines;
}

std::vector<std::size_t> table::natural_widths(const std::vector<line>& lines) const {
  std::vector<std::size_t> wide(columns_.size(), 0);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    for (std::size_t row = 1; row < lines.size(); ++row)
      if (!lines[row].is_note)
        wide[i] = std::max(wide[i], display_width(lines[row].cells[i].text));
    if (wide[i] > 0) // a column that says nothing is left out with its heading
      wide[i] = std::max(wide[i], display_width(columns_[i].heading));
  }
  return wide;
}

bool table::narrow(std::vector<std::size_t>& wide, std::size_t width) const {
  const auto needed = [&] {
    const auto shown =
        wide.size() - static_cast<std::size_t>(std::count(wide.begin(), wide.end(), 0));
    return std::accumulate(wide.begin(), wide.end(),
                           indent + gap * (std::max<std::size_t>(shown, 1) - 1));
  };
  while (needed() > width) {
    std::size_t widest = 0;
    std::size_t at = 0;
    for (std::size_t i = 0; i < wide.size(); ++i)
      if (columns_[i].where == align::left && wide[i] > widest) {
        widest = wide[i];
        at = i;
      }
    if (widest <= text_width_min)
      return false;
    --wide[at];
  }
  return true;
}

std::vector<std::size_t> table::widths(const std::vector<line>& lines, std::size_t width) const {
  const auto natural = natural_widths(lines);
  for (auto shown = columns_.size();; --shown) {
    auto wide = natural;
    std::fill(wide.begin() + static_cast<std::ptrdiff_t>(shown), wide.end(), 0);
    if (narrow(wide, width) || shown <= 1)
      return wide;
  }
}

std::string table::render(std::size_t width, bool colour) const {
  const auto lines = aligned();
  const auto wide = widths(lines, width);
  std::string text;
  for (const auto& x : lines) {
    if (x.is_note) {
      text += "  " + painted(cut(x.cells[0].text, width - indent), x.cells[0].how, colour) + '\n';
      continue;
    }
    std::string row;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (wide[i] == 0)
        continue;
      const auto shown = cut(x.cells[i].text, wide[i]);
      const auto coloured = painted(shown, x.cells[i].how, colour);
      const auto fill = blanks(shown, wide[i]);
      row += std::string(row.empty() ? indent : gap, ' ');
      row += columns_[i].where == align::right ? fill + coloured : coloured + fill;
    }
    trim_end(row);
    if (!row.empty())
      text += row + '\n';
  }
  const auto natural = natural_widths(lines);
  std::string missing;
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (wide[i] == 0 && natural[i] > 0)
      missing += (missing.empty() ? "" : ", ") + columns_[i].heading;
  if (!missing.empty())
    text += "  " +
            painted(cut("… too narrow for " + missing, width - indent), look::faint, colour) + '\n';
  return text;
}

} // namespace rubicon::report
