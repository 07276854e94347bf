#include "peis/space/tuple_hosts.hpp"

#include <iterator>
#include <utility>

namespace rubicon::peis {

std::vector<prototype> tuple_hosts::appear(peer_id host, bool marked, std::int32_t incarnation) {
  strangers_.erase(host);
  known_[host] = {marked, incarnation};
  auto resumed = suspended_.extract(host);
  if (resumed.empty() || resumed.mapped().incarnation != incarnation)
    return {}; // it has begun anew
  return std::move(resumed.mapped().subscribed);
}

void tuple_hosts::vanish(peer_id host, std::vector<prototype> subscribed) {
  suspend(host, std::move(subscribed));
  known_.erase(host);
  strangers_.erase(host);
}

void tuple_hosts::suspend(peer_id host, std::vector<prototype> subscribed) {
  const auto* known = find(host);
  if (known == nullptr || known->marked || known->incarnation == 0 || subscribed.empty())
    return;
  if (suspended_.size() >= suspended_hosts_max && !suspended_.contains(host)) {
    suspended_.erase(suspended_.begin());
    ++suspended_forgotten_;
  }
  suspended_[host] = {known->incarnation, std::move(subscribed)};
}

bool tuple_hosts::admit(peer_id source, instant now) {
  if (known_.contains(source))
    return true;
  if (!strangers_.contains(source) && strangers_.size() >= strangers_max_) {
    ++strangers_refused_;
    return false;
  }
  strangers_[source] = now;
  next_silent_ = earliest(next_silent_, now + stranger_age_);
  return true;
}

std::vector<peer_id> tuple_hosts::take_silent(instant now) {
  std::vector<peer_id> silent;
  if (!next_silent_ || *next_silent_ > now)
    return silent;
  next_silent_.reset();
  for (auto at = strangers_.begin(); at != strangers_.end();) {
    const auto until = at->second + stranger_age_;
    if (until <= now) {
      silent.push_back(at->first);
      at = strangers_.erase(at);
    } else {
      next_silent_ = earliest(next_silent_, until);
      ++at;
    }
  }
  return silent;
}

const tuple_hosts::known_host* tuple_hosts::find(peer_id host) const {
  const auto at = known_.find(host);
  return at == known_.end() ? nullptr : &at->second;
}

} // namespace rubicon::peis
