#include "serial/host_port.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "serial/cable/line_config.hpp"
#include "serial/raw_packet.hpp"

namespace rubicon::serial {

namespace {

/// What the mote may write before an ack: the longest frame that it sends of its own (flags, type,
/// AM header, payload, CRC; a tenth of it escaped).
constexpr std::size_t answer_octets = (am_payload_max + am_header_octets + 6) * 11 / 10;
constexpr std::size_t ack_octets = 9;   ///< half of them escaped
constexpr duration service_time = 10ms; ///< until the mote has seen to a packet

} // namespace

std::string_view to_string(lost_cause x) {
  switch (x) {
  case lost_cause::queue_full:
    return "queue_full";
  case lost_cause::no_ack:
    return "no_ack";
  case lost_cause::too_long:
    return "too_long";
  case lost_cause::malformed:
    return "malformed";
  }
  return "?";
}

std::optional<lost_cause> objection_to(byte_view packet, std::size_t payload_max) {
  if (packet.empty())
    return lost_cause::malformed;
  if (packet.size() > packet_octets_max)
    return lost_cause::too_long;
  const auto message = decode_any_packet(packet);
  if (message)
    return message->payload.size() > payload_max ? std::optional(lost_cause::too_long)
                                                 : std::nullopt;
  if (packet[0] != am_dispatch) // whatever a mote of its kind makes of it
    return {};
  return message.error() == errc::too_long && packet[1 + 4] > am_payload_max
             ? lost_cause::too_long
             : lost_cause::malformed;
}

host_port::host_port(host_port_config config) : config_(config), queue_(config.queue_max) {
  assert(config_.attempts_max >= 1 && config_.attempts_max <= 64 && config_.baud > 0 &&
         config_.window >= 1);
}

outputs host_port::send(packet_id id, bytes packet, instant now) {
  outputs out;
  if (const auto cause = objection_to(packet, config_.payload_max)) {
    ++counters_.refused;
    note_loss(loss::line_failed);
    out.push_back(lost{id, *cause});
  } else if (in_flight_.size() < config_.window) {
    ++counters_.accepted;
    write_attempt(in_flight_.emplace_back(waiting{{id, std::move(packet)}}), now, out);
  } else if (queue_.push({id, std::move(packet)})) {
    ++counters_.accepted;
  } else {
    ++counters_.queue_full;
    note_loss(loss::line_failed);
    out.push_back(lost{id, lost_cause::queue_full});
  }
  return out;
}

outputs host_port::send_urgent(byte_view packet, instant now) {
  assert(!objection_to(packet, config_.payload_max));
  auto wire = encode(frame{frame_type::packet, 0, bytes(packet.begin(), packet.end())});
  line_free_ = std::max(now, line_free_) + on_line(wire.size());
  ++counters_.urgent;
  return {to_line{std::move(wire)}};
}

outputs host_port::on_bytes(byte_view octets, instant now) {
  outputs out;
  for (const auto octet : octets)
    if (auto x = decoder_.on_octet(octet))
      on_frame(std::move(*x), now, out);
  return out;
}

outputs host_port::on_time(instant now) {
  outputs out;
  for (auto x = in_flight_.begin(); x != in_flight_.end();) {
    if (x->due <= now && x->attempts.size() >= config_.attempts_max) {
      patience_.on_silence();
      ++counters_.no_ack;
      note_loss(x->what.from, loss::line_failed);
      out.push_back(lost{x->what.id, lost_cause::no_ack});
      x = in_flight_.erase(x);
      continue;
    }
    if (x->due <= now)
      write_attempt(*x, now, out);
    ++x;
  }
  fill_window(now, out);
  return out;
}

std::optional<instant> host_port::deadline() const {
  std::optional<instant> next;
  for (const auto& x : in_flight_)
    next = earliest(next, x.due);
  return next;
}

void host_port::on_frame(frame x, instant now, outputs& out) {
  switch (x.type) {
  case frame_type::ack:
    on_ack(x.sequence, now, out);
    return;
  case frame_type::packet_with_ack:
    ++counters_.acks_written;
    out.push_back(to_line{encode(frame{frame_type::ack, x.sequence, {}})});
    pass_up(std::move(x.packet), out);
    return;
  case frame_type::packet:
    pass_up(std::move(x.packet), out);
    return;
  case frame_type::unknown:
    ++counters_.unknown_answers;
    return;
  }
}

void host_port::on_ack(std::uint8_t sequence, instant now, outputs& out) {
  for (auto x = in_flight_.begin(); x != in_flight_.end(); ++x) {
    const auto answered = std::ranges::find(x->attempts, sequence, &attempt::sequence);
    if (answered == x->attempts.end())
      continue;
    patience_.on_answer(now - answered->left, answered != x->attempts.begin());
    ++counters_.sent;
    out.push_back(sent{x->what.id});
    in_flight_.erase(x);
    fill_window(now, out);
    return;
  }
  ++counters_.stray_acks;
}

void host_port::pass_up(bytes packet, outputs& out) {
  if (packet.empty()) {
    ++counters_.empty;
    return;
  }
  ++counters_.received;
  out.push_back(received{std::move(packet)});
}

void host_port::write_attempt(waiting& x, instant now, outputs& out) {
  const auto sequence = next_sequence_++;
  auto wire = encode(frame{frame_type::packet_with_ack, sequence, x.what.packet});
  const auto own = on_line(wire.size());
  const auto answer = on_line(answer_octets + ack_octets * config_.window);
  const auto longest =
      std::max(config_.ack_wait, own + answer + 2 * config_.latency + service_time);
  const auto begins = std::max(now, line_free_); // behind what is in flight already
  line_free_ = begins + own;
  x.attempts.push_back({sequence, line_free_});
  x.due = begins + patience_.wait(own, longest, x.attempts.size() == config_.attempts_max);
  ++counters_.attempts;
  out.push_back(to_line{std::move(wire), x.what.from});
}

duration host_port::on_line(std::size_t octets) const {
  return transmission_time(octets, config_.baud);
}

void host_port::fill_window(instant now, outputs& out) {
  while (in_flight_.size() < config_.window && !queue_.empty())
    write_attempt(in_flight_.emplace_back(waiting{queue_.pop()}), now, out);
}

} // namespace rubicon::serial
