#include "serial/endpoint.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::serial {

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

endpoint::endpoint(endpoint_config config)
    : config_(config), patience_(config.ack_wait), queue_(config.queue_max) {
  assert(config_.attempts_max >= 1 && config_.attempts_max <= 64);
}

outputs endpoint::send(packet_id id, bytes packet, instant now) {
  outputs out;
  if (const auto cause = objection(packet)) {
    ++counters_.refused;
    out.push_back(lost{id, *cause});
  } else if (current() == state::idle) {
    ++counters_.accepted;
    start({id, std::move(packet)}, now, out);
  } else if (queue_.push({id, std::move(packet)})) {
    ++counters_.accepted;
  } else {
    ++counters_.queue_full;
    out.push_back(lost{id, lost_cause::queue_full});
  }
  return out;
}

outputs endpoint::on_bytes(byte_view octets, instant now) {
  outputs out;
  for (const auto octet : octets)
    if (auto x = decoder_.on_octet(octet))
      on_frame(std::move(*x), now, out);
  return out;
}

outputs endpoint::on_time(instant now) {
  outputs out;
  if (!deadline_ || now < *deadline_)
    return out;
  if (attempts_.size() < config_.attempts_max) {
    write_attempt(now, out);
    return out;
  }
  patience_.on_silence();
  ++counters_.no_ack;
  out.push_back(lost{current_.id, lost_cause::no_ack});
  next(now, out);
  return out;
}

std::optional<lost_cause> endpoint::objection(byte_view packet) const {
  if (packet.empty())
    return lost_cause::malformed;
  if (packet.size() > packet_octets_max)
    return lost_cause::too_long;
  if (packet[0] != am_dispatch)
    return {};
  const auto message = decode_am_packet(packet);
  if (message)
    return message->payload.size() > config_.payload_max ? std::optional(lost_cause::too_long)
                                                         : std::nullopt;
  return message.error() == errc::too_long && packet[1 + 4] > am_payload_max
             ? lost_cause::too_long
             : lost_cause::malformed;
}

void endpoint::on_frame(frame x, instant now, outputs& out) {
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

void endpoint::on_ack(std::uint8_t sequence, instant now, outputs& out) {
  const auto answered = std::find_if(attempts_.begin(), attempts_.end(),
                                     [&](const attempt& x) { return x.sequence == sequence; });
  if (answered == attempts_.end()) {
    ++counters_.stray_acks;
    return;
  }
  patience_.on_answer(now - answered->written, answered != attempts_.begin());
  ++counters_.sent;
  out.push_back(sent{current_.id});
  next(now, out);
}

void endpoint::pass_up(bytes packet, outputs& out) {
  if (packet.empty()) {
    ++counters_.empty;
    return;
  }
  ++counters_.received;
  out.push_back(received{std::move(packet)});
}

void endpoint::start(outgoing x, instant now, outputs& out) {
  current_ = std::move(x);
  attempts_.clear();
  write_attempt(now, out);
}

void endpoint::write_attempt(instant now, outputs& out) {
  const auto sequence = next_sequence_++;
  attempts_.push_back({sequence, now});
  deadline_ = now + patience_.wait(attempts_.size() == config_.attempts_max);
  ++counters_.attempts;
  out.push_back(to_line{encode(frame{frame_type::packet_with_ack, sequence, current_.packet})});
}

void endpoint::next(instant now, outputs& out) {
  attempts_.clear();
  deadline_.reset();
  if (!queue_.empty())
    start(queue_.pop(), now, out);
}

} // namespace rubicon::serial
