#include "peis/links/announcer.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr unsigned first_announcements = 3;
constexpr unsigned quiet_periods = 3; // after these without a better announcer we announce

} // namespace

bool announcer::may_announce() const {
  return own_.config.connections.announces && !own_.left && !rivalry_.is_away();
}

void announcer::announce_now(const occasion& x) {
  if (may_announce() && (first_ < first_announcements || quiet_periods_ >= quiet_periods))
    announce(x.out);
}

void announcer::on_time(const occasion& x) {
  if (next_ > x.now || !may_announce())
    return;
  const bool is_first = first_ < first_announcements;
  next_ = x.now + own_.config.connections.announce_period;
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
