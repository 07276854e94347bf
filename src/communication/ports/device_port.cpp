#include "communication/ports/device_port.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::communication {

status device_port::read_transducers(std::size_t program, std::span<const device::quantity> kinds) {
  const auto& own = node_.config;
  const bool has_all =
      own.self != no_mote && std::ranges::all_of(kinds, [&own](device::quantity x) {
        return x == device::quantity::signal ||
               has_transducer(own.transducer_mask, static_cast<std::uint8_t>(x));
      });
  if (!has_all)
    return node_.refuse();
  node_.outputs.emplace_back(transducers_wanted{program, {kinds.begin(), kinds.end()}});
  return SUCCESS;
}

status device_port::set_actuator(std::size_t program, std::string_view name, std::uint8_t state) {
  if (node_.config.self == no_mote)
    return node_.refuse();
  node_.outputs.emplace_back(actuator_wanted{program, std::string(name), state});
  return SUCCESS;
}

void device_port::leave(std::size_t program) {
  last_setters_.erase_if([program](const auto& x) { return x.second == program; });
}

void device_port::on_sample(stream::descriptor stream, const stream::sensor_record& x,
                            instant now) {
  node_.now = now;
  streams_.on_sample(stream, x);
}

void device_port::on_transducers(std::size_t program, std::vector<std::int16_t> counts,
                                 std::uint32_t time_ms, instant now) {
  node_.now = now;
  programs_.notify(program, [counts = std::move(counts), time_ms](auto& x) {
    x.transducersRead(counts, time_ms);
  });
}

void device_port::on_actuator(std::size_t program, const std::string& name, std::uint8_t state,
                              bool obeyed, instant now) {
  node_.now = now;
  last_setters_[name] = program;
  programs_.note(program, {.what = program_note::kind::actuator_changed,
                           .actuator = name,
                           .state = state,
                           .yes = obeyed});
  programs_.notify(program, [=](auto& x) { x.actuatorChanged(name, state, obeyed); });
}

void device_port::on_actuator_arrived(const std::string& name, std::uint8_t state, instant now) {
  if (const auto setter = last_setters_.find(name); setter != last_setters_.end())
    on_actuator(setter->second, name, state, true, now);
}

} // namespace rubicon::communication
