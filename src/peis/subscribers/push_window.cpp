#include "peis/subscribers/push_window.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

/// Requests of other kinds that the tuple space makes count from own_ids_first on.
constexpr std::uint64_t requests_first = own_ids_first + (std::uint64_t{1} << 62U);

} // namespace

bool push_window::admits(peer_id host, std::size_t octets) const {
  const bool room = total_ == 0 || total_ + octets <= config_.total_max;
  const auto at = hosts_.find(host);
  if (at == hosts_.end() || at->second.requests.empty())
    return room || octets <= config_.small;
  const auto& x = at->second;
  return room && x.requests.size() < x.window && x.octets + octets <= config_.octets_max;
}

request_id push_window::leave(ticket x) {
  const request_id request{requests_first + made_++};
  auto& to = hosts_.try_emplace(x.host, flow{config_.messages_max, 0, {}}).first->second;
  to.octets += x.octets;
  to.requests.insert(to.requests.end(), request);
  total_ += x.octets;
  in_flight_.emplace_hint(in_flight_.end(), request, x);
  return request;
}

std::optional<push_window::ticket> push_window::finish(request_id request, bool acknowledged) {
  const auto known = in_flight_.find(request);
  if (known == in_flight_.end())
    return std::nullopt;
  const auto x = known->second;
  in_flight_.erase(known);
  total_ -= x.octets;
  const auto at = hosts_.find(x.host);
  auto& to = at->second;
  to.octets -= x.octets;
  to.requests.erase(request);
  to.window = acknowledged ? std::min(2 * to.window, config_.messages_max) : 1;
  if (to.requests.empty() && to.window == config_.messages_max)
    hosts_.erase(at);
  return x;
}

void push_window::drop(peer_id host) {
  const auto at = hosts_.find(host);
  if (at == hosts_.end())
    return;
  total_ -= at->second.octets;
  for (const auto request : at->second.requests)
    in_flight_.erase(request);
  hosts_.erase(at);
}

} // namespace rubicon::peis
