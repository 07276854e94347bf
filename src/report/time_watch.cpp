#include "report/time_watch.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "report/figures.hpp"
#include "report/invariants.hpp"

namespace rubicon::report {

namespace {

constexpr std::size_t violations_max = 200;
constexpr std::uint64_t unheard_min = 3;         ///< messages: fewer that are lost are no silence
constexpr std::uint64_t unheard_judged_min = 10; ///< and fewer no violation

} // namespace

duration healing_rules::bound(unsigned hops) const {
  constexpr duration awake = 2min;
  constexpr int periods = 4;
  return sleeps ? std::max(hops, 1U) * (periods * period + awake) : awake;
}

void time_watch::add_island(island_id id, std::string name, const healing_rules& rules) {
  islands_[id] = {std::move(name), rules, instant{}, 0, {}};
}

void time_watch::on_cause(island_id island, instant until) {
  const auto found = islands_.find(island);
  if (found != islands_.end())
    found->second.cause_until = std::max(found->second.cause_until, until);
}

void time_watch::on_cause(instant until) {
  for (auto& [id, island] : islands_)
    island.cause_until = std::max(island.cause_until, until);
}

void time_watch::on_listed(mote_address address, bool listed, bool by_itself, instant now) {
  const auto of = islands_.find(address.island);
  if (of == islands_.end())
    return;
  auto& who = motes_[address];
  who.is_listed = listed;
  who.is_expected = listed || (who.is_expected && !by_itself);
  if (listed || !who.is_expected)
    end_silence(of->second, who, who.unlisted, now);
  else if (!who.unlisted.since && (who.runs || !who.is_known))
    who.unlisted.since = now;
}

void time_watch::look(mote_address address, const std::string& name, const mote_look& x,
                      instant now) {
  const auto found = islands_.find(address.island);
  if (found == islands_.end())
    return;
  auto& of = found->second;
  auto& who = motes_[address];
  if (who.name.empty())
    who.name = name;
  note_power(of, who, x, now);
  if (!x.runs) {
    end_silence(of, who, who.unlisted, now);
    end_silence(of, who, who.unheard, now);
    end_wrong(of, who, now);
    return;
  }
  who.hops = std::max(who.hops, x.hops);
  if (!x.has_route && (of.down > 0 || x.moves))
    who.excused = now; // whoever would receive it is not there
  if (who.is_expected && !who.is_listed && !who.unlisted.since)
    who.unlisted.since = now; // it has been without power meanwhile
  judge(who.unlisted, of, who, of.rules.departure, now);
  judge_messages(of, who, x, now);
  judge_clock(of, who, x, now);
}

void time_watch::note_power(watched_island& of, watched_mote& who, const mote_look& x,
                            instant now) {
  const bool was_down = who.is_known && !who.runs;
  of.down += static_cast<std::size_t>(!x.runs) - static_cast<std::size_t>(was_down);
  if (!x.runs || !who.is_known)
    who.excused = now;
  if (who.is_known && who.runs != x.runs)
    of.cause_until = std::max(of.cause_until, now);
  who.is_known = true;
  who.runs = x.runs;
}

/// Counted from its beginning, or from when the last that may have led to it was over.
void time_watch::judge(trouble& x, const watched_island& of, const watched_mote& who, duration more,
                       instant now) {
  if (!x.since || x.too_long || !of.rules.judges)
    return;
  const auto from = std::max({*x.since, of.cause_until, who.excused});
  if (now - from > of.rules.bound(who.hops) + more)
    x.too_long = now;
}

/// A mote of which messages have come before sends on, and none comes any more. While a mote does
/// not run, it may be the one that they were for.
void time_watch::judge_messages(const watched_island& of, watched_mote& who, const mote_look& x,
                                instant now) {
  const bool is_new_life = !x.messages || *x.messages < who.messages;
  const auto sent = is_new_life ? 0 : *x.messages - who.messages;
  who.messages = x.messages.value_or(0);
  const bool came = std::exchange(who.arrived, x.arrived) != x.arrived;
  who.was_heard = who.was_heard || came;
  if (came || is_new_life || !who.was_heard || of.down > 0) {
    end_silence(of, who, who.unheard, now);
    return;
  }
  who.unheard_messages += sent;
  if (sent > 0 && !who.unheard.since)
    who.unheard.since = now;
  if (who.is_listed && who.unheard_messages >= unheard_judged_min)
    judge(who.unheard, of, who, of.rules.departure, now);
}

void time_watch::judge_clock(watched_island& of, watched_mote& who, const mote_look& x,
                             instant now) {
  if (!of.rules.judges || !x.clock_error) {
    end_wrong(of, who, now);
    return;
  }
  auto& clock = of.clock;
  const auto error = *x.clock_error;
  ++clock.judged;
  clock.below_1ms += error < 1ms ? 1 : 0;
  if (error > clock.error_max || clock.error_max_mote.empty()) {
    clock.error_max = error;
    clock.error_max_mote = who.name;
    clock.error_max_at = now;
  }
  const bool lies = error - x.clock_doubt > clock_excess_max;
  clock.outside += lies ? 1 : 0;
  if (!lies && (of.rules.sleeps || error <= clock_error_max)) {
    end_wrong(of, who, now);
    return;
  }
  if (!who.wrong.since)
    who.wrong.since = now;
  judge(who.wrong, of, who, 0s, now);
}

void time_watch::end_wrong(watched_island& of, watched_mote& who, instant now) {
  if (!who.wrong.since)
    return;
  of.clock.outside_longest = std::max(of.clock.outside_longest, now - *who.wrong.since);
  if (who.wrong.too_long)
    keep(clock_violation(of, who, now));
  who.wrong = {};
}

void time_watch::note_silence(watched_mote& who, const trouble& x, instant now) {
  if (!x.since || now - *x.since <= who.silence)
    return;
  if (&x == &who.unheard && who.unheard_messages < unheard_min)
    return;
  who.silence = now - *x.since;
  who.silence_from = *x.since;
}

void time_watch::end_silence(const watched_island& of, watched_mote& who, trouble& x, instant now) {
  note_silence(who, x, now);
  if (x.too_long)
    keep(silence_violation(of, who, x, now));
  x = {};
  if (&x == &who.unheard)
    who.unheard_messages = 0;
}

violation time_watch::silence_violation(const watched_island& of, const watched_mote& who,
                                        const trouble& x, instant now) {
  const auto why = &x == &who.unheard
                       ? std::string(": it is listed, but none of its messages arrives")
                       : std::string(": its gateway does not list it");
  return {*x.too_long, nobody_is_silent,
          who.name + " was silent for " + span_text(now - *x.since, *x.since) + why +
              "; the limit is " +
              real_time(seconds(of.rules.bound(who.hops) + of.rules.departure))};
}

violation time_watch::clock_violation(const watched_island& of, const watched_mote& who,
                                      instant now) {
  return {*who.wrong.too_long, clocks_keep_their_bound,
          who.name + " had the wrong time for " +
              span_text(now - *who.wrong.since, *who.wrong.since) + "; the limit is " +
              real_time(seconds(of.rules.bound(who.hops)))};
}

void time_watch::keep(violation x) {
  if (found_.size() < violations_max)
    found_.push_back(std::move(x));
}

void time_watch::fill(run_report& x, instant now) const {
  auto all = *this;
  for (auto& [address, who] : all.motes_) {
    auto& of = all.islands_.at(address.island);
    all.end_silence(of, who, who.unlisted, now);
    all.end_silence(of, who, who.unheard, now);
    all.end_wrong(of, who, now);
  }
  for (auto& island : x.islands) {
    if (const auto of = all.islands_.find(island.id); of != all.islands_.end())
      island.clock = of->second.clock;
    for (auto& mote : island.motes)
      if (const auto who = all.motes_.find(mote.address); who != all.motes_.end()) {
        mote.silence = who->second.silence;
        mote.silence_from = who->second.silence_from;
      }
  }
  std::ranges::stable_sort(all.found_, {}, &violation::at);
  std::ranges::move(all.found_, std::back_inserter(x.violations));
}

} // namespace rubicon::report
