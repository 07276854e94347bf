#include "report/print/metrics.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/describe/fields.hpp"
#include "report/print/exposition.hpp"

namespace rubicon::report {

namespace {

constexpr double coulombs_per_mah = 3.6;
constexpr double milliseconds_per_second = 1000;
constexpr double microseconds_per_second = 1e6;

template <class T>
inline constexpr bool is_largest = false;
template <class T>
inline constexpr bool is_largest<largest<T>> = true;

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

/// Fields that say how things are at that moment; all other numbers only grow while their source
/// lives. What is `largest` is among the former without a line here.
constexpr std::array levels{
    "in_transit",   "open",    "mac_open",    "reliable_open",   "inputs_open",  "events_open",
    "peers",        "tuples",  "links",       "hosts_known",     "programs",     "members",
    "synchronised", "aligned", "hops",        "outside_longest", "error_max",    "silence",
    "latency",      "pause",   "first_after", "missing",         "state_octets",
};

bool is_level(std::string_view field) {
  return std::ranges::find(levels, field) != levels.end();
}

/// The word for a unit that Prometheus takes for base, and how many of them one of ours is.
struct unit {
  std::string_view ours;
  std::string_view base;
  double factor;
};

constexpr std::array units{unit{"octets", "bytes", 1}, unit{"mah", "coulombs", coulombs_per_mah},
                           unit{"ms", "seconds", 1 / milliseconds_per_second}};

/// A field's name without its unit, which goes to the end of a metric's.
struct split_name {
  std::string name;
  std::string_view unit = {};
  double factor = 1;
};

split_name split(std::string_view field) {
  for (const auto& each : units) {
    const auto at = field.find(each.ours);
    const bool is_word =
        at != std::string_view::npos && (at == 0 || field[at - 1] == '_') &&
        (at + each.ours.size() == field.size() || field[at + each.ours.size()] == '_');
    if (!is_word)
      continue;
    std::string rest(field);
    rest.erase(at, each.ours.size());
    if (const auto twice = rest.find("__"); twice != std::string::npos)
      rest.erase(twice, 1);
    if (rest.starts_with('_'))
      rest.erase(0, 1);
    if (rest.ends_with('_'))
      rest.pop_back();
    return {std::move(rest), each.base, each.factor};
  }
  return {std::string(field)};
}

/// Writes the numbers of described structs.
class field_writer {
public:
  explicit field_writer(exposition& out) : out_(out) {}

  /// All numbers of it. @param path of the struct in the report: `islands[].radio`
  template <described T>
  void add(const std::string& section, const std::string& path, const metric_labels& labels,
           const T& x) {
    for_each_field(x, [&](std::string_view field, const auto& value) {
      if (field != section) // `stream.stream`, a number that is its name
        add_field({section, path, labels}, field, value);
    });
  }

  void add_number(const std::string& section, const std::string& path, const metric_labels& labels,
                  std::string_view field, double value, bool is_duration = false,
                  bool is_gauge = false) {
    auto parts = split(field);
    if (is_duration)
      parts.unit = "seconds";
    const auto kind = is_gauge || is_level(field) ? metric_kind::gauge : metric_kind::counter;
    std::string name = "rubicon_" + section;
    for (const auto part : {std::string_view(parts.name), parts.unit})
      if (!part.empty())
        (name += '_') += part;
    if (kind == metric_kind::counter)
      name += "_total";
    out_.add(name, kind, "`" + path + "." + std::string(field) + "` of the report", labels,
             value * parts.factor);
  }

private:
  struct place {
    const std::string& section;
    const std::string& path;
    const metric_labels& labels;
  };

  template <class T>
  void add_field(const place& at, std::string_view field, const T& x) {
    const auto number = [&](double value, bool is_duration, bool is_gauge) {
      add_number(at.section, at.path, at.labels, field, value, is_duration, is_gauge);
    };
    if constexpr (std::is_same_v<T, cause_counts>) {
      add_counts(at, field, x);
    } else if constexpr (std::is_same_v<T, bool>) {
      number(x ? 1 : 0, false, true);
    } else if constexpr (std::is_unsigned_v<T>) {
      number(static_cast<double>(x), false, false);
    } else if constexpr (std::is_same_v<T, double>) {
      number(x, false, field != "used_mah");
    } else if constexpr (std::is_same_v<T, duration>) {
      number(seconds(x), true, false);
    } else if constexpr (is_largest<T>) {
      if constexpr (std::is_same_v<T, largest<duration>>)
        number(seconds(x.value), true, true);
      else
        number(static_cast<double>(x.value), false, true);
    } else if constexpr (is_optional<T>) {
      if (x)
        number(static_cast<double>(*x), false, true);
    } else if constexpr (described<T>) {
      add(at.section + '_' + std::string(field), at.path + '.' + std::string(field), at.labels, x);
    } // all else is no number
  }

  /// `lost` by its causes, `counters` by their names.
  void add_counts(const place& at, std::string_view field, const cause_counts& x) {
    const bool has_causes = field != "counters" && field != "limits";
    for (const auto& [name, count] : x) {
      constexpr std::string_view octets = "_octets";
      const bool is_size = has_causes && name.ends_with(octets);
      auto labels = at.labels;
      labels.emplace_back(has_causes ? "cause" : "name",
                          is_size ? name.substr(0, name.size() - octets.size()) : name);
      add_number(at.section, at.path, labels, std::string(field) + (is_size ? "_octets" : ""),
                 static_cast<double>(count));
    }
  }

  exposition& out_;
};

/// How many motes of an island are what, and the least that is left in a battery.
void add_motes(exposition& out, const metric_labels& labels, const island_report& x) {
  const auto count = [&](std::string_view state, auto is_so) {
    auto with_state = labels;
    with_state.emplace_back("state", state);
    out.add("rubicon_motes", metric_kind::gauge, "Motes of the island that are so", with_state,
            static_cast<double>(std::ranges::count_if(x.motes, is_so)));
  };
  count("configured", [](const mote_report&) { return true; });
  count("alive", &mote_report::alive);
  count("listed", [](const mote_report& each) {
    return each.alive && each.joined && each.left_cause.empty();
  });
  std::optional<double> least;
  for (const auto& each : x.motes)
    if (each.energy.battery_mah > 0) {
      const auto left = 1 - each.energy.used_mah / each.energy.battery_mah;
      least = std::max(0.0, std::min(least.value_or(1), left));
    }
  if (least)
    out.add("rubicon_battery_left_min_ratio", metric_kind::gauge,
            "What is left of the emptiest battery of the island's motes, of its full charge",
            labels, *least);
}

void add_island(exposition& out, field_writer& fields, const island_report& x,
                const metrics_options& options) {
  const metric_labels labels{{"island", x.name}};
  add_motes(out, labels, x);
  fields.add("radio", "islands[].radio", labels, x.radio);
  fields.add("serial", "islands[].serial", labels, x.serial);
  fields.add("real", "islands[].real", labels, x.real);
  fields.add("messages", "islands[].messages", labels, x.messages);
  fields.add("network", "islands[].network", labels, x.network);
  fields.add("clock", "islands[].clock", labels, x.clock);
  fields.add("smepp", "islands[].smepp", labels, x.smepp);
  energy_report energy;
  for (const auto& each : x.motes)
    energy += each.energy;
  fields.add("energy", "islands[].motes[].energy", labels, energy);
  for (const auto& each : x.gateways)
    fields.add("gateway_lead", "islands[].gateways[].lead",
               {{"island", x.name}, {"gateway", each.name}}, each.lead);
  if (options.motes)
    for (const auto& each : x.motes)
      fields.add("mote", "islands[].motes[]", {{"island", x.name}, {"mote", each.name}}, each);
}

} // namespace

std::string to_metrics(const collection& x) {
  exposition out;
  out.add("rubicon_report_timestamp_seconds", metric_kind::gauge,
          "When the report was collected that these figures are from, in Unix time", {},
          static_cast<double>(x.at_us) / microseconds_per_second);
  if (x.took)
    out.add("rubicon_report_duration_seconds", metric_kind::gauge,
            "How long the run was busy with that report", {}, seconds(*x.took));
  return out.finish();
}

std::string to_metrics(const run_report& x, const metrics_options& options) {
  exposition out;
  field_writer fields(out);
  out.add("rubicon_run_info", metric_kind::gauge, "What runs; always 1",
          {{"ecology", x.ecology}, {"mode", x.mode}, {"seed", std::to_string(x.seed)}}, 1);
  out.add("rubicon_run_simulated_seconds_total", metric_kind::counter,
          "Ecology time that has passed", {}, seconds(x.simulated));
  out.add("rubicon_run_events_total", metric_kind::counter, "Messages delivered to actors", {},
          static_cast<double>(x.events));
  fields.add("actors", "actors", {}, x.actors);
  for (const auto& each : x.islands)
    add_island(out, fields, each, options);
  fields.add("pc_messages", "pc_messages", {}, x.pc_messages);
  fields.add("tunnels", "tunnels", {}, x.tunnels);
  for (const auto& each : x.peers)
    fields.add("peer", "peers[]", {{"peer", each.name}}, each);
  for (const auto& each : x.modules)
    fields.add("module", "modules[]", {{"module", each.who}}, each);
  for (const auto& each : x.proxies)
    fields.add("proxy", "proxies[]", {{"proxy", each.name}, {"class", each.proxy_class}}, each);
  for (const auto& each : x.streams)
    fields.add("stream", "streams[]",
               {{"number", std::to_string(each.stream)}, {"from", each.from}, {"to", each.to}},
               each);
  for (const auto& each : x.programs)
    for (const auto& [name, value] : each.figures)
      out.add("rubicon_program_figure", metric_kind::gauge, "`programs[].figures` of the report",
              {{"node", each.who}, {"program", each.kind}, {"figure", name}}, value);
  std::map<std::string_view, std::size_t> violations;
  for (const auto& each : x.violations)
    ++violations[each.invariant];
  for (const auto& [name, count] : violations)
    out.add("rubicon_violations", metric_kind::gauge, "Violations noted so far, by invariant",
            {{"invariant", std::string(name)}}, static_cast<double>(count));
  return out.finish();
}

} // namespace rubicon::report
