#include "peis/links/announcer.hpp"

#include <algorithm>
#include <cstddef>

namespace rubicon::peis {

namespace {

constexpr unsigned first_announcements = 3;
constexpr unsigned quiet_periods = 3; // after these without a better announcer we announce
constexpr std::size_t periods_max = 30;

} // namespace

bool announcer::may_announce() const {
  return own_.config.connections.announces && !own_.left && !rivalry_.is_away();
}

duration announcer::period() {
  const auto periods =
      std::clamp<std::size_t>(hosts_.all().size() / (hosts_many / 2), 1, periods_max);
  const auto mean = own_.config.connections.announce_period * static_cast<duration::rep>(periods);
  return periods == 1 ? mean : own_.rng.between(mean * 3 / 4, mean * 5 / 4); // not all at once
}

void announcer::announce_now(const occasion& x) {
  if (!may_announce() || (first_ >= first_announcements && quiet_periods_ < quiet_periods))
    return;
  if (hosts_.all().size() < hosts_many)
    announce(x.out);
  else // with what else changes meanwhile
    next_ = std::min(next_, x.now + own_.config.connections.announce_period);
}

void announcer::on_time(const occasion& x) {
  if (next_ > x.now || !may_announce())
    return;
  const bool is_first = first_ < first_announcements;
  next_ = x.now + (is_first ? own_.config.connections.announce_period : period());
  quiet_periods_ = std::min(quiet_periods_ + 1, quiet_periods);
  first_ += is_first ? 1 : 0;
  if (is_first || quiet_periods_ >= quiet_periods)
    announce(x.out);
}

void announcer::announce(events& out) {
  ++own_.counters.announcements_sent;
  out.push_back(peis::announce{own_.hello()});
}

std::optional<instant> announcer::deadline() const {
  return own_.config.connections.announces ? std::optional(next_) : std::nullopt;
}

} // namespace rubicon::peis
