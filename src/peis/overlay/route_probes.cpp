#include "peis/overlay/route_probes.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr duration probe_again = 600ms;

} // namespace

void route_probes::begin(peer_id host, instant now) {
  if (probes_.size() >= hosts_max_)
    return;
  if (probes_.try_emplace(host, probe{now + timeout_, now}).second)
    next_ = earliest(next_, now);
}

route_probes::outputs route_probes::on_time(instant now) {
  outputs out;
  if (!next_ || *next_ > now)
    return out;
  next_.reset();
  outputs silent;
  for (auto& [host, x] : probes_) {
    if (x.deadline <= now) {
      silent.emplace_back(way_disproved{host});
      continue;
    }
    if (x.next <= now) {
      out.emplace_back(probe_host{host});
      x.next = now + probe_again;
    }
    next_ = earliest(next_, std::min(x.next, x.deadline));
  }
  std::erase_if(probes_, [now](const auto& x) { return x.second.deadline <= now; });
  out.insert(out.end(), silent.begin(), silent.end());
  return out;
}

} // namespace rubicon::peis
