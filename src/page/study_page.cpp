#include "page/study_page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "page/axis.hpp"
#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/figures.hpp"

namespace rubicon::page {

namespace {

constexpr std::size_t lines_max = 8; ///< of a chart
constexpr std::size_t rows_max = 60; ///< of variants in a drawing
constexpr std::size_t dots_max = 500;
constexpr std::size_t extremes = 3;
constexpr double chart_width = 520;
constexpr double chart_height = 220;
constexpr double chart_margin = 60;

/// The least and the greatest of what is drawn.
struct extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void take(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  [[nodiscard]] bool empty() const { return low > high; }
  [[nodiscard]] double step() const { return std::max((high - low) / 100, std::abs(high) * 1e-5); }
};

std::vector<std::string> values_of(const study_page& x, std::size_t parameter) {
  std::vector<std::string> out;
  for (const auto& each : x.variants)
    if (std::ranges::find(out, each[parameter]) == out.end())
      out.push_back(each[parameter]);
  return out;
}

std::size_t place_in(const std::vector<std::string>& all, const std::string& x) {
  return static_cast<std::size_t>(std::ranges::find(all, x) - all.begin());
}

/// What a variant has beside one parameter: `loss=0.1 range=15m`
std::string label_of(const study_page& x, const std::vector<std::string>& variant,
                     std::size_t without) {
  std::string out;
  for (std::size_t i = 0; i < variant.size(); ++i)
    if (i != without)
      out += (out.empty() ? "" : " ") + x.parameters[i] + '=' + variant[i];
  return out;
}

std::string class_of_line(std::size_t i) {
  return "class='curve c" + std::to_string(i % lines_max) + '\'';
}

extent extent_of(const study_scalar& x) {
  extent out;
  for (const auto& each : x.figures) {
    if (each.runs == 0)
      continue;
    out.take(each.value);
    if (each.interval) {
      out.take(each.interval->first);
      out.take(each.interval->second);
    }
  }
  return out;
}

void draw_scale(drawing& out, const extent& range, const axis& up) {
  out.rect({chart_margin, 10}, chart_width - chart_margin - 16, chart_height - 44, "class='frame'");
  for (const auto& each : ticks(range.low, range.high, 4)) {
    out.line({chart_margin, up.at(each.value)}, {chart_width - 16, up.at(each.value)},
             "class='grid'");
    out.text({chart_margin - 6, up.at(each.value) + 4}, "class='soft' text-anchor='end'",
             each.label);
  }
}

struct line_point {
  std::size_t place = 0;
  const study_figure* figure = nullptr;
};

void draw_line(drawing& out, const std::vector<line_point>& line, const axis& across,
               const axis& up, std::size_t number, const std::string& label) {
  std::vector<point> points;
  for (const auto& each : line) {
    const auto& figure = *each.figure;
    const auto at = across.at(static_cast<double>(each.place));
    points.push_back({at, up.at(figure.value)});
    if (figure.interval)
      out.line({at, up.at(figure.interval->first)}, {at, up.at(figure.interval->second)},
               class_of_line(number), label);
  }
  out.polyline(points, class_of_line(number));
}

/// A line for each combination of the other parameters.
std::string curves_over(const study_page& x, const study_scalar& scalar, std::size_t parameter) {
  const auto range = extent_of(scalar);
  const auto values = values_of(x, parameter);
  if (values.size() < 2 || range.empty())
    return {};
  std::map<std::string, std::vector<line_point>> lines;
  for (std::size_t i = 0; i < x.variants.size(); ++i)
    if (scalar.figures[i].runs > 0)
      lines[label_of(x, x.variants[i], parameter)].push_back(
          {place_in(values, x.variants[i][parameter]), &scalar.figures[i]});
  drawing out(chart_width, chart_height,
              "role='img' aria-label='" +
                  escaped(scalar.name + " over " + x.parameters[parameter]) + '\'');
  const axis across{0, static_cast<double>(values.size() - 1), chart_margin + 16, chart_width - 32};
  const axis up{range.low, range.high, chart_height - 40, 16};
  draw_scale(out, range, up);
  const auto every = std::max<std::size_t>(1, values.size() / 8);
  for (std::size_t i = 0; i < values.size(); i += every)
    out.text({across.at(static_cast<double>(i)), chart_height - 16},
             "class='soft' text-anchor='middle'", values[i]);
  std::string legend;
  std::size_t number = 0;
  for (const auto& [label, line] : lines) {
    if (number == lines_max)
      break;
    draw_line(out, line, across, up, number, label);
    drawing sample(34, 14, "aria-hidden='true'");
    sample.line({1, 7}, {33, 7}, class_of_line(number++));
    if (!label.empty())
      legend += "<span>" + sample.finish() + escaped(label) + "</span>\n";
  }
  auto caption = "over " + x.parameters[parameter];
  if (lines.size() > lines_max)
    caption += "; " + report::counted(lines.size() - lines_max, "more line") + " left out";
  return "<figure>" + element("figcaption", caption) + out.finish() +
         (legend.empty() ? "" : "<div class='legend'>" + legend + "</div>\n") + "</figure>\n";
}

/// The mean over all other parameters for each pair of values of the first two.
std::string map_over_two(const study_page& x, const study_scalar& scalar) {
  if (x.parameters.size() < 2)
    return {};
  const auto columns = values_of(x, 0);
  const auto rows = values_of(x, 1);
  std::map<std::pair<std::size_t, std::size_t>, std::pair<double, double>> cells; // sum, count
  for (std::size_t i = 0; i < x.variants.size(); ++i)
    if (scalar.figures[i].runs > 0) {
      auto& cell = cells[{place_in(columns, x.variants[i][0]), place_in(rows, x.variants[i][1])}];
      cell.first += scalar.figures[i].value;
      ++cell.second;
    }
  extent range;
  for (const auto& [where, cell] : cells)
    range.take(cell.first / cell.second);
  if (columns.size() < 2 || rows.size() < 2 || rows.size() > rows_max ||
      columns.size() > rows_max || range.empty())
    return {};
  const double wide_cell = (chart_width - chart_margin - 16) / static_cast<double>(columns.size());
  constexpr double high_cell = 24;
  drawing out(chart_width, 34 + high_cell * static_cast<double>(rows.size()),
              "role='img' aria-label='" + escaped("Map of " + scalar.name) + '\'');
  const axis opacity{range.low, range.high, 0.1, 1};
  for (const auto& [where, cell] : cells) {
    const auto value = cell.first / cell.second;
    out.rect({chart_margin + wide_cell * static_cast<double>(where.first),
              high_cell * static_cast<double>(where.second)},
             wide_cell - 1, high_cell - 1,
             "fill='var(--c0)' fill-opacity='" + report::fixed(opacity.at(value), 3) + '\'',
             x.parameters[0] + '=' + columns[where.first] + ' ' + x.parameters[1] + '=' +
                 rows[where.second] + ": " + number(value, range.step()));
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    out.text({chart_margin - 6, high_cell * (static_cast<double>(i) + 0.65)},
             "class='soft' text-anchor='end'", rows[i]);
  const auto every = std::max<std::size_t>(1, columns.size() / 8);
  for (std::size_t i = 0; i < columns.size(); i += every)
    out.text({chart_margin + wide_cell * (static_cast<double>(i) + 0.5),
              high_cell * static_cast<double>(rows.size()) + 18},
             "class='soft' text-anchor='middle'", columns[i]);
  return "<figure>" +
         element("figcaption", x.parameters[1] + " over " + x.parameters[0] + ": " +
                                   number(range.low, range.step()) + " (pale) to " +
                                   number(range.high, range.step())) +
         out.finish() + "</figure>\n";
}

/// A dot for each run, a row for each variant.
std::string distributions(const study_page& x, const study_scalar& scalar) {
  extent range;
  for (const auto& runs : scalar.runs)
    for (const auto& each : runs)
      range.take(each.value);
  if (range.empty())
    return {};
  const auto shown = std::min(rows_max, scalar.runs.size());
  constexpr double row_height = 18;
  constexpr double names = 180;
  const auto below = row_height * static_cast<double>(shown);
  drawing out(chart_width, below + 26,
              "role='img' aria-label='" + escaped("Runs of " + scalar.name) + '\'');
  const axis across{range.low, range.high, names + 10, chart_width - 24};
  for (std::size_t i = 0; i < shown; ++i) {
    const auto y = row_height * (static_cast<double>(i) + 0.5);
    out.line({names, y}, {chart_width - 16, y}, "class='grid'");
    out.text({names - 6, y + 4}, "class='soft' text-anchor='end'",
             label_of(x, x.variants[i], x.parameters.size()));
    const auto& runs = scalar.runs[i];
    for (std::size_t j = 0; j < std::min(dots_max, runs.size()); ++j)
      out.circle({across.at(runs[j].value), y}, 3, "fill='var(--c0)' fill-opacity='0.5'",
                 "seed " + std::to_string(runs[j].seed) + ": " +
                     number(runs[j].value, range.step()));
  }
  for (const auto& each : ticks(range.low, range.high, 4))
    out.text({across.at(each.value), below + 18}, "class='soft' text-anchor='middle'", each.label);
  return "<figure>" +
         element("figcaption", shown < scalar.runs.size()
                                   ? "all runs of the first " + std::to_string(shown) + " variants"
                                   : "all runs") +
         out.finish() + "</figure>\n";
}

/// The runs with the least and the greatest values.
std::string extremes_of(const study_page& x, const study_scalar& scalar) {
  std::vector<std::tuple<double, std::size_t, std::uint64_t>> all; // value, variant, seed
  for (std::size_t i = 0; i < scalar.runs.size(); ++i)
    for (const auto& each : scalar.runs[i])
      all.emplace_back(each.value, i, each.seed);
  std::ranges::sort(all);
  if (all.empty() || std::get<0>(all.front()) == std::get<0>(all.back()))
    return {};
  auto rows = head_row({{""}, {"value", true}, {"seed", true}, {"command to replay it"}});
  const auto add = [&](const char* what, const auto& run) {
    const auto& [value, variant, seed] = run;
    rows += row({{what},
                 {number(value, std::max(std::abs(value) * 1e-5, 1e-9)), true},
                 {std::to_string(seed), true},
                 {x.replay(variant, seed), false, "long"}});
  };
  for (std::size_t i = 0; i < std::min(extremes, all.size()); ++i)
    add("least", all[i]);
  for (std::size_t i = 0; i < std::min(extremes, all.size()); ++i)
    add("greatest", all[all.size() - 1 - i]);
  return wide("<table>" + rows + "</table>");
}

std::string section_of(const study_page& x, std::size_t index) {
  const auto& scalar = x.scalars[index];
  std::string drawings;
  for (std::size_t i = 0; i < x.parameters.size(); ++i)
    drawings += curves_over(x, scalar, i);
  drawings += map_over_two(x, scalar) + distributions(x, scalar);
  if (drawings.empty())
    return {};
  return section("scalar-" + std::to_string(index), scalar.name,
                 "<div class='grid'>" + drawings + "</div>\n" + extremes_of(x, scalar));
}

} // namespace

std::string html_of(const study_page& x) {
  std::size_t runs = 0;
  if (!x.scalars.empty())
    for (const auto& each : x.scalars.front().runs)
      runs += each.size();
  auto out =
      "<header>\n" + element("h1", x.file) + '\n' +
      element("p",
              report::counted(x.variants.size(), "variant") + " · " + report::counted(runs, "run") +
                  " · lines are the " + x.figure + ", with " + x.confidence + " intervals",
              "class='soft'") +
      '\n' + element("pre", x.command) + "</header>\n";
  for (std::size_t i = 0; i < x.scalars.size(); ++i)
    out += section_of(x, i);
  return document(x.file, out);
}

} // namespace rubicon::page
