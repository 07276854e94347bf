#include "page/swarm_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "page/axis.hpp"
#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/figures.hpp"

namespace rubicon::page {

namespace {

constexpr std::size_t bins = 30;
constexpr std::size_t violations_listed = 200;
constexpr double figure_width = 520;
constexpr double height = 190;
constexpr double left = 44;
constexpr double right = 16;
constexpr double bottom = 34;
constexpr double top = 12;

std::string value_text(double x, double wide) {
  return number(x, wide > 0 ? wide / 100 : std::fabs(x) < 100 ? 0.01 : 1);
}

/// How many seeds have a value near which.
std::string histogram(const std::string& title, const std::vector<seed_figures::entry>& sorted) {
  const auto low = sorted.front().value;
  const auto high = sorted.back().value;
  std::array<std::size_t, bins> counts{};
  for (const auto& x : sorted) {
    const auto share = high > low ? (x.value - low) / (high - low) : 0.5;
    ++counts[std::min(bins - 1, static_cast<std::size_t>(share * bins))];
  }
  const auto most = *std::ranges::max_element(counts);
  drawing out(figure_width, height,
              "role='img' aria-label='" + escaped("Distribution of " + title) + '\'');
  out.rect({left, top}, figure_width - left - right, height - top - bottom, "class='frame'");
  const axis across{low, high, left + 6, figure_width - right - 6};
  const axis up{0, static_cast<double>(most), height - bottom, top + 6};
  for (const auto& each : ticks(0, static_cast<double>(most), 3)) {
    if (each.value != std::floor(each.value))
      continue;
    out.line({left, up.at(each.value)}, {figure_width - right, up.at(each.value)}, "class='grid'");
    out.text({left - 6, up.at(each.value) + 4}, "class='soft' text-anchor='end'", each.label);
  }
  const auto bar = (across.end - across.begin) / bins;
  for (std::size_t i = 0; i < bins; ++i)
    if (counts[i] > 0) {
      const auto y = up.at(static_cast<double>(counts[i]));
      out.rect({across.begin + static_cast<double>(i) * bar + 1, y}, bar - 2, height - bottom - y,
               "fill='var(--c0)'", report::counted(counts[i], "seed"));
    }
  const auto& middle = sorted[sorted.size() / 2];
  out.line({across.at(middle.value), top}, {across.at(middle.value), height - bottom},
           "class='curve c1'", "median " + value_text(middle.value, high - low));
  const auto marks =
      high > low ? ticks(low, high, 4) : std::vector<tick>{{low, value_text(low, 0)}};
  for (const auto& each : marks)
    out.text({across.at(each.value), height - 12}, "class='soft' text-anchor='middle'", each.label);
  return out.finish();
}

struct distribution {
  std::string title;
  std::vector<seed_figures::entry> sorted; ///< ascending by value
};

/// Figures by which a network is judged come first, then those that differ most between seeds, in
/// relation to their size, then those of the computer; those that never differ are last.
std::vector<distribution> by_weight(const seed_figures& from) {
  static constexpr std::array<std::string_view, 5> judged{"arrived", "joined", "flat battery",
                                                          "charge", "transmissions"};
  const auto rank = [](const distribution& x) {
    const auto low = x.sorted.front().value;
    const auto high = x.sorted.back().value;
    if (high <= low)
      return std::pair(judged.size() + 2, 0.0);
    if (x.title.starts_with("real time") || x.title == "events")
      return std::pair(judged.size() + 1, 0.0);
    const auto found = std::ranges::find_if(
        judged, [&x](std::string_view word) { return x.title.find(word) != std::string::npos; });
    const auto size = std::max(std::fabs(low), std::fabs(high));
    return std::pair(static_cast<std::size_t>(found - judged.begin()), (low - high) / size);
  };
  std::vector<distribution> all;
  for (const auto& [title, entries] : from.all()) {
    all.push_back({title, entries});
    std::ranges::stable_sort(all.back().sorted, {}, &seed_figures::entry::value);
  }
  std::ranges::stable_sort(all, {}, rank);
  return all;
}

std::string distributions_of(const swarm_page& x) {
  std::string out;
  for (const auto& [title, sorted] : by_weight(x.figures)) {
    const auto wide_value = sorted.back().value - sorted.front().value;
    const auto entry_text = [&](const char* name, const seed_figures::entry& y) {
      return std::string(name) + ' ' + value_text(y.value, wide_value) + " (seed " +
             std::to_string(y.seed) + ')';
    };
    const auto text = wide_value > 0 ? entry_text("least", sorted.front()) + " · " +
                                           entry_text("median", sorted[sorted.size() / 2]) + " · " +
                                           entry_text("most", sorted.back())
                                     : "the same with every seed";
    out += "<figure>" + element("h3", title) + histogram(title, sorted) +
           element("figcaption", text) + "</figure>\n";
  }
  return section("distributions", "Distributions over seeds",
                 out.empty() ? out : "<div class='grid'>" + out + "</div>\n");
}

std::string violations_of(const swarm_page& x) {
  if (x.violations.empty())
    return {};
  auto rows = head_row({{"invariant"}, {"times", true}});
  for (const auto& [invariant, count] : x.violations)
    rows += row({{invariant, false, "long bad"}, {report::with_thousands(count), true}});
  auto out = wide("<table>" + rows + "</table>");
  rows = head_row({{"seed", true}, {"invariant"}, {"observed"}, {"command to replay it"}});
  std::size_t shown = 0;
  for (const auto& seed : x.failed) {
    const auto varied = seed.varied.empty() ? "" : " (" + seed.varied + ')';
    for (const auto& each : seed.violations) {
      if (++shown > violations_listed)
        continue;
      rows += row({{std::to_string(seed.seed) + varied, true},
                   {each.invariant, false, "long"},
                   {each.detail, false, "long"},
                   {seed.command, false, "long"}});
    }
  }
  out += "<h3>By seed</h3>" + wide("<table>" + rows + "</table>");
  if (shown > violations_listed || x.failed.size() < x.failures)
    out += element("p", "… and more: `--json` lists them", "class='soft'");
  return section("violations", "Violations", out);
}

/// What the runs have come into, and which kinds of faults they had.
std::string coverage_of(const swarm_page& x) {
  std::string out;
  if (!x.situations.empty()) {
    auto rows = head_row({{"situation"}, {"runs", true}, {"first seed", true}});
    for (const auto& each : x.situations)
      rows += row({{each.name, false, each.runs == 0 ? "long bad" : "long"},
                   {report::with_thousands(each.runs), true},
                   {each.first_seed ? std::to_string(*each.first_seed) : "never", true}});
    out += wide("<table>" + rows + "</table>");
  }
  if (!x.faults.empty()) {
    auto rows = head_row({{"kind of fault"}, {"runs with it", true}});
    for (const auto& [kind, runs] : x.faults)
      rows += row({{kind}, {report::with_thousands(runs), true}});
    out += wide("<table>" + rows + "</table>");
  }
  return section("coverage", "Situations and faults", out);
}

} // namespace

void seed_figures::add(std::uint64_t seed, const std::map<std::string, double>& figures) {
  for (const auto& [title, value] : figures)
    if (std::isfinite(value) && all_[title].size() < seeds_max)
      all_[title].push_back({value, seed});
}

std::string html_of(const swarm_page& x) {
  const auto missed = static_cast<std::uint64_t>(
      std::ranges::count(x.situations, std::uint64_t{0}, &wanted_situation::runs));
  const bool good = x.failures == 0 && !x.interrupted && missed == 0;
  auto verdict =
      x.failures == 0
          ? std::string(x.interrupted ? "no violations until it was interrupted" : "no violations")
          : report::with_thousands(x.failures) + " of " + report::counted(x.runs, "run") +
                " with violations";
  if (missed > 0)
    verdict += ", " + report::counted(missed, "situation") + " never reached";
  auto out = "<header>\n" + element("h1", x.file + ", seeds " + x.seeds) + '\n' +
             element("span", (good ? "✓ " : "✗ ") + verdict,
                     good ? "class='verdict'" : "class='verdict no'") +
             '\n' +
             element("p",
                     report::counted(x.runs, "run") + " in " + report::real_time(x.real_s) + " · " +
                         report::counted(x.events, "event"),
                     "class='soft'") +
             '\n' + element("pre", x.command) + "</header>\n";
  return document(x.file + ", seeds " + x.seeds,
                  out + violations_of(x) + coverage_of(x) + distributions_of(x));
}

} // namespace rubicon::page
