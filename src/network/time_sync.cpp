#include "network/time_sync.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::network {

time_sync::time_sync(const time_sync_config& config, random_stream search_rng, instant now)
    : is_root_(config.clock.is_root), duty_(config.duty), clock_(config.clock, now),
      search_(config.search, search_rng, now), relay_(config.relay), answers_(config.answers, now),
      silence_(config.duty.period), requests_(now) {}

stamp_effect time_sync::on_stamp(const clock_stamp& x, instant sfd, bool is_urgent, instant now,
                                 random_stream& rng) {
  stamp_effect effect;
  search_.on_beacon(now);
  const auto value = clock_.on_stamp(x, sfd);
  switch (value) {
  case stamp_value::news:
  case stamp_value::leap: {
    requests_.on_round(now);
    relay_.on_round(now, rng);
    const bool has_leapt = value == stamp_value::leap;
    search_.on_news(has_leapt ? std::optional(time().last_leap()) : std::nullopt, time(), now);
    effect.is_news = true;
    return effect;
  }
  case stamp_value::in_dispute:
    effect.disputes = true;
    break;
  case stamp_value::outdated:
    effect.is_answered = answer(x, now, rng);
    break;
  case stamp_value::none:
  case stamp_value::point:
    break;
  }
  if (!clock_.is_of_last_round(x))
    return effect;
  if (x.doubt != doubt_asks && !is_root_)
    answers_.on_answer();
  relay_.on_copy(is_urgent);
  return effect;
}

/// One who asks, or who has a time that is not the island's any more. Where radios sleep it is on
/// just now.
bool time_sync::answer(const clock_stamp& x, instant now, random_stream& rng) {
  const bool asks = x.doubt == doubt_asks;
  if (asks)
    search_.on_asked(now);
  else if (x.root == mote_id{} && !duty_.enabled()) // it waits for a round
    return false;
  if (!time().synchronised() || is_lost(now) || time().is_distrusted())
    return false;
  return answers_.on_request(asks, now, rng);
}

/// Where radios sleep a mote whose time is wrong sends while no other listens.
bool time_sync::on_unicast(bool acked, instant now) {
  if (!duty_.enabled() || is_root_ || !silence_.on_unicast(acked, now))
    return false;
  clock_.distrust();
  return true;
}

bool time_sync::on_beacon_due(bool is_extra, instant now) {
  if (!is_extra)
    relay_.clear();
  answers_.on_beacon(now);
  if (!search_.rests() || !is_lost(now))
    return false;
  search_.on_beacon_sent(now);
  return true;
}

void time_sync::on_beacon_sent(instant now, random_stream& rng) {
  if (time().synchronised())
    relay_.on_relayed(now, rng);
}

bool time_sync::on_time(instant now) {
  if (!clock_.on_time(now))
    return false;
  relay_.on_own_round();
  return true;
}

time_knowledge time_sync::knowledge(instant now) const {
  if (time().is_disputed())
    return time_knowledge::doubted;
  if (!time().synchronised() || is_lost(now))
    return time_knowledge::none;
  return clock_.is_trusted(now) ? time_knowledge::good : time_knowledge::stale;
}

time_search::beacon_due time_sync::search_time(instant now) {
  if (is_root_ && std::exchange(steps_, time().steps()) != time().steps())
    search_.announce(now);
  return search_.on_time(now, knowledge(now), time());
}

std::optional<duration> time_sync::request_period(bool has_route, instant now, random_stream& rng) {
  return requests_.on_time(has_route ? clock_.wanted_period() : std::nullopt, now, rng);
}

std::optional<instant> time_sync::deadline(instant turn) const {
  auto next = earliest(earliest(clock_.deadline(), search_.deadline()),
                       earliest(answers_.due(), requests_.deadline()));
  if (relay_.due())
    next = earliest(next, std::max(*relay_.due(), turn));
  return search_.is_lost() ? next : earliest(next, clock_.stale_at());
}

} // namespace rubicon::network
