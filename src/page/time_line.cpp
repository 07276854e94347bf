// What happened when: the event log, faults of the plan, and what was violated.
#include <algorithm>
#include <map>
#include <set>

#include "config/summary_parts.hpp"
#include "page/axis.hpp"
#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/fault_plan.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::page {

namespace {

constexpr double lanes_width = 1100;
constexpr double names_width = 150;
constexpr double lane_height = 24;
constexpr double axis_height = 30;
constexpr std::size_t lanes_max = 14;
constexpr std::size_t faults_max = 400;
constexpr std::size_t lines_open_max = 30;

struct mark {
  double at_s = 0;
  std::string look; ///< class
  std::string title;
};

struct lane {
  std::string name;
  std::vector<mark> marks;
};

/// Whether something got better or worse, judged by its words.
std::string look_of(const std::string& what) {
  constexpr std::string_view bad[] = {"left",  "flat", "crashed", "killed",    "failed", "gone",
                                      "ended", "lost", "unplug",  "power off", "noise",  "loses"};
  constexpr std::string_view good[] = {"joined", "started again", "back", "listed"};
  const auto says = [&what](std::string_view word) { return what.find(word) != std::string::npos; };
  return std::ranges::any_of(bad, says)    ? "event bad"
         : std::ranges::any_of(good, says) ? "event good"
                                           : "event";
}

lane violations(const run_page& x) {
  lane out{"violated", {}};
  for (const auto& each : x.report.violations)
    out.marks.push_back({seconds(each.at.time_since_epoch()), "violated",
                         report::run_time(each.at) + "  " + each.invariant + ": " + each.detail});
  return out;
}

lane faults(const run_page& x) {
  lane out{"faults", {}};
  if (x.ecology.faults.empty())
    return out;
  const auto rows = config::fault_rows(x.ecology);
  const auto plan = report::plan_faults(x.ecology);
  for (std::size_t i = 0; i < std::min(plan.size(), faults_max); ++i) {
    if (plan[i].at > x.report.simulated)
      break;
    const auto text = config::fault_text(rows.at(plan[i].index));
    out.marks.push_back(
        {seconds(plan[i].at), "fault", report::run_time(instant{} + plan[i].at) + "  " + text});
  }
  return out;
}

/// By island or peer; those with the fewest events share the last one.
std::vector<lane> events(const run_page& x) {
  std::map<std::string, lane> all;
  std::vector<std::string> order;
  for (const auto& island : x.report.islands) {
    order.push_back(island.name);
    all[island.name].name = named(x, config::label_table::kind::island, island.name);
  }
  for (const auto& each : x.report.event_log) {
    auto name = each.who.substr(0, each.who.find('/'));
    const auto point = name.find('.');
    if (point != std::string::npos) // a tuple's key
      name.erase(point);
    if (!all.contains(name))
      order.push_back(name);
    auto& lane = all[name];
    lane.name = labelled(x, name);
    lane.marks.push_back(
        {seconds(each.at.time_since_epoch()), look_of(each.what),
         report::run_time(each.at) + "  " + labelled(x, each.who) + "  " + each.what});
  }
  std::vector<lane> lanes;
  for (const auto& name : order)
    if (!all[name].marks.empty())
      lanes.push_back(std::move(all[name]));
  if (lanes.size() <= lanes_max)
    return lanes;
  std::stable_sort(lanes.begin(), lanes.end(),
                   [](const auto& a, const auto& b) { return a.marks.size() > b.marks.size(); });
  lane others{report::counted(lanes.size() - lanes_max + 1, "other"), {}};
  for (std::size_t i = lanes_max - 1; i < lanes.size(); ++i)
    others.marks.insert(others.marks.end(), lanes[i].marks.begin(), lanes[i].marks.end());
  lanes.resize(lanes_max - 1);
  lanes.push_back(std::move(others));
  return lanes;
}

void draw_mark(drawing& out, const mark& x, double at, double middle) {
  const auto classes = "class='" + x.look + '\'';
  if (x.look == "violated")
    out.polygon({{at, middle - 8}, {at + 7, middle}, {at, middle + 8}, {at - 7, middle}}, classes,
                x.title);
  else if (x.look == "fault")
    out.polygon({{at, middle - 7}, {at + 7, middle + 6}, {at - 7, middle + 6}}, classes, x.title);
  else
    out.line({at, middle - 8}, {at, middle + 8}, classes, x.title);
}

std::string draw(const run_page& x, const std::vector<lane>& lanes) {
  const auto bottom = 8 + lane_height * static_cast<double>(lanes.size());
  drawing out(lanes_width, bottom + axis_height, "role='img' aria-label='Time line of the run'");
  const axis time{0, std::max(seconds(x.report.simulated), 1e-9), names_width, lanes_width - 24};
  out.rect({names_width - 10, 4}, lanes_width - names_width - 4, bottom, "class='frame' rx='4'");
  for (const auto& each : time_ticks(x.report.simulated, 10)) {
    out.line({time.at(each.value), 4}, {time.at(each.value), bottom + 4}, "class='grid'");
    out.text({time.at(each.value), bottom + 20}, "class='soft' text-anchor='middle'", each.label);
  }
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    const auto middle = 8 + lane_height * (static_cast<double>(i) + 0.5);
    const auto name = printable(lanes[i].name);
    const auto shown = report::cut(name, 20);
    out.text({names_width - 18, middle + 4}, "text-anchor='end'", shown, shown == name ? "" : name);
    for (const auto& each : lanes[i].marks)
      draw_mark(out, each, time.at(each.at_s), middle);
  }
  return wide(out.finish());
}

std::string marks_legend() {
  std::string out = "<div class='legend'>";
  const auto entry = [&out](const char* look, std::string_view text) {
    drawing sample(34, 14, "aria-hidden='true'");
    draw_mark(sample, {0, look, {}}, 17, 7);
    out += "<span>" + sample.finish() + escaped(text) + "</span>\n";
  };
  entry("event good", "joined, came back");
  entry("event bad", "left, failed, went off");
  entry("event", "other events");
  entry("fault", "planned fault");
  entry("violated", "violation");
  return out + "</div>\n";
}

std::string log_of(const run_page& x) {
  const auto& log = x.report.event_log;
  if (log.empty())
    return {};
  std::string out = log.size() <= lines_open_max ? "<details open>" : "<details>";
  out += element("summary", "Event log, " + report::counted(log.size(), "line") +
                                (x.report.event_log_left_out > 0
                                     ? "; " + report::with_thousands(x.report.event_log_left_out) +
                                           " between them are omitted"
                                     : ""));
  std::string rows = head_row({{"time", true}, {"who"}, {"what"}});
  for (const auto& each : log)
    rows += row({{report::run_time(each.at), true},
                 {labelled(x, each.who), false, "name"},
                 {each.what, false, "long"}});
  return out + wide("<table>" + rows + "</table>") + "</details>\n";
}

} // namespace

std::string time_line_of(const run_page& x) {
  std::vector<lane> lanes;
  for (auto each : {violations(x), faults(x)})
    if (!each.marks.empty())
      lanes.push_back(std::move(each));
  for (auto& each : events(x))
    lanes.push_back(std::move(each));
  if (lanes.empty() || x.report.simulated <= 0s)
    return {};
  return section("time", "Time line", draw(x, lanes) + marks_legend() + log_of(x));
}

} // namespace rubicon::page
