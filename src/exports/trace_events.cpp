#include "exports/trace_events.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "explain/outcome.hpp"
#include "explain/print/words.hpp"
#include "exports/stations.hpp"
#include "view/sample_json.hpp"

namespace rubicon::exports {

namespace {

using nlohmann::ordered_json;

constexpr std::int64_t shortest_ns = 1; ///< flows bind to no slice without length
constexpr std::int64_t latest_ns = std::int64_t{1} << 61U;

std::int64_t in_ns(instant x) {
  return std::clamp<std::int64_t>(x.time_since_epoch().count(), 0, latest_ns);
}

double in_us(std::int64_t ns) {
  return static_cast<double>(ns) / 1000;
}

/// From begin to end.
struct period {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
};

/// The list of events, one a line.
class event_list {
public:
  explicit event_list(const octets_out& out) : out_(out) {}

  void add(const ordered_json& x) {
    out_((is_empty_ ? "\n" : ",\n") + json_line(x));
    is_empty_ = false;
  }

private:
  const octets_out& out_;
  bool is_empty_ = true;
};

/// A thread of a process in the trace.
struct track {
  std::uint64_t process = 0;
  std::uint64_t thread = 0;
};

/// Processes and threads; each is named when it is first used.
class track_list {
public:
  explicit track_list(event_list& out) : out_(out) {}

  std::uint64_t process_of(const std::string& station) { return known(station).process; }

  /// A thread on which nothing else is at that time. @pre called in order of beginnings
  track free_one(const std::string& station, const char* group, period x) {
    auto& at = known(station);
    auto& threads = at.groups[group];
    auto found = std::ranges::find_if(
        threads, [&x](const thread& each) { return each.busy_until_ns <= x.begin_ns; });
    if (found == threads.end()) {
      threads.push_back({++ids_});
      found = std::prev(threads.end());
      const auto number = threads.size() > 1 ? ' ' + std::to_string(threads.size()) : std::string();
      name("thread_name", {at.process, found->id}, group + number);
    }
    found->busy_until_ns = x.end_ns;
    return {at.process, found->id};
  }

private:
  struct thread {
    std::uint64_t id = 0;
    std::int64_t busy_until_ns = 0;
  };
  struct station_tracks {
    std::uint64_t process = 0;
    std::map<std::string_view, std::vector<thread>> groups;
  };

  station_tracks& known(const std::string& station) {
    auto& at = all_[station];
    if (at.process == 0) {
      at.process = ++ids_;
      name("process_name", {at.process, at.process}, station);
    }
    return at;
  }

  void name(const char* what, track x, const std::string& text) {
    out_.add({{"ph", "M"},
              {"name", what},
              {"pid", x.process},
              {"tid", x.thread},
              {"args", {{"name", text}}}});
  }

  event_list& out_;
  std::map<std::string, station_tracks> all_;
  std::uint64_t ids_ = 0; ///< no process has the id of a thread
};

const char* group_of(const explain::node& x) {
  switch (x.over) {
  case explain::medium::air:
    return "radio";
  case explain::medium::serial:
    return "serial line";
  case explain::medium::backbone:
    return "backbone";
  case explain::medium::peis:
    return "PEIS";
  case explain::medium::none:
    break;
  }
  return "programs";
}

/// When each attempt of a hop was, one after the other: until the next begins, or the hop ends.
std::vector<period> attempts_of(const explain::node& x) {
  std::vector<period> all;
  const auto end_ns = in_ns(x.time());
  auto before_ns = in_ns(x.begin);
  for (std::size_t i = 0; i < x.attempts.size(); ++i) {
    const auto begin_ns = std::max(in_ns(x.attempts[i].begin), before_ns);
    const auto next_ns =
        i + 1 < x.attempts.size() ? in_ns(x.attempts[i + 1].begin) : std::max(end_ns, begin_ns);
    before_ns = std::max(next_ns, begin_ns + shortest_ns);
    all.push_back({begin_ns, before_ns});
  }
  return all;
}

class trace_writer {
public:
  trace_writer(const explain::traces& all, const octets_out& out)
      : all_(all), out_(out), events_(out), tracks_(events_),
        written_(all.messages.size() + all.tuples.size()) {}

  void write() {
    const ordered_json about = {{"ecology", all_.about.ecology}, {"seed", all_.about.seed}};
    out_("{\"displayTimeUnit\":\"ms\",\"otherData\":" + json_line(about) + ",\"traceEvents\":[");
    add_steps();
    add_events();
    add_samples();
    out_("\n]}\n");
  }

private:
  void add_steps() {
    std::vector<explain::node_index> order(all_.nodes.size());
    std::iota(order.begin(), order.end(), explain::node_index{});
    std::ranges::stable_sort(order, {},
                             [this](explain::node_index n) { return in_ns(all_.nodes[n].begin); });
    for (const auto n : order)
      add_step(all_.nodes[n]);
  }

  void add_step(const explain::node& x) {
    const auto attempts = attempts_of(x);
    period whole{in_ns(x.begin), std::max(in_ns(x.time()), in_ns(x.begin) + shortest_ns)};
    if (!attempts.empty())
      whole.end_ns = std::max(whole.end_ns, attempts.back().end_ns);
    const auto* const group = group_of(x);
    const auto at = tracks_.free_one(station_of(all_, x), group, whole);
    add_slice(subject_of(x), group, at, whole, arguments_of(x));
    add_flow(x, at, whole.begin_ns); // before the attempts: it binds to the innermost slice
    if (x.attempts.size() == 1 && x.over != explain::medium::air)
      return;
    for (std::size_t i = 0; i < attempts.size(); ++i)
      add_slice("attempt " + std::to_string(i + 1), "attempt", at, attempts[i],
                {{"outcome", x.attempts[i].outcome}, {"arrived", x.attempts[i].arrived}});
  }

  [[nodiscard]] const std::string& subject_of(const explain::node& x) const {
    return x.about.is_tuple ? all_.tuples[x.about.index].key : all_.messages[x.about.index].name;
  }

  [[nodiscard]] ordered_json arguments_of(const explain::node& x) const {
    ordered_json y = {{"at", explain::where(all_, x)}, {"what", explain::what(all_, x)}};
    if (x.what == explain::step::hop)
      y["arrived"] = x.arrived.has_value();
    if (x.what != explain::step::sends || x.about.is_tuple)
      return y;
    const auto outcome = explain::outcome_of(all_, all_.messages[x.about.index]);
    y["outcome"] = explain::to_string(outcome.status);
    if (!outcome.why.empty())
      y["why"] = outcome.why;
    return y;
  }

  void add_slice(const std::string& name, const char* category, track at, period x,
                 ordered_json arguments) {
    events_.add({{"ph", "X"},
                 {"name", name},
                 {"cat", category},
                 {"pid", at.process},
                 {"tid", at.thread},
                 {"ts", in_us(x.begin_ns)},
                 {"dur", in_us(x.end_ns - x.begin_ns)},
                 {"args", std::move(arguments)}});
  }

  void add_flow(const explain::node& x, track at, std::int64_t begin_ns) {
    const auto& steps =
        x.about.is_tuple ? all_.tuples[x.about.index].nodes : all_.messages[x.about.index].nodes;
    const auto subject = x.about.index + (x.about.is_tuple ? all_.messages.size() : 0);
    const auto count = ++written_[subject];
    if (steps.size() < 2)
      return;
    const auto* const kind = x.about.is_tuple ? "value" : "message";
    ordered_json y = {{"ph", count == 1              ? "s"
                             : count == steps.size() ? "f"
                                                     : "t"},
                      {"name", kind},
                      {"cat", kind},
                      {"id", subject + 1},
                      {"pid", at.process},
                      {"tid", at.thread},
                      {"ts", in_us(begin_ns)}};
    if (count == steps.size())
      y["bp"] = "e"; // to the slice around it, not to the next
    events_.add(y);
  }

  /// Faults, and what else a person should know.
  void add_events() {
    for (const auto& each : all_.events) {
      const auto process = tracks_.process_of(station_of(all_.known, each.from));
      events_.add({{"ph", "i"},
                   {"name", each.text},
                   {"cat", "event"},
                   {"s", "p"},
                   {"pid", process},
                   {"tid", process},
                   {"ts", in_us(in_ns(each.time))}});
    }
  }

  void add_samples() {
    for (const auto& text : all_.samples) {
      const auto x = view::decode_sample(text);
      if (!x)
        continue;
      for (const auto& mote : x->motes) {
        const auto process = tracks_.process_of(all_.known.of(mote.address));
        add_counter("used charge", process, x->at, {{"mAh", mote.used_mah}});
        add_counter("queue", process, x->at, {{"packets", mote.queued}});
        if (mote.etx)
          add_counter("ETX to the parent", process, x->at, {{"transmissions", *mote.etx}});
      }
    }
  }

  void add_counter(const char* name, std::uint64_t process, instant at, ordered_json values) {
    events_.add({{"ph", "C"},
                 {"name", name},
                 {"pid", process},
                 {"tid", process},
                 {"ts", in_us(in_ns(at))},
                 {"args", std::move(values)}});
  }

  const explain::traces& all_;
  const octets_out& out_;
  event_list events_;
  track_list tracks_;
  std::vector<std::uint32_t> written_; ///< steps of each message, then of each value
};

} // namespace

void write_trace_events(const explain::traces& all, const octets_out& out) {
  trace_writer(all, out).write();
}

} // namespace rubicon::exports
