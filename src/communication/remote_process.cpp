#include "communication/remote_process.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace rubicon::communication {

remote_process::~remote_process() = default;

interface remote_process::attach(communication_events& program) {
  program_ = &program;
  if (program.wants_ticks())
    commands_.emplace_back(remote::want_ticks{});
  return interface(*this);
}

std::size_t remote_process::commands_in_flight() const {
  return static_cast<std::size_t>(sent_ - sent_taken_) + commands_.size();
}

std::optional<remote::commands_batch> remote_process::flush() {
  dispatch();
  order_holds();
  if (commands_.empty() && events_acked_ == events_)
    return std::nullopt;
  sent_ += commands_.size();
  events_acked_ = events_;
  return remote::commands_batch{events_, std::exchange(commands_, {})};
}

/// As at the node, events reach the program when the state is complete.
void remote_process::on_events(const remote::events_batch& x, instant now) {
  now_ = now;
  sent_taken_ = std::min(x.taken, sent_);
  events_ += x.all.size();
  for (const auto& each : x.all)
    std::visit([this](const auto& y) { apply(y); }, each);
  dispatch();
}

void remote_process::dispatch() {
  if (std::exchange(dispatching_, true))
    return;
  for (; !pending_events_.empty() && program_ != nullptr; pending_events_.pop_front())
    pending_events_.front()(*program_);
  pending_events_.clear();
  dispatching_ = false;
}

status remote_process::refuse() {
  ++counters_.refused;
  return FAIL;
}

bool remote_process::may_talk() {
  if (self_)
    return true;
  ++counters_.before_join;
  return false;
}

bool remote_process::has_room() {
  if (commands_in_flight() < commands_max_)
    return true;
  ++counters_.no_room;
  return false;
}

mote_address remote_process::resolved(mote_address x, island_id own) const {
  if (x.island == own_island)
    x.island = own == own_island ? self_->island : own;
  if (x.mote == own_mote)
    x.mote = self_->mote;
  return x;
}

// Synaptic channels.

int remote_process::create_syn_channel(bool is_out, mote_address other, std::uint8_t size,
                                       const synaptic::parameters& params) {
  const auto is_equal = [&, to = self_ ? resolved(other, params.island) : other](const auto& x) {
    return x.second.is_out == is_out && x.second.other == to && x.second.at != phase::ended;
  };
  const auto used = std::ranges::count_if(
      channels_, [is_out](const auto& x) { return x.second.is_out == is_out; });
  if (!may_talk() || other.mote == broadcast_mote || size == 0 || size > node_.vector_max ||
      std::ranges::any_of(channels_, is_equal) || used >= node_.channels_max || !has_room()) {
    refuse();
    return -1;
  }
  channel_row row;
  row.is_out = is_out;
  row.other = resolved(other, params.island);
  row.values.resize(size);
  const auto id = add(channels_, last_channel_, std::move(row));
  commands_.emplace_back(remote::create_channel{id, is_out, other, size, params});
  return id;
}

void remote_process::report_created(std::uint16_t channel, bool is_out, bool success) {
  pending_events_.emplace_back([=](auto& x) {
    if (is_out)
      x.createSynChannelOutDone(channel, status_of(success));
    else
      x.createSynChannelInDone(channel, status_of(success));
  });
}

status remote_process::dispose_syn_channel(int channel) {
  const auto* x = find(channels_, channel);
  if (x == nullptr)
    return refuse();
  const auto id = static_cast<std::uint16_t>(channel);
  if (x->at == phase::opening)
    report_created(id, x->is_out, false);
  channels_.erase(id);
  commands_.emplace_back(remote::dispose_channel{id});
  return SUCCESS;
}

remote_process::channel_row* remote_process::open_channel(int channel, bool is_out) {
  auto* x = find(channels_, channel);
  return x != nullptr && x->is_out == is_out && x->at == phase::open ? x : nullptr;
}

status remote_process::start_syn_channel(int channel) {
  auto* x = open_channel(channel, true);
  if (x == nullptr || !has_room())
    return refuse();
  x->is_active = true;
  commands_.emplace_back(remote::start_channel{static_cast<std::uint16_t>(channel)});
  return SUCCESS;
}

status remote_process::stop_syn_channel(int channel) {
  auto* x = open_channel(channel, true);
  if (x == nullptr || !x->is_active || !has_room())
    return refuse();
  x->is_active = false;
  commands_.emplace_back(remote::stop_channel{static_cast<std::uint16_t>(channel)});
  return SUCCESS;
}

/// Elements that are written one after the other make one command.
status remote_process::write_output(int channel, std::uint8_t k, float value) {
  auto* x = open_channel(channel, true);
  if (x == nullptr || k >= x->values.size())
    return refuse();
  auto* last = commands_.empty() ? nullptr : std::get_if<remote::set_outputs>(&commands_.back());
  const bool goes_on = last != nullptr && last->channel == channel;
  if (!goes_on && !has_room())
    return refuse();
  x->values[k] = value;
  if (goes_on)
    last->values[k] = value;
  else
    commands_.emplace_back(remote::set_outputs{static_cast<std::uint16_t>(channel), x->values});
  return SUCCESS;
}

float remote_process::read_input(int channel, std::uint8_t index) {
  const auto* x = open_channel(channel, false);
  if (x != nullptr && index < x->values.size())
    return x->values[index];
  ++counters_.bad_reads;
  return std::numeric_limits<float>::quiet_NaN();
}

void remote_process::apply(const remote::channel_created& x) {
  auto* row = find(channels_, x.channel);
  if (row == nullptr) // disposed of in the meantime, and reported
    return;
  if (x.success)
    row->at = phase::open;
  else
    channels_.erase(x.channel);
  report_created(x.channel, x.is_out, x.success);
}

void remote_process::apply(const remote::inputs_shown& x) {
  auto* row = find(channels_, x.channel);
  if (row == nullptr || row->values.size() != x.values.size())
    return;
  row->values = x.values;
  const auto how = x.updated ? synaptic::input_status::updated : synaptic::input_status::missed;
  for (std::size_t i = 0; i < x.values.size(); ++i)
    pending_events_.emplace_back([channel = x.channel, i, how](auto& y) {
      y.syn_input_update(channel, static_cast<std::uint8_t>(i), how);
    });
}

void remote_process::apply(const remote::channel_failed& x) {
  auto* row = find(channels_, x.channel);
  if (row == nullptr)
    return;
  row->at = phase::ended;
  row->is_active = false;
  pending_events_.emplace_back([channel = x.channel](auto& y) { y.synChannelFailed(channel); });
}

void remote_process::apply(const remote::ticked& x) {
  pending_events_.emplace_back([tick = x.tick](auto& y) { y.clock_tick(tick); });
}

// Messages.

std::optional<std::uint32_t> remote_process::send(mote_address to, byte_view octets, bool reliable,
                                                  std::uint8_t am_type) {
  const bool is_valid = to.island.value > 0 && to.mote != mote_id{} &&
                        octets.size() <= node_.payload_max &&
                        !(reliable && to.mote == broadcast_mote);
  if (!may_talk() || !is_valid || (reliable && sends_.size() >= node_.sends_max) || !has_room()) {
    refuse();
    return std::nullopt;
  }
  const auto number = ++last_number_;
  if (reliable)
    sends_.push_back({number, {}});
  commands_.emplace_back(
      remote::send_message{number, to, payload(to_bytes(octets)), reliable, am_type});
  return number;
}

status remote_process::provide(std::uint8_t am_type) {
  if (types_.contains(am_type))
    return SUCCESS;
  if (!has_room())
    return refuse();
  types_.insert(am_type);
  commands_.emplace_back(remote::provide_type{am_type});
  return SUCCESS;
}

void remote_process::hold(std::uint8_t am_type) {
  if (types_.contains(am_type))
    held_.insert(am_type);
}

void remote_process::release(std::uint8_t am_type) {
  held_.erase(am_type);
}

/// Holds are sent to the node last, so that these commands need no room.
void remote_process::order_holds() {
  for (const auto x : types_) {
    const bool holds = held_.contains(x);
    if (holds == held_at_node_.contains(x))
      continue;
    commands_.emplace_back(remote::hold_type{x, holds});
    if (holds)
      held_at_node_.insert(x);
    else
      held_at_node_.erase(x);
  }
}

void remote_process::apply(const remote::send_ended& x) {
  const auto found = std::ranges::find(sends_, x.number, &pending_send::number);
  if (found == sends_.end())
    return;
  found->acked = x.acked;
  pending_events_.emplace_back([x](auto& y) { y.ackOf(x.number, status_of(x.acked)); });
  for (; !sends_.empty() && sends_.front().acked; sends_.pop_front())
    pending_events_.emplace_back(
        [acked = *sends_.front().acked](auto& y) { y.ack(status_of(acked)); });
}

void remote_process::apply(const remote::message_received& x) {
  pending_events_.emplace_back(
      [x](auto& y) { y.receiveFrom(x.source, x.octets.view(), x.am_type); });
}

void remote_process::apply(const remote::type_refused& x) {
  types_.erase(x.am_type);
  held_.erase(x.am_type);
  held_at_node_.erase(x.am_type);
  pending_events_.emplace_back(
      [am_type = x.am_type](auto& y) { y.receive(0, 0, {}, am_type, FAIL); });
}

// What the mote carries.

status remote_process::read_transducers(std::span<const device::quantity> kinds) {
  if (!has_room())
    return refuse();
  commands_.emplace_back(remote::read_transducers{{kinds.begin(), kinds.end()}});
  return SUCCESS;
}

status remote_process::set_actuator(std::string_view name, std::uint8_t state) {
  if (!has_room())
    return refuse();
  commands_.emplace_back(remote::set_actuator{std::string(name), state});
  return SUCCESS;
}

void remote_process::apply(const remote::transducers_read& x) {
  pending_events_.emplace_back([x](auto& y) { y.transducersRead(x.counts, x.time_ms); });
}

void remote_process::apply(const remote::actuator_changed& x) {
  pending_events_.emplace_back([x](auto& y) { y.actuatorChanged(x.name, x.state, x.obeyed); });
}

// Membership.

status remote_process::init() {
  if (!has_room())
    return refuse();
  commands_.emplace_back(remote::init{});
  return SUCCESS;
}

status remote_process::join(byte_view description) {
  if (!initialised_ || !has_room())
    return refuse();
  commands_.emplace_back(remote::join{payload(to_bytes(description))});
  return SUCCESS;
}

void remote_process::leave() {
  program_ = nullptr;
  pending_events_.clear();
  commands_.emplace_back(remote::leave{});
}

void remote_process::apply(const remote::initialised& x) {
  initialised_ = x.success;
  pending_events_.emplace_back(
      [success = x.success](auto& y) { y.initCommunicationsDone(status_of(success)); });
}

void remote_process::apply(const remote::joined& x) {
  self_ = x.success ? std::optional(x.self) : std::nullopt;
  pending_events_.emplace_back(
      [x](auto& y) { y.joined(octet_of(x.self.island), x.self.mote.value, status_of(x.success)); });
}

void remote_process::apply(const remote::mote_joined& x) {
  pending_events_.emplace_back([x](auto& y) { y.moteJoined(x.mote.value, x.description.view()); });
}

void remote_process::apply(const remote::outputs_asked& x) {
  pending_events_.emplace_back([x](auto& y) { y.outputsWanted(x.all); });
}

} // namespace rubicon::communication
