#include "cli/swarm.hpp"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "report/expect/situation.hpp"
#include "report/invariants.hpp"

namespace rubicon::cli {

namespace {

using nlohmann::json;

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of("\r\n");
  if (end == std::string::npos)
    return {};
  const auto before = text.find_last_of('\n', end);
  const auto from = before == std::string::npos ? 0 : before + 1;
  return text.substr(from, end + 1 - from);
}

/// `what`, with the last thing the run said.
std::string with_reason(std::string what, const child_end& how) {
  const auto line = last_line(how.err);
  return line.empty() ? what : what + ": " + line;
}

std::map<std::string, double> figures_of(const json& report, double real_s) {
  std::map<std::string, double> all{{"real time, s", real_s}};
  const auto take = [&](const char* title, const char* where, double scale = 1) {
    const json::json_pointer place(where);
    if (report.contains(place) && report.at(place).is_number())
      all[title] = scale * report.at(place).get<double>();
  };
  take("messages arrived, %", "/messages/delivery", 100);
  take("radio transmissions", "/radio/transmissions");
  take("charge used by all motes, mAh", "/energy/used_mah");
  take("motes joined", "/motes/joined");
  take("PEIS packages", "/peis/packages");
  take("events", "/events");
  if (!report.value("ended_by", "").empty())
    take("time to the first flat battery, h", "/simulated_s", 1.0 / 3600);
  std::erase_if(all, [](const auto& x) { return x.second == 0; }); // there is no such thing
  return all;
}

std::vector<situation_outcome> situations_of(const json& report) {
  std::vector<situation_outcome> all;
  for (const auto& each : report.value("expectations", json::array())) {
    const auto text = each.at("expect").get<std::string>();
    if (text.starts_with(report::sometimes))
      all.push_back({text.substr(report::sometimes.size()), each.at("met") == true});
  }
  return all;
}

/// @throws json::exception if the report is not as docs/report.md says
void take_report(seed_outcome& x, const json& report) {
  const auto complete = report.at("complete").get<bool>();
  x.events = report.at("events").get<std::uint64_t>();
  x.simulated_s = report.at("simulated_s").get<double>();
  x.figures = figures_of(report, seconds(x.real));
  x.situations = situations_of(report);
  for (const auto& found : report.at("violations")) {
    const auto at = duration(static_cast<std::int64_t>(found.at("at_s").get<double>() * 1e9));
    x.violations.push_back({instant(at), found.at("invariant").get<std::string>(),
                            found.at("detail").get<std::string>()});
  }
  if (!complete && x.violations.empty())
    x.violations.push_back(
        {instant{}, report::run_is_complete, report.at("reason").get<std::string>()});
}

} // namespace

std::vector<std::string> run_words(const std::string& file, std::uint64_t seed,
                                   const std::string& length, const config::settings& settings) {
  std::vector<std::string> words{"rubicon",   "run",    file,      "--seed", std::to_string(seed),
                                 "--json",    "--mode", "virtual", "--log",  "off",
                                 "--threads", "1"};
  if (!length.empty())
    words.insert(words.end(), {"--for", length});
  for (const auto& each : settings)
    words.insert(words.end(), {"--set", each});
  return words;
}

std::optional<seed_outcome> judge(std::uint64_t seed, const child_end& how, duration real,
                                  bool overran) {
  seed_outcome x{seed, {}, real};
  const auto fail = [&](const char* invariant, std::string detail) {
    x.violations = {{instant{}, invariant, std::move(detail)}};
    return x;
  };
  if (overran)
    return fail("no end", "the run had not ended after " + to_text(real));
  if (how.overlong)
    return fail("a report", "the report of the run is too long");
  if (how.signal != 0)
    return fail("no crash",
                with_reason("the run ended with signal " + std::to_string(how.signal), how));
  try {
    const auto report = parse_json(how.out);
    if (report.at("interrupted").get<bool>())
      return std::nullopt;
    take_report(x, report);
  } catch (const json::exception&) {
    return fail("a report", with_reason("the run ended with status " + std::to_string(how.status) +
                                            " and without a report",
                                        how));
  }
  if (how.status != (x.violations.empty() ? 0 : 1))
    return fail("a report", "the run ended with status " + std::to_string(how.status) + " and " +
                                std::to_string(x.violations.size()) + " violations");
  return x;
}

std::optional<std::uint64_t> swarm::next() {
  if (all_given_ || next_ - due_ >= ahead_max)
    return std::nullopt;
  const auto seed = next_;
  all_given_ = seed == seeds_.last;
  ++next_;
  return seed;
}

std::vector<seed_outcome> swarm::ended(seed_outcome x) {
  const auto seed = x.seed;
  waiting_.emplace(seed, std::move(x));
  std::vector<seed_outcome> outcomes;
  for (auto i = waiting_.begin(); i != waiting_.end() && i->first == due_; ++due_) {
    count(i->second);
    outcomes.push_back(std::move(i->second));
    i = waiting_.erase(i);
  }
  return outcomes;
}

std::vector<seed_outcome> swarm::give_up() {
  std::vector<seed_outcome> outcomes;
  for (auto& [seed, x] : waiting_) {
    count(x);
    outcomes.push_back(std::move(x));
  }
  waiting_.clear();
  all_given_ = true;
  return outcomes;
}

void swarm::count(const seed_outcome& x) {
  ++totals_.runs;
  totals_.events += x.events;
  totals_.simulated_s += x.simulated_s;
  count_situations(x);
  if (!totals_.slowest_seed || x.real > totals_.slowest) {
    totals_.slowest_seed = x.seed;
    totals_.slowest = x.real;
  }
  if (x.violations.empty())
    return;
  ++totals_.failures;
  if (totals_.failed_seeds.size() < listed_max)
    totals_.failed_seeds.push_back(x.seed);
  for (const auto& found : x.violations)
    ++totals_.violations[found.invariant];
}

void swarm::count_situations(const seed_outcome& x) {
  for (const auto& each : x.situations) {
    auto found = std::ranges::find(totals_.situations, each.name, &coverage::name);
    if (found == totals_.situations.end())
      found = totals_.situations.insert(found, {each.name, 0, std::nullopt});
    if (!each.is_reached)
      continue;
    ++found->runs;
    if (!found->first_seed)
      found->first_seed = x.seed;
  }
}

bool swarm::misses_situations() const {
  return std::ranges::any_of(totals_.situations, [](const auto& x) { return x.runs == 0; });
}

} // namespace rubicon::cli
