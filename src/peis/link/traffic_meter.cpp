#include "peis/link/traffic_meter.hpp"

#include <iterator>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr double smoothing = 0.3; // of a run

} // namespace

void traffic_meter::count(const outgoing_package& x) {
  switch (x.header.port) {
  case port::trace:
  case port::trace_reply:
  case port::dead_host:
  case port::host_query:
  case port::host_record:
  case port::acknowledgements:
    return;
  }
  if (hosts_.size() < hosts_max_ || hosts_.contains(x.header.destination))
    hosts_[x.header.destination].octets += header_size + x.length();
}

void traffic_meter::measure(instant now) {
  const auto elapsed = seconds(now - std::exchange(measured_, now));
  for (auto at = hosts_.begin(); at != hosts_.end();) {
    auto& x = at->second;
    const auto rate = elapsed > 0 ? static_cast<double>(std::exchange(x.octets, 0)) / elapsed : 0;
    x.per_second += smoothing * (rate - x.per_second);
    at = x.per_second < 1 ? hosts_.erase(at) : std::next(at);
  }
}

double traffic_meter::octets_per_second(peer_id to) const {
  const auto x = hosts_.find(to);
  return x == hosts_.end() ? 0 : x->second.per_second;
}

std::vector<peer_id> traffic_meter::above(double octets_per_second) const {
  std::vector<peer_id> hosts;
  for (const auto& [host, x] : hosts_) {
    if (x.per_second > octets_per_second)
      hosts.push_back(host);
  }
  return hosts;
}

} // namespace rubicon::peis
