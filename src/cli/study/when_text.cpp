#include "cli/study/when_text.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

using nlohmann::ordered_json;

std::string moment_text(duration x) {
  return report::run_time(instant(x));
}

std::string share_text(const study::future_count& x) {
  return std::to_string(x.with) + " of " + std::to_string(x.of);
}

/// The command of a future without the violation; empty: none is known.
std::string other_future(const when_answer& x) {
  const auto& before = x.found.before();
  if (!before || !before->without)
    return {};
  return "rubicon run" + shell_words(x.words) + " --reseed " +
         reseed_text(before->at, *before->without);
}

/// Events from shortly before the violation was certain until then, with the one before and the
/// one after.
std::vector<const explain::record*> events_of(const when_answer& x, const explain::traces& all) {
  if (!x.found.before())
    return {};
  std::vector<const explain::record*> by_time;
  for (const auto& each : all.events)
    by_time.push_back(&each);
  const auto time_of = [](const explain::record* each) { return each->time; };
  std::ranges::stable_sort(by_time, {}, time_of);
  auto begin = std::ranges::upper_bound(by_time, instant(x.found.before()->at), {}, time_of);
  auto end = std::ranges::upper_bound(by_time, instant(x.found.certain_from()), {}, time_of);
  if (begin != by_time.begin())
    --begin;
  if (end != by_time.end())
    ++end;
  return {begin, end};
}

std::string events_text(const std::vector<const explain::record*>& all,
                        const explain::text_style& style) {
  constexpr std::size_t rows_max = 20;
  report::table rows({{"around then", report::align::right}, {"who"}, {"what"}});
  for (std::size_t i = 0; i < std::min(rows_max, all.size()); ++i)
    rows.add({report::run_time(all[i]->time), explain::names::of(all[i]->from),
              printable(all[i]->text)});
  if (all.size() > rows_max)
    rows.add_note("and " + report::counted(all.size() - rows_max, "event") + " more");
  return rows.empty() ? "" : '\n' + rows.render(style.room, style.colour);
}

std::string verdict_text(const when_answer& x) {
  const auto all = std::to_string(x.futures) + " of " + std::to_string(x.futures);
  const auto& before = x.found.before();
  if (!before)
    return "from the start " + all + " futures have it\n";
  auto text = x.found.only_at_end() ? "it depends on chance until the run ends\n"
                                    : "from " + moment_text(x.found.certain_from()) + " on " + all +
                                          " futures have it\n";
  if (before->at > 0s)
    text += "from " + moment_text(before->at) + " on " + share_text(*before) + '\n';
  return text + "from the start " + share_text(x.found.at_start()) + '\n';
}

} // namespace

std::string reseed_text(duration at, std::uint64_t key) {
  return std::to_string(at / 1ms) + "ms:" + std::to_string(key);
}

std::string when_text(const when_answer& x, const explain::traces& all,
                      const explain::text_style& style) {
  auto text = "violation at " + report::run_time(x.what.at) + ": " + printable(x.what.invariant) +
              ": " + printable(x.what.detail) + "\n\n" + verdict_text(x) +
              events_text(events_of(x, all), style);
  if (const auto other = other_future(x); !other.empty())
    text += "\na future without it: " + printable(other) + '\n';
  return text;
}

std::string when_json(const when_answer& x, const explain::traces& all) {
  const auto share = [](const study::future_count& count) {
    return ordered_json{{"at_s", seconds(count.at)}, {"with", count.with}, {"of", count.of}};
  };
  const auto& before = x.found.before();
  ordered_json object{{"violation",
                       {{"at_s", seconds(x.what.at.time_since_epoch())},
                        {"invariant", x.what.invariant},
                        {"detail", x.what.detail}}},
                      {"futures", x.futures},
                      {"certain_from_s", x.found.only_at_end()
                                             ? ordered_json()
                                             : ordered_json(seconds(x.found.certain_from()))},
                      {"before", before ? share(*before) : ordered_json()},
                      {"start", share(x.found.at_start())},
                      {"events", ordered_json::array()}};
  for (const auto* each : events_of(x, all))
    object["events"].push_back({{"at_s", seconds(each->time.time_since_epoch())},
                                {"who", explain::names::of(each->from)},
                                {"what", each->text}});
  const auto other = other_future(x);
  object["other_future"] = other.empty() ? ordered_json() : ordered_json(other);
  return json_lines(object) + '\n';
}

} // namespace rubicon::cli
