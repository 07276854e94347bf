#include "report/merge.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/hash.hpp"
#include "report/event_log.hpp"
#include "report/expect/expectations.hpp"
#include "report/figures.hpp"
#include "report/invariants.hpp"

namespace rubicon::report {

namespace {

using verdict = expectation_report::verdict;

constexpr std::size_t failures_max = 100;

/// Takes an element into a list that is kept in order; one that is there already, of an earlier
/// life, gives way.
template <class T, class Key>
void take(std::vector<T>& all, T x, Key key) {
  const auto at = std::ranges::lower_bound(all, key(x), {}, key);
  if (at != all.end() && !(key(x) < key(*at)))
    *at = std::move(x);
  else
    all.insert(at, std::move(x));
}

/// What an island's earlier life has counted, too. What motes are at the end, the last one says.
void add_earlier(island_report& x, const island_report& before) {
  x.radio += before.radio;
  x.serial += before.serial;
  auto real = before.real;
  if (const auto open = std::exchange(real.inputs_open, 0); open > 0)
    real.inputs_failed["gateway_ended"] += open;
  x.real += real;
  auto network = before.network;
  network.synchronised = network.aligned = 0;
  network.hops_max = 0;
  x.network += network;
  auto groups = before.smepp;
  groups.programs = groups.members = 0;
  if (const auto open = std::exchange(groups.events_open, 0); open > 0)
    groups.events_lost["power_lost"] += open;
  x.smepp += groups;
  for (auto& gateway : x.gateways) {
    const auto same = std::ranges::find(before.gateways, gateway.id, &gateway_report::id);
    if (same == before.gateways.end())
      continue;
    gateway.lead.led += same->lead.led;
    gateway.lead.leading += same->lead.leading;
  }
  for (auto& mote : x.motes) {
    const auto same = std::ranges::find(before.motes, mote.address, &mote_report::address);
    if (same == before.motes.end())
      continue;
    mote.joined |= same->joined;
    auto energy = mote.energy;
    energy += same->energy;
    energy.battery_mah = mote.energy.battery_mah;
    mote.energy = energy;
  }
}

std::uint64_t number_of(const std::string& hex) {
  std::uint64_t x = 0;
  std::from_chars(hex.data(), hex.data() + hex.size(), x, 16);
  return x;
}

/// Of a life that was killed, what waited for an outcome will get none.
void end_open(unsettled_counters& x) {
  for (auto* all : {&x.messages, &x.pcs})
    for (auto& [who, messages] : *all)
      messages.reliable_failed += std::exchange(messages.reliable_open, 0);
}

/// What was in transit when a life ended went with it.
void end_in_transit(unsettled_counters& x) {
  const std::string cause(to_string(loss::node_stopped));
  for (auto& [key, account] : x.accounts) {
    account.handed_lately = 0; // it is long ago when all end
    const auto known = account.arrived + account.handed_over + total(account.lost);
    if (account.sent <= known)
      continue;
    account.lost[cause] += account.sent - known;
    x.losses[{key.second, cause, {}}] += account.sent - known;
  }
}

class merger {
public:
  merger(const config::ecology_description& description, run_report& out)
      : description_(description), out_(out) {}

  void add(const host_report& part) {
    for (std::size_t i = 0; i < part.lives.size(); ++i) {
      const bool is_last = i + 1 == part.lives.size();
      add(part.host, part.lives[i], is_last);
      if (!is_last && !part.lives[i].is_final)
        note_gap(part.host, part.lives[i], part.lives[i + 1].elapsed);
    }
    if (part.lives.empty() || !part.lives.back().is_final)
      missing_.push_back(part.host);
  }

  void finish() {
    if (missing_.empty())
      counters_.end_handed_over();
    counters_.settle(out_);
    for (auto& x : check_messages(out_))
      out_.violations.push_back(std::move(x));
    out_.trace_hash = to_hex(hash_);
    std::ranges::stable_sort(out_.event_log, {}, &logged_event::at);
    out_.event_log_left_out += thin(out_.event_log, event_log_max);
    std::ranges::stable_sort(out_.violations, {}, &violation::at);
    for (const auto& host : missing_)
      out_.violations.push_back({instant{} + out_.simulated, run_is_complete,
                                 "host " + host + ": its part sent no final report"});
    out_.complete = out_.complete && missing_.empty();
    if (!missing_.empty() && out_.reason.empty())
      out_.reason = "no final report from host " + missing_.front();
    judge();
  }

private:
  void add(const std::string& host, const part_life& life, bool is_last) {
    auto x = life.newest.report;
    auto counters = life.newest.counters;
    unsettle(x);
    if (!life.is_final)
      end_open(counters);
    if (!life.is_final || !is_last)
      end_in_transit(counters);
    counters_.add(counters, instant{} + life.elapsed);
    const bool has_reported = !x.ecology.empty(); // it may have ended before
    out_.simulated = std::max(out_.simulated, x.simulated + life.elapsed);
    out_.wall_s = std::max(out_.wall_s, x.wall_s + seconds(life.elapsed));
    out_.events += x.events;
    hash_ += number_of(x.trace_hash);
    out_.actors.spawned += x.actors.spawned;
    out_.actors.restarted += x.actors.restarted;
    out_.actors.changes_refused += x.actors.changes_refused;
    for (auto& failure : x.actors.failures)
      if (out_.actors.failures.size() < failures_max)
        out_.actors.failures.push_back(std::move(failure));
    add_things(std::move(x.islands), std::move(x.peers), std::move(x.flows));
    for (auto& event : x.event_log) {
      event.at += life.elapsed;
      out_.event_log.push_back(std::move(event));
    }
    out_.event_log_left_out += x.event_log_left_out;
    if (has_reported && (life.is_final || !is_last))
      for (auto& violation : x.violations)
        if (!violation.invariant.starts_with(expected) &&
            (life.is_final || violation.invariant != run_is_complete)) {
          violation.at += life.elapsed;
          out_.violations.push_back(std::move(violation));
        }
    if (life.is_final) {
      out_.interrupted |= x.interrupted;
      out_.complete &= x.complete;
      if (!x.complete && out_.reason.empty())
        out_.reason = "host " + host + ": " + x.reason;
    }
    if (is_last)
      judged_.insert(judged_.end(), std::make_move_iterator(x.expectations.begin()),
                     std::make_move_iterator(x.expectations.end()));
  }

  /// A process that was killed has reported nothing of its last seconds.
  /// @param next when the one after it began
  void note_gap(const std::string& host, const part_life& life, duration next) {
    const auto last = life.elapsed + life.newest.report.simulated;
    const auto until = std::max(last, life.ended > duration{} ? life.ended : next);
    const auto until_text = clock_text(std::chrono::floor<std::chrono::seconds>(until));
    out_.event_log.push_back(
        {instant{} + last, host,
         "last contact: its part's counts until " + until_text + " are unknown"});
    if (until - last <= 2 * part_report_every)
      return;
    const auto what = "host " + host + ": its part's counts from " +
                      clock_text(std::chrono::floor<std::chrono::seconds>(last)) + " to " +
                      until_text + " are unknown";
    out_.complete = false;
    if (out_.reason.empty())
      out_.reason = what;
    out_.violations.push_back({instant{} + last, run_is_complete, what});
  }

  void add_things(std::vector<island_report> islands, std::vector<peer_report> peers,
                  std::vector<flow_report> flows) {
    const auto island_key = [](const auto& x) { return x.id; };
    for (auto& island : islands) {
      const auto before = std::ranges::find(out_.islands, island.id, &island_report::id);
      if (before != out_.islands.end())
        add_earlier(island, *before);
      take(out_.islands, std::move(island), island_key);
    }
    for (auto& peer : peers)
      take(out_.peers, std::move(peer), [](const auto& x) { return x.id; });
    for (auto& flow : flows)
      take(out_.flows, std::move(flow), [](const auto& x) { return std::pair(x.from, x.to); });
  }

  /// What the parts could judge, they have; the rest is found in the whole report.
  void judge() {
    const expectations all(description_.expectations, description_.length);
    out_.expectations = all.judge(out_);
    for (std::size_t i = 0; i < out_.expectations.size(); ++i) {
      auto& x = out_.expectations[i];
      std::vector<expectation_report> parts;
      std::ranges::copy_if(judged_, std::back_inserter(parts),
                           [&x](const auto& y) { return y.text == x.text; });
      if (!parts.empty())
        x = worst(parts);
      else if (is_watched(description_.expectations[i])) {
        x.outcome = verdict::unjudged;
        x.measured = "not checked: it concerns tuples of several hosts";
        x.explain.clear();
      }
      if (x.outcome == verdict::unmet)
        out_.violations.push_back(violation_of(x));
    }
  }

  static bool is_watched(const config::expectation& x) {
    const auto* situation = std::get_if<config::sometimes_expectation>(&x);
    return (situation != nullptr && situation->during) ||
           std::holds_alternative<config::tuple_expectation>(x) ||
           std::holds_alternative<config::clock_expectation>(x) ||
           std::holds_alternative<config::joined_expectation>(x) ||
           std::holds_alternative<config::vectors_expectation>(x);
  }

  /// Unmet before unjudged before met.
  static expectation_report worst(const std::vector<expectation_report>& all) {
    const auto rank = [](const auto& x) {
      return x.outcome == verdict::unmet ? 0 : x.outcome == verdict::unjudged ? 1 : 2;
    };
    return *std::ranges::min_element(all, {}, rank);
  }

  const config::ecology_description& description_;
  run_report& out_;
  run_counters counters_;
  std::uint64_t hash_ = 0;
  std::vector<expectation_report> judged_;
  std::vector<std::string> missing_;
};

} // namespace

run_report merged(const config::ecology_description& description,
                  const std::vector<host_report>& parts) {
  run_report out;
  out.ecology = description.name;
  out.seed = description.seed;
  out.mode = "wall";
  out.complete = true;
  merger all(description, out);
  for (const auto& part : parts)
    all.add(part);
  all.finish();
  return out;
}

} // namespace rubicon::report
