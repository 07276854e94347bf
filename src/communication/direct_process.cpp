#include "communication/direct_process.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "communication/layer.hpp"

namespace rubicon::communication {

namespace {

stream::descriptor stream_of(int desc) {
  const bool is_one = desc > 0 && desc <= std::numeric_limits<std::int16_t>::max();
  return stream::descriptor(is_one ? static_cast<std::uint16_t>(desc) : std::uint16_t{});
}

synaptic::descriptor synaptic_of(int channel) {
  return synaptic::descriptor(stream_of(channel).value);
}

/// What belongs to a process.
template <class Owners>
std::vector<typename Owners::key_type> owned(const Owners& owners, std::size_t process) {
  std::vector<typename Owners::key_type> found;
  for (const auto& [key, owner] : owners) {
    if (owner == process)
      found.push_back(key);
  }
  return found;
}

} // namespace

template <class Answer>
status layer::take_answer(Answer x) {
  if (x.refused)
    return refuse();
  take(std::move(x.todo));
  return SUCCESS;
}

status direct_process::refuse() {
  return below_.refuse();
}

bool direct_process::wants_ticks() const {
  return events_ != nullptr && events_->wants_ticks();
}

// Synaptic channels.

int direct_process::create_syn_channel(bool is_out, mote_address other, std::uint8_t size,
                                       const synaptic::parameters& params) {
  return below_.create(number_, is_out, other, size, params);
}

status direct_process::dispose_syn_channel(int channel) {
  const auto id = synaptic_of(channel);
  const auto done = below_.take_answer(below_.synaptic_.dispose(id));
  if (done == SUCCESS)
    below_.synaptic_owners_.erase(id);
  return done;
}

status direct_process::start_syn_channel(int channel) {
  return below_.take_answer(below_.synaptic_.start(synaptic_of(channel)));
}

status direct_process::stop_syn_channel(int channel) {
  return below_.take_answer(below_.synaptic_.stop(synaptic_of(channel)));
}

status direct_process::write_output(int channel, std::uint8_t k, float value) {
  return below_.synaptic_.write_output(synaptic_of(channel), k, value) ? refuse() : SUCCESS;
}

float direct_process::read_input(int channel, std::uint8_t index) {
  return below_.synaptic_.read_input(synaptic_of(channel), index)
      .value_or(std::numeric_limits<float>::quiet_NaN());
}

// Streams.

int direct_process::open_end(const stream_end& end) {
  if (!below_.may_talk()) {
    refuse();
    return -1;
  }
  stream::remote_request x;
  x.destination = end.other;
  x.name = end.name;
  x.rate = std::chrono::milliseconds(end.rate_ms);
  x.qos = end.qos;
  x.buffer_size = end.buffer_size;
  x.writes_to_self = end.writes_to_self;
  const auto slack = below_.messages_.far_slack(x.destination);
  return below_.take_open(number_,
                          below_.streams_.open_remote(below_.self(), x, below_.now_, slack));
}

int direct_process::open_sensor(std::uint8_t transducer, std::uint32_t period_ms,
                                stream::sampling kind) {
  if (!has_transducer(below_.config_.transducer_mask, transducer)) {
    refuse();
    return -1;
  }
  stream::sensor_request x;
  x.transducer = transducer;
  x.kind = kind;
  x.period = std::chrono::milliseconds(period_ms);
  return below_.take_open(number_, below_.streams_.open_sensor(x, below_.now_));
}

int direct_process::open_local() {
  return below_.take_open(number_, below_.streams_.open_local());
}

status direct_process::close(int desc) {
  const auto id = stream_of(desc);
  const auto done = below_.take_answer(below_.streams_.close(id));
  if (done == SUCCESS)
    below_.stream_owners_.erase(id);
  return done;
}

status direct_process::read(int desc, std::size_t nbytes) {
  return below_.take_answer(below_.streams_.read(stream_of(desc), nbytes));
}

status direct_process::write(int desc, byte_view record) {
  return below_.take_answer(below_.streams_.write(stream_of(desc), record, below_.now_));
}

bool direct_process::has_ended(int desc) const {
  return below_.streams_.has_ended(stream_of(desc));
}

std::optional<duration> direct_process::latency_bound(int desc) const {
  return below_.latency_bound(stream_of(desc));
}

// Messages.

std::optional<std::uint32_t> direct_process::send(mote_address to, byte_view octets, bool reliable,
                                                  std::uint8_t am_type) {
  return below_.send(*this, to, octets, reliable, am_type);
}

status direct_process::provide(std::uint8_t am_type) {
  below_.owners_.emplace(am_type, number_);
  return below_.owns(number_, am_type) ? SUCCESS : refuse();
}

void direct_process::hold(std::uint8_t am_type) {
  if (below_.owns(number_, am_type))
    below_.messages_.hold(am_type);
}

void direct_process::release(std::uint8_t am_type) {
  if (below_.owns(number_, am_type))
    below_.messages_.release(am_type);
}

// What the mote carries.

status direct_process::read_transducers(std::span<const device::quantity> kinds) {
  const auto& own = below_.config_;
  const bool has_all =
      own.self != no_mote && std::ranges::all_of(kinds, [&own](device::quantity x) {
        return x == device::quantity::signal ||
               has_transducer(own.transducer_mask, static_cast<std::uint8_t>(x));
      });
  if (!has_all)
    return refuse();
  below_.outputs_.emplace_back(transducers_wanted{number_, {kinds.begin(), kinds.end()}});
  return SUCCESS;
}

status direct_process::set_actuator(std::string_view name, std::uint8_t state) {
  if (below_.config_.self == no_mote)
    return refuse();
  below_.outputs_.emplace_back(actuator_wanted{number_, std::string(name), state});
  return SUCCESS;
}

// Membership.

status direct_process::init() {
  below_.outputs_.emplace_back(init_wanted{});
  return SUCCESS;
}

status direct_process::join(byte_view description) {
  if (!below_.initialised_)
    return refuse();
  below_.outputs_.emplace_back(join_wanted{to_bytes(description)});
  return SUCCESS;
}

std::optional<mote_address> direct_process::address() const {
  if (!below_.island_)
    return std::nullopt;
  return below_.self();
}

instant direct_process::now() const {
  return below_.now_;
}

std::optional<duration> direct_process::network_time() const {
  if (!below_.network_ahead_)
    return std::nullopt;
  return below_.now_.time_since_epoch() + *below_.network_ahead_;
}

void direct_process::leave() {
  for (const auto id : owned(below_.stream_owners_, number_))
    close(id.value);
  for (const auto id : owned(below_.synaptic_owners_, number_))
    dispose_syn_channel(id.value);
  for (const auto am_type : owned(below_.owners_, number_)) {
    below_.messages_.release(am_type);
    below_.owners_.erase(am_type);
  }
  for (const auto number : owned(below_.senders_, number_))
    below_.senders_.erase(number);
  below_.movers_.erase_if([this](const auto& x) { return x.second == number_; });
  if (below_.rest_owner_ == number_)
    below_.rest_owner_.reset();
  std::erase_if(below_.events_, [this](const auto& x) { return x.first == number_; });
  sends_.clear();
  events_ = nullptr;
}

} // namespace rubicon::communication
