// What holds of every list of trace events, whatever was traced.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace rubicon::test {

class trace_event_file {
public:
  std::map<std::uint64_t, std::string> processes;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> threads; ///< of which process
  std::map<std::string, std::size_t> slices;                              ///< how many of a name
  std::size_t flows = 0;
  std::vector<std::string> problems;

  explicit trace_event_file(const std::string& text) {
    const auto x = nlohmann::json::parse(text, nullptr, false);
    if (!x.is_object() || !x.contains("traceEvents") || !x["traceEvents"].is_array()) {
      problems.emplace_back("no list of events");
      return;
    }
    for (const auto& each : x["traceEvents"])
      take(each);
    check_slices();
    check_flows();
  }

private:
  using thread_key = std::pair<std::uint64_t, std::uint64_t>;

  struct slice {
    std::int64_t begin = 0; ///< ns
    std::int64_t end = 0;
  };
  struct flow_step {
    std::string phase;
    thread_key at;
    std::int64_t time = 0;
  };

  void demand(bool holds, const std::string& what) {
    if (!holds)
      problems.push_back(what);
  }

  static std::int64_t in_ns(const nlohmann::json& us) {
    return std::llround(us.get<double>() * 1000);
  }

  void take(const nlohmann::json& x) {
    const auto phase = x.at("ph").get<std::string>();
    const auto pid = x.at("pid").get<std::uint64_t>();
    const thread_key at{pid, x.at("tid").get<std::uint64_t>()};
    const auto name = x.at("name").get<std::string>();
    if (phase == "M") {
      const auto text = x.at("args").at("name").get<std::string>();
      demand(!text.empty(), "an empty name");
      demand(name == "process_name" ? processes.try_emplace(pid, text).second
                                    : threads.try_emplace(at, text).second,
             "a track is named twice: " + text);
      return;
    }
    demand(processes.contains(pid), "an event of a process without name");
    const auto time = in_ns(x.at("ts"));
    demand(time >= 0, "a time before the run");
    if (phase == "X") {
      demand(threads.contains(at), "a slice of a thread without name");
      const auto length = in_ns(x.at("dur"));
      demand(length > 0, "a slice without length");
      by_thread_[at].push_back({time, time + length});
      ++slices[name];
    } else if (phase == "s" || phase == "t" || phase == "f")
      by_flow_[{x.at("cat").get<std::string>(), x.at("id").get<std::uint64_t>()}].push_back(
          {phase, at, time});
    else
      demand(phase == "i" || phase == "C", "an event of kind " + phase);
  }

  /// On a thread one slice is inside another or outside it.
  void check_slices() {
    for (auto& [at, all] : by_thread_) {
      std::ranges::sort(all, [](const slice& a, const slice& b) {
        return a.begin != b.begin ? a.begin < b.begin : a.end > b.end;
      });
      std::vector<std::int64_t> open;
      for (const auto& each : all) {
        while (!open.empty() && open.back() <= each.begin)
          open.pop_back();
        demand(open.empty() || each.end <= open.back(), "slices that overlap");
        open.push_back(each.end);
      }
    }
  }

  void check_flows() {
    std::set<std::uint64_t> ids;
    for (const auto& [key, steps] : by_flow_) {
      demand(ids.insert(key.second).second, "flows of one id");
      demand(steps.size() >= 2 && steps.front().phase == "s" && steps.back().phase == "f",
             "a flow without begin or end");
      for (std::size_t i = 0; i < steps.size(); ++i) {
        const auto& x = steps[i];
        demand(i == 0 || i + 1 == steps.size() || x.phase == "t", "a flow that begins twice");
        demand(i == 0 || steps[i - 1].time <= x.time, "a flow back in time");
        demand(binds(x), "a flow that no slice has");
      }
      ++flows;
    }
  }

  /// A slice begins there: it is the innermost, or holds only those that begin then too.
  [[nodiscard]] bool binds(const flow_step& x) const {
    const auto found = by_thread_.find(x.at);
    if (found == by_thread_.end())
      return false;
    const auto& all = found->second; // ascending
    const auto first = std::ranges::lower_bound(all, x.time, {}, &slice::begin);
    return first != all.end() && first->begin == x.time;
  }

  std::map<thread_key, std::vector<slice>> by_thread_;
  std::map<std::pair<std::string, std::uint64_t>, std::vector<flow_step>> by_flow_;
};

} // namespace rubicon::test
