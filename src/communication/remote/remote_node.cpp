#include "communication/remote/remote_node.hpp"

#include <string>

namespace rubicon::communication {

status remote_node::read_transducers(std::span<const device::quantity> kinds) {
  if (!exchange_.has_room())
    return exchange_.refuse();
  exchange_.command(remote::read_transducers{{kinds.begin(), kinds.end()}});
  return SUCCESS;
}

status remote_node::set_actuator(std::string_view name, std::uint8_t state) {
  if (!exchange_.has_room())
    return exchange_.refuse();
  exchange_.command(remote::set_actuator{std::string(name), state});
  return SUCCESS;
}

void remote_node::apply(const remote::transducers_read& x) {
  exchange_.notify([x](auto& y) { y.transducersRead(x.counts, x.time_ms); });
}

void remote_node::apply(const remote::actuator_changed& x) {
  exchange_.notify([x](auto& y) { y.actuatorChanged(x.name, x.state, x.obeyed); });
}

// Membership.

status remote_node::init() {
  if (!exchange_.has_room())
    return exchange_.refuse();
  exchange_.command(remote::init{});
  return SUCCESS;
}

status remote_node::join(byte_view description) {
  if (!initialised_ || !exchange_.has_room())
    return exchange_.refuse();
  exchange_.command(remote::join{payload(to_bytes(description))});
  return SUCCESS;
}

void remote_node::leave() {
  exchange_.set_program(nullptr);
  exchange_.clear_events();
  exchange_.command(remote::leave{});
}

void remote_node::apply(const remote::initialised& x) {
  initialised_ = x.success;
  exchange_.notify(
      [success = x.success](auto& y) { y.initCommunicationsDone(status_of(success)); });
}

void remote_node::apply(const remote::joined& x) {
  exchange_.set_address(x.success ? std::optional(x.self) : std::nullopt);
  exchange_.notify(
      [x](auto& y) { y.joined(octet_of(x.self.island), x.self.mote.value, status_of(x.success)); });
}

void remote_node::apply(const remote::mote_joined& x) {
  exchange_.notify([x](auto& y) { y.moteJoined(x.mote.value, x.description.view()); });
}

void remote_node::apply(const remote::outputs_asked& x) {
  exchange_.notify([x](auto& y) { y.outputsWanted(x.all); });
}

} // namespace rubicon::communication
