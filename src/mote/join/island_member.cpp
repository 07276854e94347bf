#include "mote/join/island_member.hpp"

namespace rubicon::mote {

bool island_member::takes_start(instant now) {
  if (!starts_at_ || *starts_at_ > now)
    return false;
  starts_at_.reset();
  return true;
}

join_outputs island_member::leave() {
  waits_for_route_ = false;
  starts_at_.reset();
  return client_.leave();
}

void island_member::on_joined(const island_joined& x) {
  island_ = x.island;
  gateways_ = {gateway_of(island_)};
  for (const auto alias : x.aliases)
    gateways_.push_back(gateway_of(alias));
}

join_outputs island_member::on_battery_low(instant now) {
  condition_.battery_low = true;
  return client_.report(condition_, now);
}

/// The signal of its parent shows that a mote is carried away long before frames get lost: then it
/// is too late to report it.
std::optional<join_outputs> island_member::on_signal(int rssi_dbm, instant now) {
  constexpr int weak_below_dbm =
      -88; // radios receive down to -95 dBm at least (docs/tinyos.md 7.1)
  constexpr int strong_from_dbm = -84;
  const bool is_weak = rssi_dbm < (condition_.links_weak ? strong_from_dbm : weak_below_dbm);
  if (is_weak == condition_.links_weak)
    return std::nullopt;
  condition_.links_weak = is_weak;
  return client_.report(condition_, now);
}

} // namespace rubicon::mote
