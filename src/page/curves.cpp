// What changed in the course of a run: energy, and tuples.
#include <algorithm>
#include <functional>
#include <utility>

#include "page/axis.hpp"
#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/figures.hpp"
#include "report/report_parts.hpp"

namespace rubicon::page {

namespace {

constexpr std::size_t curves_max = 8; ///< of single motes
constexpr std::size_t tuples_shown = 24;

std::string name_of(const run_page& x, const mote_address& mote) {
  for (const auto& island : x.report.islands) {
    const auto found = std::ranges::find(island.motes, mote, &report::mote_report::address);
    if (island.id == mote.island && found != island.motes.end())
      return labelled(x, island.name + '/' + found->name);
  }
  return to_string(mote);
}

/// A frame with both axes.
class chart {
public:
  chart(double width, double height, double left, double right, std::string_view label)
      : out_(width, height, "role='img' aria-label='" + escaped(label) + '\''), width_(width),
        height_(height), left_(left), right_(right) {}

  void scale(duration length, double low, double high, int time_ticks_max, int value_ticks_max) {
    if (!(high > low)) {
      low -= 0.5;
      high += 0.5;
    }
    time_ = {0, std::max(seconds(length), 1e-9), left_, width_ - right_};
    value_ = {low, high, height_ - 26, 10};
    out_.rect({left_, 10}, width_ - left_ - right_, height_ - 36, "class='frame'");
    for (const auto& each : ticks(low, high, value_ticks_max)) {
      out_.line({left_, value_.at(each.value)}, {width_ - right_, value_.at(each.value)},
                "class='grid'");
      out_.text({left_ - 6, value_.at(each.value) + 4}, "class='soft' text-anchor='end'",
                each.label);
    }
    for (const auto& each : time_ticks(length, time_ticks_max)) {
      out_.line({time_.at(each.value), height_ - 26}, {time_.at(each.value), height_ - 21},
                "class='grid'");
      out_.text({time_.at(each.value), height_ - 8}, "class='soft' text-anchor='middle'",
                each.label);
    }
  }

  [[nodiscard]] point at(double time_s, double value) const {
    return {time_.at(time_s), value_.at(value)};
  }
  [[nodiscard]] drawing& out() { return out_; }

private:
  drawing out_;
  double width_;
  double height_;
  double left_;
  double right_;
  axis time_;
  axis value_;
};

struct mote_curve {
  mote_address mote;
  const std::vector<float>* used;
};

/// The one with the most first.
std::vector<mote_curve> curves_of(const report::history& x) {
  std::vector<mote_curve> all;
  for (const auto& [mote, used] : x.used_mah())
    if (!used.empty())
      all.push_back({mote, &used});
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.used->back() > b.used->back(); });
  return all;
}

/// @param values at the times of samples
template <class T>
std::vector<point> points_of(const chart& on, const run_page& x, const std::vector<T>& values) {
  std::vector<point> all{on.at(0, 0)};
  const auto& times = x.seen.times();
  for (std::size_t i = 0; i < std::min(times.size(), values.size()); ++i)
    all.push_back(on.at(seconds(times[i].time_since_epoch()), values[i]));
  return all;
}

/// From the least to the most of all motes, and their median.
void draw_band(chart& on, const run_page& x, const std::vector<mote_curve>& all) {
  std::vector<point> most{on.at(0, 0)};
  std::vector<point> median{on.at(0, 0)};
  std::vector<point> least{on.at(0, 0)};
  const auto& times = x.seen.times();
  for (std::size_t i = 0; i < times.size(); ++i) {
    std::vector<float> values;
    for (const auto& each : all)
      if (i < each.used->size())
        values.push_back((*each.used)[i]);
    if (values.empty())
      continue;
    std::ranges::sort(values);
    const auto time_s = seconds(times[i].time_since_epoch());
    most.push_back(on.at(time_s, values.back()));
    median.push_back(on.at(time_s, values[values.size() / 2]));
    least.push_back(on.at(time_s, values.front()));
  }
  auto around = most;
  around.insert(around.end(), least.rbegin(), least.rend());
  on.out().polygon(around, "class='band'", "from the least to the most of all motes");
  on.out().polyline(median, "class='curve c7'");
}

std::string curve_class(std::size_t i) {
  return "class='curve c" + std::to_string(i % 8) + '\'';
}

std::string energy_legend(const run_page& x, const std::vector<mote_curve>& all,
                          std::size_t shown) {
  std::string out = "<div class='legend'>";
  const auto entry = [&out](const std::string& classes, const std::string& text) {
    drawing sample(34, 14, "aria-hidden='true'");
    sample.line({1, 7}, {33, 7}, classes);
    out += "<span>" + sample.finish() + escaped(text) + "</span>\n";
  };
  for (std::size_t i = 0; i < shown; ++i)
    entry(curve_class(i),
          name_of(x, all[i].mote) + ", " + report::fixed(all[i].used->back(), 3) + " mAh");
  if (shown < all.size())
    entry(curve_class(7), "median of all " + report::counted(all.size(), "mote") +
                              "; the band contains all of them");
  return out + "</div>\n";
}

struct tuple_curve {
  const report::history::tuple_key* key;
  const report::thinned_series* values;
};

/// What gateways, kernels and proxies keep about themselves.
bool is_bookkeeping(std::string_view key) {
  return key.starts_with("devices.") || key.starts_with("kernel.") || key.ends_with(".since") ||
         key.ends_with(".latency");
}

/// Those that change, the busiest first.
std::vector<tuple_curve> changing(const report::history& x) {
  std::vector<tuple_curve> all;
  for (const auto& [key, values] : x.tuples())
    if (values.count() > 2 && values.least() < values.most() && !is_bookkeeping(key.second))
      all.push_back({&key, &values});
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.values->count() > b.values->count();
  });
  return all;
}

std::string tuple_chart(const run_page& x, const tuple_curve& curve) {
  const auto& [owner, plain_key] = *curve.key;
  const auto key = labelled(x, plain_key);
  chart on(360, 130, 52, 28, key + " of " + owner);
  on.scale(x.report.simulated, curve.values->least(), curve.values->most(), 4, 3);
  std::vector<point> points;
  const auto all = curve.values->points();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto time_s = seconds(all[i].at.time_since_epoch());
    if (i > 0) // a tuple has a value until the next
      points.push_back(on.at(time_s, all[i - 1].value));
    points.push_back(on.at(time_s, all[i].value));
  }
  points.push_back(on.at(seconds(x.report.simulated), all.back().value));
  on.out().polyline(points, "class='curve'");
  const auto wide_value = curve.values->most() - curve.values->least();
  return "<figure>" +
         element("figcaption", key + "  (" + owner + ", " +
                                   report::counted(curve.values->count(), "value") + ", the last " +
                                   number(all.back().value, wide_value / 100) + ')') +
         on.out().finish() + "</figure>\n";
}

} // namespace

std::string energy_of(const run_page& x) {
  const auto all = curves_of(x.seen);
  if (all.empty() || x.report.simulated <= 0s)
    return {};
  chart on(1100, 300, 64, 24, "Charge used by motes over time");
  on.scale(x.report.simulated, 0, std::max(static_cast<double>(all.front().used->back()), 1e-6), 10,
           5);
  const bool few = all.size() <= curves_max;
  if (!few)
    draw_band(on, x, all);
  const auto shown = few ? all.size() : std::size_t{5};
  for (auto i = shown; i-- > 0;) // the first is the uppermost
    on.out().polyline(points_of(on, x, *all[i].used), curve_class(i));
  return section("energy", "Energy",
                 element("p",
                         few ? "Charge used, in mAh."
                             : "Charge used, in mAh; motes with the highest consumption are named.",
                         "class='soft'") +
                     wide(on.out().finish()) + energy_legend(x, all, shown));
}

std::string losses_over_time(const run_page& x, std::string_view layer) {
  constexpr std::size_t causes_shown = 6;
  struct cause_curve {
    std::string_view cause;
    const std::vector<double>* lost;
  };
  std::vector<cause_curve> all;
  for (const auto& [what, lost] : x.seen.lost()) {
    if (what.first == layer && report::is_missed(what.second) && !lost.empty() && lost.back() > 0)
      all.push_back({what.second, &lost});
  }
  if (all.empty() || x.report.simulated <= 0s)
    return {};
  std::ranges::stable_sort(all, std::greater(), [](const auto& y) { return y.lost->back(); });
  all.resize(std::min(all.size(), causes_shown));
  chart on(360, 140, 62, 28, "Losses over time");
  on.scale(x.report.simulated, 0, all.front().lost->back(), 4, 3);
  std::string legend = "<div class='legend'>";
  for (std::size_t i = 0; i < all.size(); ++i) {
    on.out().polyline(points_of(on, x, *all[i].lost), curve_class(i));
    drawing sample(34, 14, "aria-hidden='true'");
    sample.line({1, 7}, {33, 7}, curve_class(i));
    legend += "<span>" + sample.finish() + escaped(all[i].cause) + "</span>\n";
  }
  return on.out().finish() + legend + "</div>\n";
}

std::string tuples_of(const run_page& x) {
  const auto all = changing(x.seen);
  if (all.empty())
    return {};
  std::string out = "<div class='grid'>";
  const auto shown = std::min(all.size(), tuples_shown);
  for (std::size_t i = 0; i < shown; ++i)
    out += tuple_chart(x, all[i]);
  out += "</div>\n";
  if (shown < all.size())
    out +=
        element("p", "… and " + report::counted(all.size() - shown, "more tuple") + " that changed",
                "class='soft'");
  return section("tuples", "Tuples", out);
}

} // namespace rubicon::page
