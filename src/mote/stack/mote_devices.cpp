#include "mote/stack/mote_devices.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::mote {

mote_devices::mote_devices(shared_list<device::transducer_config> transducers,
                           const shared_list<device::actuator_config>& actuators,
                           device::reader who)
    : transducers_(std::move(transducers)), who_(who) {
  for (const auto& x : actuators)
    actuators_.emplace(x.name, device::actuator(x));
}

std::optional<std::int16_t> mote_devices::read(device::quantity kind, instant now,
                                               random_stream& rng) const {
  if (kind == device::quantity::signal)
    return parent_dbm_;
  const auto found = std::ranges::find(transducers_, kind, &device::transducer_config::kind);
  if (found == transducers_.end())
    return std::nullopt;
  return sample(*found, now, rng, who_);
}

std::optional<std::uint8_t> mote_devices::state(const std::string& name, instant now) const {
  const auto found = actuators_.find(name);
  if (found == actuators_.end())
    return std::nullopt;
  return found->second.state(now);
}

bool mote_devices::set(const std::string& name, std::uint8_t target, instant now) {
  const auto found = actuators_.find(name);
  return found != actuators_.end() && found->second.set(target, now);
}

std::vector<actuator_arrived> mote_devices::on_time(instant now) {
  std::vector<actuator_arrived> arrived;
  for (auto& [name, x] : actuators_) {
    if (x.on_time(now))
      arrived.push_back({name, x.target()});
  }
  return arrived;
}

std::optional<instant> mote_devices::deadline() const {
  std::optional<instant> due;
  for (const auto& [name, x] : actuators_)
    due = earliest(due, x.deadline());
  return due;
}

} // namespace rubicon::mote
