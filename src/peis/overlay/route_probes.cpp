#include "peis/overlay/route_probes.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr duration probe_again = 200ms; // of many tries some arrive in spite of losses

} // namespace

void route_probes::begin(peer_id host, instant now) {
  if (probes_.size() >= hosts_max_)
    return;
  if (probes_.try_emplace(host, probe{now, now + timeout_, now}).second)
    next_ = earliest(next_, now);
}

void route_probes::extend(peer_id host, instant now) {
  const auto known = probes_.find(host);
  if (known == probes_.end())
    begin(host, now);
  else
    known->second.deadline = now + timeout_;
}

route_probes::outputs route_probes::on_time(instant now) {
  outputs out;
  if (!next_ || *next_ > now)
    return out;
  next_.reset();
  outputs silent;
  for (auto& [host, x] : probes_) {
    if (x.deadline <= now) {
      silent.emplace_back(way_disproved{host, x.since});
      continue;
    }
    if (x.next <= now) {
      out.emplace_back(probe_host{host, x.attempts++});
      x.next = now + probe_again;
    }
    next_ = earliest(next_, std::min(x.next, x.deadline));
  }
  std::erase_if(probes_, [now](const auto& x) { return x.second.deadline <= now; });
  out.insert(out.end(), silent.begin(), silent.end());
  return out;
}

} // namespace rubicon::peis
