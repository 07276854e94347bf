#include "peis/space/tuple_channels.hpp"

#include <cassert>

namespace rubicon::peis {

std::vector<peer_id> tuple_channels::abandon(const key& name) {
  std::vector<peer_id> missing;
  const auto at = followed_.find(name.folded());
  if (at == followed_.end())
    return missing;
  for (const auto& [host, x] : at->second) {
    forget(x);
    if (!x.waiting.empty())
      missing.push_back(host);
  }
  followed_.erase(at);
  return missing;
}

const tuple_channels::channel* tuple_channels::find(const key& name, peer_id subscriber) const {
  const auto at = followed_.find(name.folded());
  if (at == followed_.end())
    return nullptr;
  const auto which = at->second.find(subscriber);
  return which == at->second.end() ? nullptr : &which->second;
}

bool tuple_channels::busy(const key& name, peer_id subscriber) const {
  return find(name, subscriber) != nullptr;
}

bool tuple_channels::full(const key& name, peer_id subscriber, std::size_t octets) const {
  const auto* x = find(name, subscriber);
  return x != nullptr && (x->waiting.size() >= waiting_max_ || octets_ + octets > octets_max_);
}

void tuple_channels::forget(const channel& x) {
  requests_.erase(x.in_flight);
  for (const auto& message : x.waiting)
    octets_ -= message.content.size();
}

transmit tuple_channels::dispatch(const std::string& folded, channel& through, transmit message) {
  through.in_flight = request_id{own_ids_first + requests_made_++};
  requests_.emplace(through.in_flight, std::pair{folded, message.destination});
  message.request = through.in_flight;
  return message;
}

std::optional<transmit> tuple_channels::send(const key& name, transmit message) {
  const auto at = followed_.find(name.folded());
  assert(at != followed_.end());
  const auto [which, idle] = at->second.try_emplace(message.destination);
  if (idle)
    return dispatch(at->first, which->second, std::move(message));
  octets_ += message.content.size();
  which->second.waiting.push_back(std::move(message));
  return std::nullopt;
}

std::optional<transmit> tuple_channels::on_delivered(request_id request) {
  const auto known = requests_.extract(request);
  if (known.empty())
    return std::nullopt;
  const auto& [folded, subscriber] = known.mapped();
  auto& busy_ones = followed_.at(folded);
  const auto which = busy_ones.find(subscriber);
  if (which->second.waiting.empty()) {
    busy_ones.erase(which);
    return std::nullopt;
  }
  auto message = std::move(which->second.waiting.front());
  octets_ -= message.content.size();
  which->second.waiting.pop_front();
  return dispatch(folded, which->second, std::move(message));
}

void tuple_channels::drop_subscriber(peer_id host) {
  for (auto& [folded, busy_ones] : followed_) {
    if (const auto at = busy_ones.find(host); at != busy_ones.end()) {
      forget(at->second);
      busy_ones.erase(at);
    }
  }
}

} // namespace rubicon::peis
