#include "peis/bluetooth/bluetooth.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr duration first_scan_after = 1s; // who starts at the same time is there by then

/// With `-` instead of colons: keys have none in configuration files.
std::string key_of(std::string_view adapter, const bluetooth_address& address,
                   std::string_view what) {
  auto text = to_string(address);
  std::replace(text.begin(), text.end(), ':', '-');
  return "kernel." + std::string(adapter) + '.' + text + '.' + std::string(what);
}

} // namespace

bool has_bluetooth() {
  return true;
}

bluetooth::bluetooth(bluetooth_config config, instant now)
    : config_(std::move(config)), next_scan_(now + first_scan_after) {
  for (const auto& adapter : config_.adapters)
    adapters_[adapter];
}

bluetooth::outputs bluetooth::on_time(instant now) {
  outputs out;
  if (adapters_.empty())
    return out;
  for (auto& [adapter, devices] : adapters_) {
    for (auto& [address, x] : devices) {
      if (x.asked_until && *x.asked_until <= now)
        settle(adapter, address, x, false, now, out);
    }
  }
  if (now < next_scan_)
    return out;
  next_scan_ = now + config_.scan_period;
  for (const auto& [adapter, devices] : adapters_)
    out.emplace_back(scan_adapter{adapter});
  return out;
}

std::optional<instant> bluetooth::deadline() const {
  if (adapters_.empty())
    return std::nullopt;
  auto next = next_scan_;
  for (const auto& [adapter, devices] : adapters_) {
    for (const auto& [address, x] : devices)
      next = std::min(next, x.asked_until.value_or(next));
  }
  return next;
}

bluetooth::outputs bluetooth::on_scan(std::string_view adapter, std::span<const seen_device> seen,
                                      instant now) {
  outputs out;
  const auto found = adapters_.find(adapter);
  if (found == adapters_.end())
    return out;
  auto& [name, devices] = *found;
  for (auto x = devices.begin(); x != devices.end();) {
    if (std::ranges::find(seen, x->first, &seen_device::address) != seen.end()) {
      ++x;
      continue;
    }
    out.emplace_back(device_noted{key_of(name, x->first, "str"), std::nullopt});
    if (x->second.standing != standing::unknown)
      out.emplace_back(device_noted{key_of(name, x->first, "peis"), std::nullopt});
    x = devices.erase(x);
  }
  for (const auto& each : seen) {
    const bool known = devices.contains(each.address);
    if (!known && devices.size() >= config_.devices_max) {
      ++passed_over_;
      continue;
    }
    auto& x = devices[each.address];
    if (std::exchange(x.strength_dbm, each.strength_dbm) != each.strength_dbm || !known)
      out.emplace_back(
          device_noted{key_of(name, each.address, "str"), std::to_string(each.strength_dbm)});
    ask(name, each.address, x, now, out);
  }
  return out;
}

/// If it is strong enough and due.
void bluetooth::ask(const std::string& adapter, const bluetooth_address& address, device& x,
                    instant now, outputs& out) const {
  const bool waits = x.standing == standing::no_peer && now < x.next_hello;
  if (x.strength_dbm < config_.threshold_dbm || x.asked_until || waits)
    return;
  x.asked_until = now + config_.hello_timeout;
  out.emplace_back(ask_device{adapter, address});
}

bluetooth::outputs bluetooth::on_answer(std::string_view adapter, const bluetooth_address& address,
                                        bool is_peer, instant now) {
  outputs out;
  const auto found = adapters_.find(adapter);
  if (found == adapters_.end())
    return out;
  const auto known = found->second.find(address);
  if (known != found->second.end() && (is_peer || known->second.asked_until))
    settle(found->first, address, known->second, is_peer, now, out);
  return out;
}

void bluetooth::settle(const std::string& adapter, const bluetooth_address& address, device& x,
                       bool is_peer, instant now, outputs& out) const {
  x.asked_until.reset();
  if (!is_peer)
    x.next_hello = now + config_.hello_retry;
  const auto result = is_peer ? standing::peer : standing::no_peer;
  if (std::exchange(x.standing, result) != result)
    out.emplace_back(device_noted{key_of(adapter, address, "peis"), is_peer ? "yes" : "no"});
}

bool bluetooth::is_connectable(const bluetooth_address& address) const {
  return std::ranges::any_of(adapters_, [&](const auto& adapter) {
    const auto x = adapter.second.find(address);
    return x != adapter.second.end() && x->second.standing == standing::peer &&
           x->second.strength_dbm >= config_.threshold_dbm;
  });
}

std::optional<bluetooth::standing> bluetooth::standing_of(std::string_view adapter,
                                                          const bluetooth_address& address) const {
  const auto found = adapters_.find(adapter);
  if (found == adapters_.end())
    return std::nullopt;
  const auto x = found->second.find(address);
  return x == found->second.end() ? std::nullopt : std::optional(x->second.standing);
}

} // namespace rubicon::peis
