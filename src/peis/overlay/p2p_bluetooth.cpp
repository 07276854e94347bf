// What Bluetooth adapters see becomes hosts to connect to (D1.1 3.1.5.3, BT-05, BT-06).
#include <algorithm>
#include <utility>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

/// A HELLO is to carry who we are.
event event_of(bluetooth::output& x, const bytes& hello) {
  if (auto* scan = std::get_if<scan_adapter>(&x))
    return std::move(*scan);
  if (auto* ask = std::get_if<ask_device>(&x))
    return say_hello{std::move(ask->adapter), ask->address, hello};
  return std::get<device_noted>(std::move(x));
}

} // namespace

void p2p::tell(bluetooth::outputs todo) {
  if (todo.empty())
    return;
  const auto us = hello();
  for (auto& x : todo)
    events_.push_back(event_of(x, us));
}

void p2p::tend_bluetooth(instant now) {
  tell(bluetooth_.on_time(now));
}

void p2p::on_bluetooth_scan(std::string_view adapter, std::span<const seen_device> seen,
                            instant now) {
  if (!left_)
    tell(bluetooth_.on_scan(adapter, seen, now));
}

/// A peer of another network answers as well; its record is of no use to us.
void p2p::on_hello_answer(std::string_view adapter, const bluetooth_address& address,
                          byte_view octets, instant now) {
  if (left_)
    return;
  const bool is_peer = static_cast<bool>(decode_announcement(octets));
  tell(bluetooth_.on_answer(adapter, address, is_peer, now));
  if (is_peer)
    on_announcement(octets, now);
}

bytes p2p::hello() const {
  return encode(announcement{protocol_version, config_.network, self_});
}

std::vector<std::string> p2p::urls_to(const host_record& other) const {
  auto seen = other;
  if (!is_here(other) && other.host_name == self_.host_name)
    seen.host_name.clear(); // as one of another host
  std::erase_if(seen.addresses, [this](const auto& x) { return !may_dial(x); });
  auto own = self_;
  own.addresses = config_.addresses; // a leaf tells others less
  return connectable_urls(own, seen, bluetooth_);
}

/// What others tell is followed into listed networks only.
bool p2p::may_dial(const low_level_address& x) const {
  const auto& networks = config_.connections.networks;
  using kind = low_level_address::kind;
  if (networks.empty() || (x.type != kind::tcp_ipv4 && x.type != kind::udp_ipv4))
    return true;
  const ipv4_address address{x.address[0], x.address[1], x.address[2], x.address[3]};
  return std::ranges::any_of(networks, [&](const auto& each) { return each.contains(address); });
}

bool p2p::may_dial_none(const host_record& x) const {
  return !x.addresses.empty() &&
         std::ranges::none_of(x.addresses, [this](const auto& each) { return may_dial(each); });
}

} // namespace rubicon::peis
