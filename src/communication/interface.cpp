#include "communication/interface.hpp"

#include "network/am.hpp"

namespace rubicon::communication {

namespace {

constexpr std::uint32_t stream_rate_max_ms = 24 * 60 * 60 * 1000;

/// Types that the layers below use on the radio are theirs everywhere (AM-05).
bool is_reserved(std::uint8_t am_type) {
  return am_type >= network::am::component_management && am_type <= network::am::outputs_wanted;
}

mote_address address_of(island_octet island, std::uint16_t mote) {
  return {island_id(island), mote_id(mote)};
}

} // namespace

// 5.3.1

status synaptic_interface::create_syn_channel_out(std::uint16_t dest, std::uint8_t size,
                                                  syn_params params) {
  const auto x = synaptic::parse_parameters(params);
  return create_syn_channel_out({x.island, mote_id(dest)}, size, x) > 0 ? SUCCESS : FAIL;
}

status synaptic_interface::create_syn_channel_in(std::uint16_t src, std::uint8_t size,
                                                 syn_params params) {
  const auto x = synaptic::parse_parameters(params);
  return create_syn_channel_in({x.island, mote_id(src)}, size, x) > 0 ? SUCCESS : FAIL;
}

int synaptic_interface::create_syn_channel_out(mote_address dest, std::uint8_t size,
                                               const synaptic::parameters& params) {
  return below_->synaptic.create(true, dest, size, params);
}

int synaptic_interface::create_syn_channel_in(mote_address src, std::uint8_t size,
                                              const synaptic::parameters& params) {
  return below_->synaptic.create(false, src, size, params);
}

status synaptic_interface::dispose_syn_channel(int channel) {
  return below_->synaptic.dispose(channel);
}

status synaptic_interface::start_syn_channel(int channel) {
  return below_->synaptic.start(channel);
}

status synaptic_interface::stop_syn_channel(int channel) {
  return below_->synaptic.stop(channel);
}

status synaptic_interface::write_output(int channel, std::uint8_t k, float val) {
  return below_->synaptic.write_output(channel, k, val);
}

float synaptic_interface::read_input(int channel, std::uint8_t index) {
  return below_->synaptic.read_input(channel, index);
}

// 5.3.2

status stream_interface::open_remote(island_octet island_addr, std::uint16_t mote_addr,
                                     std::uint16_t symbolic_name, std::uint32_t stream_rate,
                                     std::uint8_t qos, std::size_t buffer_size) {
  return open_end({false, address_of(island_addr, mote_addr), symbolic_name, stream_rate, qos,
                   buffer_size}) > 0
             ? SUCCESS
             : FAIL;
}

status stream_interface::open_write_end(mote_address to, std::uint16_t symbolic_name,
                                        std::uint32_t stream_rate, std::uint8_t qos,
                                        std::size_t buffer_size) {
  return open_end({true, to, symbolic_name, stream_rate, qos, buffer_size}) > 0 ? SUCCESS : FAIL;
}

int stream_interface::open_end(const stream_end& end) {
  if (end.other.island.value > 0 && end.rate_ms <= stream_rate_max_ms)
    return below_->streams.open_end(end);
  below_->node.refuse();
  return -1;
}

int stream_interface::open_sensor(std::uint8_t sensor_tid, std::uint32_t stream_rate,
                                  stream::sampling sampling_type) {
  if (stream_rate > stream_rate_max_ms) {
    below_->node.refuse();
    return -1;
  }
  return below_->streams.open_sensor(sensor_tid, stream_rate, sampling_type);
}

int stream_interface::open_local() {
  return below_->streams.open_local();
}

status stream_interface::close(int desc) {
  return below_->streams.close(desc);
}

status stream_interface::read(int desc, std::size_t nbytes) {
  return below_->streams.read(desc, nbytes);
}

int stream_interface::write(int desc, byte_view buf) {
  return below_->streams.write(desc, buf) == SUCCESS ? static_cast<int>(buf.size()) : -1;
}

bool stream_interface::has_ended(int desc) const {
  return below_->streams.has_ended(desc);
}

std::optional<duration> stream_interface::latency_bound(int desc) const {
  return below_->streams.latency_bound(desc);
}

// 5.3.3

status message_interface::send(island_octet island_addr, std::uint16_t mote_addr, byte_view buf,
                               bool reliable, std::uint8_t am_type) {
  return send_numbered(address_of(island_addr, mote_addr), buf, reliable, am_type) ? SUCCESS : FAIL;
}

std::optional<std::uint32_t> message_interface::send_numbered(mote_address to, byte_view buf,
                                                              bool reliable, std::uint8_t am_type) {
  return below_->messages.send(to, buf, reliable, am_type);
}

status message_interface::provide(std::uint8_t am_type) {
  return is_reserved(am_type) ? below_->node.refuse() : below_->messages.provide(am_type);
}

void message_interface::hold(std::uint8_t am_type) {
  below_->messages.hold(am_type);
}

void message_interface::release(std::uint8_t am_type) {
  below_->messages.release(am_type);
}

// What the mote carries.

status device_interface::read_transducers(std::span<const device::quantity> kinds) {
  return below_->node.read_transducers(kinds);
}

status device_interface::set_actuator(std::string_view name, std::uint8_t state) {
  return below_->node.set_actuator(name, state);
}

// 5.3.4

status interface::initCommunications() {
  return below_->node.init();
}

status interface::joinIsland(byte_view description) {
  return below_->node.join(description);
}

instant interface::now() const {
  return below_->node.now();
}

std::optional<duration> interface::network_time() const {
  return below_->node.network_time();
}

std::optional<mote_address> interface::address() const {
  return below_->node.address();
}

void interface::leave() {
  below_->node.leave();
}

} // namespace rubicon::communication
