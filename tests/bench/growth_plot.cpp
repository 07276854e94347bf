#include "growth_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>
#include <string_view>
#include <utility>

#include "page/axis.hpp"
#include "page/markup.hpp"

namespace bench {

using rubicon::page::axis;
using rubicon::page::drawing;
using rubicon::page::point;
using rubicon::page::px;

namespace {

constexpr double cell_width = 420;
constexpr double cell_height = 365;
constexpr double head_height = 92;
constexpr std::size_t columns_max = 3;
constexpr const char* style =
    "text{font:12px sans-serif;fill:#222}.head{font:bold 20px sans-serif}"
    ".title{font:bold 14px sans-serif}.frame{fill:none;stroke:#666}.grid{stroke:#e4e4e4}"
    ".tick{stroke:#666}.guide{stroke:#777;stroke-width:1.3;stroke-dasharray:5 4}"
    ".cost{fill:#0072B2}.memory{fill:#D55E00}.curve{stroke-width:2}"
    ".cost.curve{fill:none;stroke:#0072B2}.memory.curve{fill:none;stroke:#D55E00}";

/// A power of ten with a prefix, for example `100 k`.
std::string decade(int exponent, std::string_view unit) {
  constexpr std::array<std::string_view, 5> prefixes{"", "k", "M", "G", "T"};
  if (exponent < 0 || exponent >= 15)
    return "1e" + std::to_string(exponent) + std::string(unit);
  const auto prefix = std::string(prefixes[static_cast<std::size_t>(exponent / 3)]);
  const auto after = prefix + std::string(unit);
  return '1' + std::string(static_cast<std::size_t>(exponent % 3), '0') +
         (after.empty() ? "" : " " + after);
}

std::string fixed(double x, int digits) {
  if (!std::isfinite(x))
    return "-";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, x);
  return text.data();
}

struct curve {
  double growth_point::*what;
  std::string kind; ///< `cost` or `memory`
  axis y;
};

/// Another shape for each kind, beside its colour.
void draw_mark(drawing& out, double x, double y, const std::string& kind) {
  if (kind == "cost")
    out.circle({x, y}, 4.5, "class='cost'");
  else
    out.rect({x - 4, y - 4}, 8, 8, "class='memory'");
}

std::pair<double, double> logarithms(const std::vector<growth_point>& points,
                                     double growth_point::*what) {
  const auto [least, most] =
      std::minmax_element(points.begin(), points.end(),
                          [&](const auto& a, const auto& b) { return a.*what < b.*what; });
  return {std::log10((*least).*what), std::log10((*most).*what)};
}

class panel_drawing {
public:
  panel_drawing(drawing& out, const growth_panel& panel, double left, double top)
      : out_(out), panel_(panel), left_(left + 66), right_(left + cell_width - 80), top_(top + 66),
        bottom_(top + cell_height - 56) {
    if (panel.points.empty())
      return;
    const auto [x_low, x_high] = logarithms(panel.points, &growth_point::size);
    x_ = {x_low - 0.2, x_high + 0.2, left_ + 1, right_ - 1};
    // As many decades on either side, so that equal slopes look equal. The cost hangs at the top
    // and memory stands at the bottom, with one more decade between them if they would meet.
    const auto [cost_low, cost_high] = logarithms(panel.points, &growth_point::steps);
    const auto [memory_low, memory_high] = logarithms(panel.points, &growth_point::octets);
    const auto top_decade = std::ceil(cost_high + 0.1);
    const auto bottom_decade = std::floor(memory_low - 0.1);
    auto decades = std::max(top_decade - std::floor(cost_low - 0.1),
                            std::ceil(memory_high + 0.1) - bottom_decade);
    for (int more = 0; more < 2; ++more, ++decades) {
      cost_.y = {top_decade - decades, top_decade, bottom_, top_};
      memory_.y = {bottom_decade, bottom_decade + decades, bottom_, top_};
      if (!meet())
        break;
    }
  }

  void draw() {
    text((left_ + right_) / 2, top_ - 30, "text-anchor='middle'", panel_.work);
    text((left_ + right_) / 2, top_ - 47, "class='title' text-anchor='middle'", panel_.title);
    if (panel_.points.empty())
      return;
    slopes();
    ticks();
    out_.rect({left_, top_}, right_ - left_, bottom_ - top_, "class='frame'");
    for (const auto* each : {&memory_, &cost_})
      guide(*each);
    for (const auto* each : {&memory_, &cost_})
      draw_curve(*each);
  }

private:
  void text(double x, double y, const std::string& attributes, const std::string& what) {
    out_.text({x, y}, attributes, what);
  }

  void line(double x1, double y1, double x2, double y2, const std::string& attributes) {
    out_.line({x1, y1}, {x2, y2}, attributes);
  }

  /// Whether a mark of one curve is close to that of the other.
  [[nodiscard]] bool meet() const {
    return std::any_of(panel_.points.begin(), panel_.points.end(), [&](const growth_point& x) {
      return std::abs(cost_.y.at(std::log10(x.steps)) - memory_.y.at(std::log10(x.octets))) < 16;
    });
  }

  void slopes() {
    const auto told = [&](const curve& x) {
      return fixed(slope(panel_.points, x.what, panel_.points.size()), 2) + " (last two " +
             fixed(slope(panel_.points, x.what, 2), 2) + ')';
    };
    const auto middle = (left_ + right_) / 2;
    text(middle - 8, top_ - 10, "class='cost' text-anchor='end'", "slope " + told(cost_));
    text(middle + 8, top_ - 10, "class='memory'", "slope " + told(memory_));
  }

  void ticks() {
    const auto middle = (top_ + bottom_) / 2;
    for (auto i = std::ceil(x_.low); i <= x_.high; ++i) {
      line(x_.at(i), top_, x_.at(i), bottom_, "class='grid'");
      line(x_.at(i), bottom_, x_.at(i), bottom_ + 5, "class='tick'");
      text(x_.at(i), bottom_ + 19, "text-anchor='middle'", decade(static_cast<int>(i), ""));
    }
    for (const auto& x : panel_.points)
      line(x_.at(std::log10(x.size)), bottom_, x_.at(std::log10(x.size)), bottom_ - 5,
           "class='tick'");
    text((left_ + right_) / 2, bottom_ + 38, "text-anchor='middle'", "number");
    const auto side = [&](const curve& x, bool at_left, std::string_view unit,
                          const std::string& label) {
      const auto edge = at_left ? left_ : right_;
      const auto out = at_left ? -1 : 1;
      const auto kind = "class='" + x.kind + "' ";
      for (auto i = x.y.low; i <= x.y.high; ++i) {
        if (at_left) // the other side has its decades at the same heights
          line(left_, x.y.at(i), right_, x.y.at(i), "class='grid'");
        line(edge, x.y.at(i), edge + 5 * out, x.y.at(i), "class='tick'");
        text(edge + 8 * out, x.y.at(i) + 4, kind + (at_left ? "text-anchor='end'" : ""),
             decade(static_cast<int>(i), unit));
      }
      const auto label_x = edge + (at_left ? -50 : 67);
      text(label_x, middle,
           kind + "text-anchor='middle' transform='rotate(-90 " + px(label_x) + ' ' + px(middle) +
               ")'",
           label);
    };
    side(cost_, true, "", "calibration steps");
    side(memory_, false, "B", "memory, octets");
  }

  /// From the first point, as if each had the same share.
  void guide(const curve& x) {
    const auto& first = panel_.points.front();
    const auto size = std::log10(first.size);
    const auto value = std::log10(first.*x.what);
    const auto length = std::min(x_.high - size, x.y.high - value);
    line(x_.at(size), x.y.at(value), x_.at(size + length), x.y.at(value + length), "class='guide'");
  }

  void draw_curve(const curve& x) {
    const auto at = [&](const growth_point& each) {
      return point{x_.at(std::log10(each.size)), x.y.at(std::log10(each.*x.what))};
    };
    std::vector<point> points;
    for (const auto& each : panel_.points)
      points.push_back(at(each));
    out_.polyline(points, "class='" + x.kind + " curve'");
    for (const auto& each : points)
      draw_mark(out_, each.x, each.y, x.kind);
  }

  drawing& out_;
  const growth_panel& panel_;
  double left_;
  double right_;
  double top_;
  double bottom_;
  axis x_;
  curve cost_{&growth_point::steps, "cost", {}};
  curve memory_{&growth_point::octets, "memory", {}};
};

void draw_head(drawing& out, const std::string& note) {
  out.text({20, 32}, "class='head'", "How cost and memory grow");
  out.text({20, 54}, "", note);
  draw_mark(out, 27, 73, "cost");
  out.text({38, 77}, "class='cost'", "cost: processor time in calibration steps, left scale");
  draw_mark(out, 385, 73, "memory");
  out.text({396, 77}, "class='memory'", "memory, right scale");
  out.line({540, 73}, {574, 73}, "class='guide'");
  out.text({582, 77}, "", "slope 1 from the first size on: each takes the same");
}

} // namespace

double slope(const std::vector<growth_point>& points, double growth_point::*what,
             std::size_t count) {
  count = std::min(count, points.size());
  double x_sum = 0;
  double y_sum = 0;
  double xx_sum = 0;
  double xy_sum = 0;
  for (auto i = points.size() - count; i < points.size(); ++i) {
    const auto x = std::log(points[i].size);
    const auto y = std::log(points[i].*what);
    x_sum += x;
    y_sum += y;
    xx_sum += x * x;
    xy_sum += x * y;
  }
  const auto n = static_cast<double>(count);
  const auto spread = n * xx_sum - x_sum * x_sum;
  return count < 2 || spread <= 0 ? std::numeric_limits<double>::quiet_NaN()
                                  : (n * xy_sum - x_sum * y_sum) / spread;
}

void draw_growth(std::ostream& out, const std::string& note,
                 const std::vector<growth_panel>& panels) {
  const auto columns = std::clamp(panels.size(), std::size_t{2}, columns_max);
  const auto rows = (panels.size() + columns - 1) / columns;
  const auto width = cell_width * static_cast<double>(columns);
  const auto height = head_height + cell_height * static_cast<double>(rows);
  drawing svg(width, height,
              "xmlns='http://www.w3.org/2000/svg' width='" + px(width) + "' height='" + px(height) +
                  '\'');
  svg.element("title", "How cost and memory grow");
  svg.element("style", style);
  svg.rect({0, 0}, width, height, "fill='#ffffff'");
  draw_head(svg, note);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    panel_drawing(svg, panels[i], cell_width * static_cast<double>(i % columns),
                  head_height + cell_height * static_cast<double>(i / columns))
        .draw();
  }
  out << svg.finish();
}

} // namespace bench
