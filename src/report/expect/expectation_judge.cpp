#include "report/expect/expectation_judge.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "report/expect/expectations.hpp"
#include "report/figures.hpp"

namespace rubicon::report {

namespace {

using verdict = expectation_report::verdict;

/// Shares are counted in whole things, and `99.9%` is no binary fraction.
constexpr double share_slack = 1e-9;
bool reaches(double share, double bound) {
  return share + share_slack >= bound;
}
bool keeps_below(double share, double bound) {
  return share - share_slack <= bound;
}

std::string at_text(instant x) {
  return "at " + run_time(x);
}

std::string seconds_text(duration x) {
  return fixed(seconds(x), 3) + " s";
}

/// `97.31%`
std::string measured_share(double x) {
  return fixed(std::floor(x * 1e5) / 1e3, 3) + '%';
}

/// Judges an expectation of each kind.
struct judge_one {
  const noticed& all;
  const watched_expectation& of;
  const run_report& run;
  expectation_report& out;

  void decide(bool is_met, std::string measured, std::optional<instant> at = std::nullopt) const {
    out.outcome = is_met ? verdict::met : verdict::unmet;
    out.measured = std::move(measured);
    out.at = at.value_or(instant{} + run.simulated);
  }

  /// What is to be looked at comes after the end: of a run that was shortened.
  void leave_open() const { out.measured = "the run was too short"; }
  [[nodiscard]] bool is_before(duration x) const { return run.simulated < x; }

  /// Motes that are meant and are to join, with their names.
  template <class Function>
  void each_mote(const config::mote_scope& scope, Function use) const {
    for (const auto& island : run.islands)
      for (const auto& mote : island.motes)
        if (mote.joins && scope.contains(mote.address))
          use(island.name + '/' + mote.name, mote);
  }

  void explain_messages(const config::mote_scope& scope) const {
    out.explain = {"--lost"};
    if (scope.name != "*")
      out.explain.insert(out.explain.end(), {"--from", scope.name});
  }

  void operator()(const config::delivery_expectation& x) const {
    message_report sum;
    each_mote(x.of, [&sum](const auto&, const auto& mote) { sum += mote.messages; });
    explain_messages(x.of);
    const auto share = sum.delivery();
    if (!share)
      return decide(false, "no message was offered");
    cause_counts lost = sum.lost;
    add_to(lost, sum.refused);
    std::string text;
    for (const auto& [cause, count] : lost)
      if (count > 0)
        text += ", " + cause + ' ' + with_thousands(count);
    decide(reaches(*share, x.at_least),
           measured_share(*share) + " of " + counted(sum.offered, "message") + text);
  }

  void operator()(const config::acknowledged_expectation& x) const {
    message_report sum;
    each_mote(x.of, [&sum](const auto&, const auto& mote) { sum += mote.messages; });
    explain_messages(x.of);
    const auto offered = sum.offered - std::min(sum.offered, sum.unreliable_sent);
    if (offered <= sum.reliable_open)
      return decide(false, "no message was offered");
    const auto share =
        static_cast<double>(sum.reliable_acked) / static_cast<double>(offered - sum.reliable_open);
    decide(reaches(share, x.at_least),
           measured_share(share) + ": " + with_thousands(sum.reliable_acked) + " of " +
               with_thousands(offered) + ", " + with_thousands(total(sum.refused)) + " refused");
  }

  void operator()(const config::stream_expectation& x) const {
    const auto found = std::ranges::find_if(run.streams, [&x](const stream_report& each) {
      return each.stream == x.stream && each.to == x.to_name;
    });
    out.explain = {"--lost"};
    if (found == run.streams.end() || !found->delivery())
      return decide(false, found == run.streams.end() ? "no component wrote it"
                                                      : "no record was produced");
    if (!found->from.empty())
      out.explain.insert(out.explain.end(), {"--from", found->from});
    const auto share = *found->delivery();
    const auto pause_max = x.pause.value_or(duration::max());
    decide(reaches(share, x.at_least) && found->pause <= pause_max &&
               found->first_after <= x.first_within.value_or(pause_max),
           measured_share(share) + ": " + with_thousands(found->read) + " read of " +
               with_thousands(found->produced) + " produced, " + with_thousands(found->written) +
               " written, " + counted(found->openings, "opening") + ", the first after " +
               seconds_text(found->first_after) + ", longest pause " + seconds_text(found->pause));
  }

  void operator()(const config::actuations_expectation& x) const {
    actuation_report sum;
    for (const auto& proxy : run.proxies)
      if (x.proxy == "*" || equal_keys(proxy.name, x.proxy))
        sum += proxy.actuations;
    out.explain = {"--lost"};
    const auto text = with_thousands(sum.acknowledged) + " acknowledged of " +
                      with_thousands(sum.requested) + " requested";
    const auto share = sum.requested == 0 ? 0
                                          : static_cast<double>(sum.acknowledged) /
                                                static_cast<double>(sum.requested);
    decide(sum.requested >= x.count && reaches(share, x.at_least),
           (sum.requested == 0 ? std::string() : measured_share(share) + ": ") + text);
  }

  void operator()(const config::tuple_expectation& x) const {
    auto watch = of.tuples;
    watch.expire(x, instant{} + run.simulated);
    out.explain = {x.then.key};
    if (watch.missed) {
      const auto due = *watch.missed + x.within;
      out.explain = {x.when ? x.when->key : x.then.key, "--at",
                     just_after(x.when ? *watch.missed : due)};
      return decide(false,
                    (x.when ? "due since " + seconds_text(watch.missed->time_since_epoch()) : "") +
                        (x.when ? ": " : "") + "not met until " +
                        seconds_text(due.time_since_epoch()) + "; " + with_thousands(watch.met) +
                        " of " + counted(watch.times, "time"),
                    due);
    }
    if (watch.met == 0 && !watch.waiting.empty())
      return leave_open();
    if (watch.met == 0)
      return decide(false, "the condition never became true");
    decide(true, counted(watch.met, "time") + ", the slowest " + seconds_text(watch.slowest));
  }

  /// For `--at`: when what has happened at `x` is seen.
  static std::string just_after(instant x) {
    return std::to_string(x.time_since_epoch() / 1ms + 1) + "ms";
  }

  void operator()(const config::clock_expectation& x) const {
    const auto& watch = of.clocks;
    if (watch.samples == 0 && is_before(x.from))
      return leave_open();
    if (watch.samples == 0)
      return decide(false, "no mote's clock was ever compared");
    const auto good = static_cast<double>(watch.samples - watch.bad);
    const auto share = good / static_cast<double>(watch.samples);
    decide(reaches(share, x.share),
           measured_share(share) + " of " + counted(watch.samples, "sample") + ", worst " +
               rubicon::to_text(watch.worst) +
               (watch.worst_at.empty() ? "" : " (" + watch.worst_at + ')'),
           reaches(share, x.share) ? std::nullopt : watch.first_bad);
  }

  void operator()(const config::joined_expectation& x) const {
    std::uint64_t motes = 0;
    std::uint64_t late = 0;
    duration slowest{};
    std::string names;
    each_mote(x.of, [&](const std::string& name, const mote_report& mote) {
      ++motes;
      const auto found = all.joined.find(mote.address);
      const bool joined = found != all.joined.end();
      if (joined)
        slowest = std::max(slowest, found->second.time_since_epoch());
      if (joined && found->second.time_since_epoch() <= x.within)
        return;
      if (++late <= 3)
        names += (names.empty() ? "" : ", ") + name +
                 (joined ? ' ' + at_text(found->second) : std::string(" never"));
    });
    if (late > 0 && is_before(x.within))
      return leave_open();
    if (late > 0)
      return decide(false,
                    names + (late > 3 ? ", …" : "") + "; " + with_thousands(late) + " of " +
                        counted(motes, "mote") + " late",
                    instant{} + x.within);
    decide(motes > 0, motes == 0
                          ? "there is no such mote"
                          : counted(motes, "mote") + ", the last after " + seconds_text(slowest));
  }

  void operator()(const config::members_expectation& x) const {
    std::uint64_t motes = 0;
    std::uint64_t listed = 0;
    std::string absent;
    each_mote(x.of, [&](const std::string& name, const mote_report& mote) {
      ++motes;
      if (mote.joined && mote.left_cause.empty())
        ++listed;
      else
        absent += (absent.empty() ? "; not " : ", ") + name;
    });
    decide(motes > 0 && listed >= x.at_least.value_or(motes),
           with_thousands(listed) + " of " + with_thousands(motes) + absent.substr(0, 200));
  }

  /// The mote that is worst off decides.
  template <class Share>
  void worst(const config::mote_scope& scope, Share share_of, bool (*is_good)(double, double),
             double bound) const {
    std::optional<double> found;
    std::string who;
    each_mote(scope, [&](const std::string& name, const mote_report& mote) {
      const auto share = share_of(mote);
      if (found && is_good(share, *found))
        return;
      found = share;
      who = name;
    });
    decide(found && is_good(*found, bound),
           found ? measured_share(*found) + " (" + who + ')' : "there is no such mote");
  }

  void operator()(const config::battery_expectation& x) const {
    worst(
        x.of,
        [](const mote_report& mote) {
          return mote.energy.battery_mah > 0
                     ? std::max(0.0, 1 - mote.energy.used_mah / mote.energy.battery_mah)
                     : 0;
        },
        reaches, x.at_least);
  }

  void operator()(const config::radio_expectation& x) const {
    worst(
        x.of,
        [](const mote_report& mote) {
          const auto on =
              mote.energy.radio_listen + mote.energy.radio_receive + mote.energy.radio_transmit;
          const auto all_time = on + mote.energy.radio_off;
          return all_time > 0s ? seconds(on) / seconds(all_time) : 0;
        },
        keeps_below, x.at_most);
  }

  void operator()(const config::vectors_expectation& x) const {
    if (is_before(x.from))
      return leave_open();
    std::map<std::string, std::uint64_t> missed_at;
    std::uint64_t updated = 0;
    for (const auto& program : run.programs) {
      if (x.node != "*" && program.who != x.node)
        continue;
      for (const auto& [name, value] : program.figures) {
        if (name == "vectors updated")
          updated += static_cast<std::uint64_t>(value);
        else if (name == "vectors missed")
          missed_at[program.who] += static_cast<std::uint64_t>(value);
      }
    }
    for (const auto& [program, before] : of.vectors.before)
      if (const auto found = missed_at.find(program.first); found != missed_at.end())
        found->second -= std::min(found->second, before);
    std::uint64_t missed = 0;
    for (const auto& [node, count] : missed_at)
      missed += count;
    if (updated + missed == 0)
      return decide(false, "no vector was due");
    const auto worst =
        std::ranges::max_element(missed_at, {}, [](const auto& y) { return y.second; });
    decide(missed <= x.missed,
           with_thousands(missed) + " missed, " + with_thousands(updated) + " updated" +
               (missed == 0 ? ""
                            : "; most at " + worst->first + ": " + with_thousands(worst->second)));
  }

  void operator()(const config::events_expectation& x) const {
    decide(run.events <= x.at_most, counted(run.events, "event"));
  }

  void operator()(const config::event_log_expectation& x) const {
    log_watch found = of.log;
    if (!all.hears_events)
      for (const auto& line : run.event_log)
        found.take(x, line);
    decide(found.count >= x.at_least && (!x.at_most || found.count <= *x.at_most),
           counted(found.count, "line") + (found.last ? ", the last " + at_text(*found.last) : ""));
  }

  /// A run that does not come into it has done nothing wrong.
  void operator()(const config::sometimes_expectation& x) const {
    auto found = of.situation;
    if (!all.hears_events && !x.during)
      for (const auto& line : run.event_log)
        found.on_event(x, line);
    if (!found.first()) {
      out.measured = "not reached";
      out.at = instant{} + run.simulated;
      return;
    }
    decide(true,
           "reached " + counted(found.times(), "time") + ", the first " + at_text(*found.first()),
           *found.first());
  }
};

} // namespace

expectation_report judge(const watched_expectation& x, const noticed& all, const run_report& run) {
  expectation_report out;
  out.text = to_text(x.what);
  if (run.complete && !run.interrupted) {
    std::visit(judge_one{all, x, run, out}, x.what);
  } else {
    out.measured = "the run was aborted";
    out.at = instant{} + run.simulated;
  }
  return out;
}

} // namespace rubicon::report
