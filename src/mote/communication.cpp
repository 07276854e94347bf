#include "mote/communication.hpp"

#include <limits>
#include <utility>

#include "mote/layer.hpp"
#include "network/am.hpp"

namespace rubicon::mote {

namespace {

constexpr std::uint32_t stream_rate_max_ms = 24 * 60 * 60 * 1000;

/// Types that the layers below use on the radio are theirs everywhere (AM-05).
bool is_reserved(std::uint8_t am_type) {
  return am_type >= network::am::component_management && am_type <= network::am::packet;
}

stream::descriptor stream_of(int desc) {
  const bool is_one = desc > 0 && desc <= std::numeric_limits<std::int16_t>::max();
  return stream::descriptor(is_one ? static_cast<std::uint16_t>(desc) : std::uint16_t{});
}

synaptic::descriptor synaptic_of(int channel) {
  return synaptic::descriptor(stream_of(channel).value);
}

mote_address address_of(island_octet island, std::uint16_t mote) {
  return {island_id(island), mote_id(mote)};
}

} // namespace

template <class Answer>
status layer::take_answer(Answer x) {
  if (x.refused)
    return refuse();
  take(std::move(x.todo));
  return SUCCESS;
}

// 5.3.1

status communication::create_syn_channel_out(std::uint16_t dest, std::uint8_t size,
                                             syn_params params) {
  const auto x = synaptic::parse_parameters(params);
  return create_syn_channel_out({x.island, mote_id(dest)}, size, x) > 0 ? SUCCESS : FAIL;
}

status communication::create_syn_channel_in(std::uint16_t src, std::uint8_t size,
                                            syn_params params) {
  const auto x = synaptic::parse_parameters(params);
  return create_syn_channel_in({x.island, mote_id(src)}, size, x) > 0 ? SUCCESS : FAIL;
}

int communication::create_syn_channel_out(mote_address dest, std::uint8_t size,
                                          const synaptic::parameters& params) {
  return below_->create(process_, true, dest, size, params);
}

int communication::create_syn_channel_in(mote_address src, std::uint8_t size,
                                         const synaptic::parameters& params) {
  return below_->create(process_, false, src, size, params);
}

status communication::dispose_syn_channel(int channel) {
  const auto id = synaptic_of(channel);
  const auto done = below_->take_answer(below_->synaptic_.dispose(id));
  if (done == SUCCESS)
    below_->synaptic_owners_.erase(id);
  return done;
}

status communication::start_syn_channel(int channel) {
  return below_->take_answer(below_->synaptic_.start(synaptic_of(channel)));
}

status communication::stop_syn_channel(int channel) {
  return below_->take_answer(below_->synaptic_.stop(synaptic_of(channel)));
}

status communication::write_output(int channel, std::uint8_t k, float val) {
  return below_->synaptic_.write_output(synaptic_of(channel), k, val) ? below_->refuse() : SUCCESS;
}

float communication::read_input(int channel, std::uint8_t index) {
  return below_->synaptic_.read_input(synaptic_of(channel), index)
      .value_or(std::numeric_limits<float>::quiet_NaN());
}

// 5.3.2

status communication::open_remote(island_octet island_addr, std::uint16_t mote_addr,
                                  std::uint16_t symbolic_name, std::uint32_t stream_rate,
                                  std::uint8_t qos, std::size_t buffer_size) {
  return open_end(false, address_of(island_addr, mote_addr), symbolic_name, stream_rate, qos,
                  buffer_size);
}

status communication::open_write_end(mote_address to, std::uint16_t symbolic_name,
                                     std::uint32_t stream_rate, std::uint8_t qos,
                                     std::size_t buffer_size) {
  return open_end(true, to, symbolic_name, stream_rate, qos, buffer_size);
}

status communication::open_end(bool writes_to_self, mote_address other, std::uint16_t name,
                               std::uint32_t rate_ms, std::uint8_t qos, std::size_t buffer_size) {
  if (!below_->may_talk() || other.island.value == 0 || rate_ms > stream_rate_max_ms)
    return below_->refuse();
  stream::remote_request wish;
  wish.destination = other;
  wish.name = name;
  wish.rate = std::chrono::milliseconds(rate_ms);
  wish.qos = qos;
  wish.buffer_size = buffer_size;
  wish.writes_to_self = writes_to_self;
  auto opened = below_->streams_.open_remote(below_->self(), wish, below_->now_);
  return below_->take_open(process_, std::move(opened)) > 0 ? SUCCESS : FAIL;
}

int communication::open_sensor(std::uint8_t sensor_tid, std::uint32_t stream_rate,
                               stream::sampling sampling_type) {
  const bool is_there =
      sensor_tid < transducers_max && (below_->config_.transducer_mask & (1U << sensor_tid)) != 0;
  if (!is_there || stream_rate > stream_rate_max_ms) {
    below_->refuse();
    return -1;
  }
  stream::sensor_request wish;
  wish.transducer = sensor_tid;
  wish.kind = sampling_type;
  wish.period = std::chrono::milliseconds(stream_rate);
  return below_->take_open(process_, below_->streams_.open_sensor(wish, below_->now_));
}

int communication::open_local() {
  return below_->take_open(process_, below_->streams_.open_local());
}

status communication::close(int desc) {
  const auto id = stream_of(desc);
  const auto done = below_->take_answer(below_->streams_.close(id));
  if (done == SUCCESS)
    below_->stream_owners_.erase(id);
  return done;
}

status communication::read(int desc, std::size_t nbytes) {
  return below_->take_answer(below_->streams_.read(stream_of(desc), nbytes));
}

int communication::write(int desc, byte_view buf) {
  const auto done = below_->take_answer(below_->streams_.write(stream_of(desc), buf));
  return done == SUCCESS ? static_cast<int>(buf.size()) : -1;
}

// 5.3.3

status communication::send(island_octet island_addr, std::uint16_t mote_addr, byte_view buf,
                           bool reliable, std::uint8_t am_type) {
  return send_numbered(address_of(island_addr, mote_addr), buf, reliable, am_type) ? SUCCESS : FAIL;
}

std::optional<std::uint32_t> communication::send_numbered(mote_address to, byte_view buf,
                                                          bool reliable, std::uint8_t am_type) {
  return below_->send(process_, to, buf, reliable, am_type);
}

status communication::provide(std::uint8_t am_type) {
  if (is_reserved(am_type))
    return below_->refuse();
  below_->owners_.emplace(am_type, process_);
  return below_->owns(process_, am_type) ? SUCCESS : below_->refuse();
}

void communication::hold(std::uint8_t am_type) {
  if (below_->owns(process_, am_type))
    below_->messages_.hold(am_type);
}

void communication::release(std::uint8_t am_type) {
  if (below_->owns(process_, am_type))
    below_->messages_.release(am_type);
}

// 5.3.4

status communication::initCommunications() {
  below_->outputs_.emplace_back(init_wanted{});
  return SUCCESS;
}

status communication::joinIsland(byte_view description) {
  if (!below_->initialised_)
    return below_->refuse();
  below_->outputs_.emplace_back(join_wanted{to_bytes(description)});
  return SUCCESS;
}

instant communication::now() const {
  return below_->now_;
}

std::optional<mote_address> communication::address() const {
  if (!below_->island_)
    return std::nullopt;
  return below_->self();
}

} // namespace rubicon::mote
