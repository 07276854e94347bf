#include "communication/ports/message_port.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "network/am.hpp"

namespace rubicon::communication {

message_port::message_port(local_node& node, program_list& programs,
                           const transport::messenger_config& config, random_stream rng)
    : node_(node), programs_(programs), messages_(config, rng) {}

std::optional<std::uint32_t> message_port::send(std::size_t program, mote_address to,
                                                byte_view octets, bool reliable,
                                                std::uint8_t am_type) {
  using kind = program_note::kind;
  const bool is_valid = to.island.value > 0 && to.mote != mote_id{};
  auto& counters = node_.counters;
  ++counters.offered;
  const acting_on its_copies(begin_message(message_kind::message, node_.address(), to));
  std::optional<transport::outputs> accepted;
  if (!node_.may_send() || !is_valid)
    ++(node_.island ? counters.misaddressed : counters.unjoined);
  else
    accepted = messages_.send(++last_number_, to, am_type, to_bytes(octets), reliable, node_.now);
  const auto number = accepted ? last_number_ : 0;
  programs_.note(program, {kind::sent, {}, number, to, am_type, octets, {}, 0, reliable});
  if (!accepted || !reliable)
    programs_.note(program, {.what = kind::send_ended, .number = number});
  if (!accepted) {
    refuse_message();
    node_.refuse();
    return std::nullopt;
  }
  if (reliable) {
    senders_[number] = program;
    pending_[program].push_back({number, {}});
  }
  apply(*std::move(accepted));
  return number;
}

status message_port::provide(std::size_t program, std::uint8_t am_type) {
  owners_.emplace(am_type, program);
  return owns(program, am_type) ? SUCCESS : node_.refuse();
}

void message_port::hold(std::size_t program, std::uint8_t am_type) {
  if (owns(program, am_type))
    messages_.hold(am_type);
}

void message_port::release(std::size_t program, std::uint8_t am_type) {
  if (owns(program, am_type))
    messages_.release(am_type);
}

bool message_port::owns(std::size_t program, std::uint8_t am_type) const {
  const auto owner = owners_.find(am_type);
  return owner != owners_.end() && owner->second == program;
}

void message_port::attach(std::size_t program) {
  if (!outputs_wanted_.empty())
    notify_outputs_wanted(program);
}

void message_port::leave(std::size_t program) {
  for (const auto am_type : owned(owners_, program)) {
    messages_.release(am_type);
    owners_.erase(am_type);
  }
  for (const auto number : owned(senders_, program))
    senders_.erase(number);
  if (rest_owner_ == program)
    rest_owner_.reset();
  pending_.erase(program);
}

void message_port::on_segment(island_id source, byte_view octets) {
  apply(messages_.on_segment(source, octets, node_.now, [this](std::uint8_t am_type) {
    return rest_owner_ || owners_.contains(am_type) || am_type == network::am::outputs_wanted;
  }));
}

void message_port::on_left() {
  apply(messages_.fail_all());
}

void message_port::on_time() {
  apply(messages_.on_time(node_.now));
}

void message_port::apply(transport::outputs todo) {
  for (auto& x : todo) {
    if (auto* packet = std::get_if<transport::to_network>(&x))
      node_.outputs.emplace_back(std::move(*packet));
    else if (auto* message = std::get_if<transport::received>(&x))
      on_received(*message);
    else
      on_outcome(std::get<transport::outcome>(x));
  }
}

void message_port::on_received(transport::received& x) {
  const bool from_gateway = x.source == mote_address{node_.address().island, no_mote};
  if (x.am_type == network::am::outputs_wanted && from_gateway) {
    note_arrival(message_kind::message, x.source);
    on_outputs_wanted(x);
    return;
  }
  const auto known = owners_.find(x.am_type);
  const auto owner = known == owners_.end() ? rest_owner_ : known->second;
  if (!owner) {
    ++node_.counters.unowned;
    note_loss(loss::no_program);
    return;
  }
  if (known != owners_.end()) // who takes the rest may refuse a message, and notes what it did
    note_arrival(message_kind::message, x.source);
  programs_.note(
      *owner, {program_note::kind::received, {}, 0, x.source, x.am_type, x.payload, {}, 0, false});
  programs_.notify(*owner, [message = std::move(x)](auto& events) {
    events.receiveFrom(message.source, message.payload, message.am_type);
  });
}

void message_port::on_outputs_wanted(const transport::received& x) {
  auto all = decode_outputs_wanted(x.payload);
  if (!all) {
    ++node_.counters.malformed;
    return;
  }
  outputs_wanted_ = *std::move(all);
  for (std::size_t i = 0; i < programs_.size(); ++i)
    notify_outputs_wanted(i);
}

void message_port::notify_outputs_wanted(std::size_t program) {
  programs_.notify(program, [all = outputs_wanted_](auto& x) { x.outputsWanted(all); });
}

void message_port::on_outcome(const transport::outcome& x) {
  const auto sender = senders_.extract(x.id);
  if (!sender)
    return;
  const auto program = *sender;
  const auto number = static_cast<std::uint32_t>(x.id);
  const auto result = status_of(x.acked);
  programs_.note(program,
                 {.what = program_note::kind::send_ended, .number = number, .yes = x.acked});
  programs_.notify(program, [number, result](auto& events) { events.ackOf(number, result); });
  auto& sends = pending_[program];
  std::ranges::find(sends, x.id, &pending_send::number)->acked = x.acked;
  for (; !sends.empty() && sends.front().acked; sends.erase(sends.begin()))
    programs_.notify(
        program, [acked = status_of(*sends.front().acked)](auto& events) { events.ack(acked); });
}

} // namespace rubicon::communication
