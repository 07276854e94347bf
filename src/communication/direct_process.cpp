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

status direct_process::refuse() {
  return ports_.node.refuse();
}

// Synaptic channels.

int direct_process::create_syn_channel(bool is_out, mote_address other, std::uint8_t size,
                                       const synaptic::parameters& params) {
  return ports_.synaptic.create(program_, is_out, other, size, params);
}

status direct_process::dispose_syn_channel(int channel) {
  return ports_.synaptic.dispose(synaptic_of(channel));
}

status direct_process::start_syn_channel(int channel) {
  return ports_.synaptic.start(synaptic_of(channel));
}

status direct_process::stop_syn_channel(int channel) {
  return ports_.synaptic.stop(synaptic_of(channel));
}

status direct_process::write_output(int channel, std::uint8_t k, float value) {
  return ports_.synaptic.write_output(synaptic_of(channel), k, value);
}

float direct_process::read_input(int channel, std::uint8_t index) {
  return ports_.synaptic.read_input(synaptic_of(channel), index);
}

// Streams.

int direct_process::open_end(const stream_end& end) {
  return ports_.streams.open_end(program_, end);
}

int direct_process::open_sensor(std::uint8_t transducer, std::uint32_t period_ms,
                                stream::sampling kind) {
  return ports_.streams.open_sensor(program_, transducer, period_ms, kind);
}

int direct_process::open_local() {
  return ports_.streams.open_local(program_);
}

status direct_process::close(int desc) {
  return ports_.streams.close(stream_of(desc));
}

status direct_process::read(int desc, std::size_t nbytes) {
  return ports_.streams.read(stream_of(desc), nbytes);
}

status direct_process::write(int desc, byte_view record) {
  return ports_.streams.write(stream_of(desc), record);
}

bool direct_process::has_ended(int desc) const {
  return ports_.streams.core().has_ended(stream_of(desc));
}

std::optional<duration> direct_process::latency_bound(int desc) const {
  return ports_.streams.latency_bound(stream_of(desc));
}

// Messages.

std::optional<std::uint32_t> direct_process::send(mote_address to, byte_view octets, bool reliable,
                                                  std::uint8_t am_type) {
  return ports_.messages.send(program_, to, octets, reliable, am_type);
}

status direct_process::provide(std::uint8_t am_type) {
  return ports_.messages.provide(program_, am_type);
}

void direct_process::hold(std::uint8_t am_type) {
  ports_.messages.hold(program_, am_type);
}

void direct_process::release(std::uint8_t am_type) {
  ports_.messages.release(program_, am_type);
}

// What the mote carries.

status direct_process::read_transducers(std::span<const device::quantity> kinds) {
  return ports_.devices.read_transducers(program_, kinds);
}

status direct_process::set_actuator(std::string_view name, std::uint8_t state) {
  return ports_.devices.set_actuator(program_, name, state);
}

// Membership.

status direct_process::init() {
  ports_.node.outputs.emplace_back(init_wanted{});
  return SUCCESS;
}

status direct_process::join(byte_view description) {
  if (!ports_.node.initialised)
    return refuse();
  ports_.node.outputs.emplace_back(join_wanted{to_bytes(description)});
  return SUCCESS;
}

std::optional<mote_address> direct_process::address() const {
  if (!ports_.node.island)
    return std::nullopt;
  return ports_.node.address();
}

instant direct_process::now() const {
  return ports_.node.now;
}

std::optional<duration> direct_process::network_time() const {
  const auto& node = ports_.node;
  if (!node.network_ahead)
    return std::nullopt;
  return node.now.time_since_epoch() + *node.network_ahead;
}

void direct_process::leave() {
  ports_.streams.leave(program_);
  ports_.synaptic.leave(program_);
  ports_.messages.leave(program_);
  ports_.devices.leave(program_);
  ports_.programs.detach(program_);
}

} // namespace rubicon::communication
