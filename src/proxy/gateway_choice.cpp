#include "proxy/gateway_choice.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/tuples/device_keys.hpp"

namespace rubicon::proxy {

std::vector<gateway_choice::tuple_change>
gateway_choice::on_tuple(peer_id from, std::string_view key, byte_view value) {
  if (gateways_.size() == 1)
    return {{std::string(key), to_bytes(value), false}};
  const auto found = std::ranges::find(gateways_, from);
  if (found == gateways_.end())
    return {};
  const auto gateway = static_cast<std::size_t>(found - gateways_.begin());
  if (key == device_role_key) {
    const auto leads = parse_device_role(tuple_text(value));
    return leads && *leads && gateway != current_ ? take_lead(gateway)
                                                  : std::vector<tuple_change>{};
  }
  auto& all = known_[from];
  if (all.contains(key) || all.size() < tuples_max)
    all.insert_or_assign(std::string(key), to_bytes(value));
  else
    ++refused_;
  if (gateway != current_)
    return {};
  return {{std::string(key), to_bytes(value), false}};
}

/// Until somebody takes the lead it is as if nothing had happened, if somebody can.
std::vector<gateway_choice::tuple_change> gateway_choice::on_list_deleted(peer_id from) {
  known_.erase(from);
  const bool others = std::ranges::any_of(
      known_, [](const auto& each) { return each.second.contains(devices_key); });
  if (others)
    return {};
  return {{std::string(devices_key), {}, true}};
}

/// Motes before their list, so that those listed are known with all that is said of them.
std::vector<gateway_choice::tuple_change> gateway_choice::take_lead(std::size_t gateway) {
  current_ = gateway;
  std::vector<tuple_change> out;
  const auto& all = known_[current()];
  for (const auto& [key, value] : all) {
    if (key != devices_key)
      out.push_back({key, value, false});
  }
  if (const auto list = all.find(devices_key); list != all.end())
    out.push_back({list->first, list->second, false});
  return out;
}

} // namespace rubicon::proxy
