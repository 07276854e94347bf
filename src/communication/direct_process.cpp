#include "communication/direct_process.hpp"

#include <limits>

#include "communication/ports/layer_ports.hpp"

namespace rubicon::communication {

namespace {

stream::descriptor stream_of(int desc) {
  const bool is_one = desc > 0 && desc <= std::numeric_limits<std::int16_t>::max();
  return stream::descriptor(is_one ? static_cast<std::uint16_t>(desc) : std::uint16_t{});
}

synaptic::descriptor synaptic_of(int channel) {
  return synaptic::descriptor(stream_of(channel).value);
}

} // namespace

// Synaptic channels.

int direct_synaptic::create(bool is_out, mote_address other, std::uint8_t size,
                            const synaptic::parameters& params) {
  return its_.ports.synaptic.create(its_.number, is_out, other, size, params);
}

status direct_synaptic::dispose(int channel) {
  return its_.ports.synaptic.dispose(synaptic_of(channel));
}

status direct_synaptic::start(int channel) {
  return its_.ports.synaptic.start(synaptic_of(channel));
}

status direct_synaptic::stop(int channel) {
  return its_.ports.synaptic.stop(synaptic_of(channel));
}

status direct_synaptic::write_output(int channel, std::uint8_t k, float value) {
  return its_.ports.synaptic.write_output(synaptic_of(channel), k, value);
}

float direct_synaptic::read_input(int channel, std::uint8_t index) {
  return its_.ports.synaptic.read_input(synaptic_of(channel), index);
}

// Streams.

int direct_streams::open_end(const stream_end& end) {
  return its_.ports.streams.open_end(its_.number, end);
}

int direct_streams::open_sensor(std::uint8_t transducer, std::uint32_t period_ms,
                                stream::sampling kind) {
  return its_.ports.streams.open_sensor(its_.number, transducer, period_ms, kind);
}

int direct_streams::open_local() {
  return its_.ports.streams.open_local(its_.number);
}

status direct_streams::close(int desc) {
  return its_.ports.streams.close(stream_of(desc));
}

status direct_streams::read(int desc, std::size_t nbytes) {
  return its_.ports.streams.read(stream_of(desc), nbytes);
}

status direct_streams::write(int desc, byte_view record) {
  return its_.ports.streams.write(stream_of(desc), record);
}

bool direct_streams::has_ended(int desc) const {
  return its_.ports.streams.core().has_ended(stream_of(desc));
}

std::optional<duration> direct_streams::latency_bound(int desc) const {
  return its_.ports.streams.latency_bound(stream_of(desc));
}

// Messages.

std::optional<std::uint32_t> direct_messages::send(mote_address to, byte_view octets, bool reliable,
                                                   std::uint8_t am_type) {
  return its_.ports.messages.send(its_.number, to, octets, reliable, am_type);
}

status direct_messages::provide(std::uint8_t am_type) {
  return its_.ports.messages.provide(its_.number, am_type);
}

void direct_messages::hold(std::uint8_t am_type) {
  its_.ports.messages.hold(its_.number, am_type);
}

void direct_messages::release(std::uint8_t am_type) {
  its_.ports.messages.release(its_.number, am_type);
}

// What the mote carries.

status direct_node::refuse() {
  return its_.ports.node.refuse();
}

status direct_node::read_transducers(std::span<const device::quantity> kinds) {
  return its_.ports.devices.read_transducers(its_.number, kinds);
}

status direct_node::set_actuator(std::string_view name, std::uint8_t state) {
  return its_.ports.devices.set_actuator(its_.number, name, state);
}

// Membership.

status direct_node::init() {
  its_.ports.node.outputs.emplace_back(init_wanted{});
  return SUCCESS;
}

status direct_node::join(byte_view description) {
  if (!its_.ports.node.initialised)
    return refuse();
  its_.ports.node.outputs.emplace_back(join_wanted{to_bytes(description)});
  return SUCCESS;
}

std::optional<mote_address> direct_node::address() const {
  if (!its_.ports.node.island)
    return std::nullopt;
  return its_.ports.node.address();
}

instant direct_node::now() const {
  return its_.ports.node.now;
}

std::optional<duration> direct_node::network_time() const {
  const auto& node = its_.ports.node;
  if (!node.network_ahead)
    return std::nullopt;
  return node.now.time_since_epoch() + *node.network_ahead;
}

void direct_node::leave() {
  its_.ports.streams.leave(its_.number);
  its_.ports.synaptic.leave(its_.number);
  its_.ports.messages.leave(its_.number);
  its_.ports.devices.leave(its_.number);
  its_.ports.programs.detach(its_.number);
}

} // namespace rubicon::communication
