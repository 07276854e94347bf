#include "serial/mote_port.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "serial/cable/line_config.hpp"
#include "serial/frame.hpp"

namespace rubicon::serial {

namespace {

constexpr std::size_t crc_octets = 2;
constexpr std::size_t am_length_at = 4; // in the header, after the dispatch octet

constexpr auto asks_for_ack = static_cast<std::uint8_t>(frame_type::packet_with_ack);
constexpr auto asks_for_none = static_cast<std::uint8_t>(frame_type::packet);

} // namespace

mote_port::mote_port(mote_port_config config)
    : config_(config), buffers_(config.receive_buffers), acks_(config.acks_max),
      urgent_(config.urgent_max), packets_(config.queue_max) {
  assert(config_.baud > 0 && config_.receive_buffers > 0);
  for (auto& x : buffers_)
    x.octets.resize(am_header_octets + config_.payload_max);
}

mote_port_outputs mote_port::send(bytes packet, instant now, urgency how) {
  assert(!packet.empty() && packet.size() <= packet_octets_max);
  mote_port_outputs out;
  clock_ = std::max(clock_, now);
  if (state_ == state::inactive) {
    ++counters_.discarded;
    note_loss(loss::line_failed);
    return out;
  }
  auto& queue = how == urgency::before_others ? urgent_ : packets_;
  if (!queue.push({std::move(packet)})) {
    ++counters_.queue_full;
    note_loss(loss::line_failed);
  }
  transmit(now, out);
  return out;
}

mote_port_outputs mote_port::on_bytes(byte_view octets, instant now) {
  mote_port_outputs out;
  for (std::size_t i = 0; i < octets.size(); ++i) {
    // However many octets are handed over at once, buffers and the UART see them at line speed.
    const auto at = now - transmission_time(octets.size() - 1 - i, config_.baud);
    clock_ = std::max(clock_, at);
    on_octet(octets[i], clock_, out);
  }
  clock_ = std::max(clock_, now);
  return out;
}

mote_port_outputs mote_port::on_time(instant now) {
  mote_port_outputs out;
  clock_ = std::max(clock_, now);
  transmit(now, out);
  return out;
}

std::optional<instant> mote_port::deadline() const {
  if (acks_.empty() && queued() == 0)
    return {};
  return uart_free_at_;
}

void mote_port::stop() {
  counters_.discarded += acks_.size() + queued();
  acks_.clear();
  urgent_.clear();
  packets_.clear();
  end_frame(state::inactive);
}

void mote_port::start() {
  assert(state_ == state::inactive);
  end_frame(state::no_sync);
}

void mote_port::on_octet(std::uint8_t octet, instant at, mote_port_outputs& out) {
  if (state_ == state::inactive)
    return;
  if (octet == flag_octet)
    return on_flag(at, out);
  if (octet == escape_octet && !escaped_) {
    escaped_ = true;
    return;
  }
  const auto value = static_cast<std::uint8_t>(escaped_ ? octet ^ escape_mask : octet);
  escaped_ = false;
  switch (state_) {
  case state::no_sync:
  case state::inactive:
    return;
  case state::type:
    return on_type(value, at);
  case state::sequence:
    sequence_ = value;
    state_ = state::body;
    return;
  case state::body:
    return on_body(value);
  }
}

void mote_port::on_flag(instant at, mote_port_outputs& out) {
  switch (state_) {
  case state::inactive:
    return;
  case state::no_sync:
  case state::type:
    state_ = state::type;
    return;
  case state::sequence:
    ++counters_.too_short;
    end_frame(state::type);
    return;
  case state::body:
    end_body(at, out);
    return;
  }
}

void mote_port::on_type(std::uint8_t octet, instant at) {
  if (octet != asks_for_ack && octet != asks_for_none) {
    ++counters_.unknown_type;
    end_frame(state::no_sync);
    return;
  }
  const auto free = std::find_if(buffers_.begin(), buffers_.end(),
                                 [&](const buffer& x) { return x.busy_until <= at; });
  if (free == buffers_.end()) {
    ++counters_.no_buffer;
    note_loss(loss::line_failed);
    end_frame(state::no_sync);
    return;
  }
  filling_ = static_cast<std::size_t>(free - buffers_.begin());
  type_ = octet;
  body_.clear();
  state_ = octet == asks_for_ack ? state::sequence : state::body;
}

void mote_port::on_body(std::uint8_t octet) {
  if (body_.size() == mote_body_max) {
    ++counters_.too_long;
    end_frame(state::no_sync);
    return;
  }
  // The last two octets are held back as CRC; the dispatch octet selects who fills the buffer, and
  // what does not fit falls on the floor.
  body_.push_back(octet);
  if (body_.size() <= crc_octets + 1)
    return;
  const auto at = body_.size() - crc_octets - 2;
  auto& octets = buffers_[filling_].octets;
  if (at < octets.size() && body_[0] == am_dispatch)
    octets[at] = body_[at + 1];
}

void mote_port::end_body(instant at, mote_port_outputs& out) {
  if (body_.size() < crc_octets) {
    ++counters_.too_short;
    end_frame(state::type);
    return;
  }
  const std::array<std::uint8_t, 2> head{type_, sequence_};
  const byte_view body = body_;
  const auto tail = body.last(crc_octets);
  const auto crc = crc16(body.first(body.size() - crc_octets),
                         crc16(byte_view(head).first(type_ == asks_for_ack ? 2U : 1U)));
  if (crc != (tail[0] | tail[1] << 8)) {
    ++counters_.bad_crc;
    note_loss(loss::line_failed);
    end_frame(state::type);
    return;
  }
  take_packet(at, out);
  end_frame(state::no_sync);
}

void mote_port::end_frame(state next) {
  escaped_ = false;
  state_ = next;
}

void mote_port::take_packet(instant at, mote_port_outputs& out) {
  ++counters_.frames_received;
  if (type_ == asks_for_ack && !acks_.push(sequence_))
    ++counters_.acks_lost;
  transmit(at, out);
  if (body_.size() == crc_octets || body_[0] != am_dispatch) {
    ++counters_.unknown_dispatch;
    return;
  }
  buffers_[filling_].busy_until = at + config_.service_time;
  pass_up(out);
}

void mote_port::pass_up(mote_port_outputs& out) {
  const auto& octets = buffers_[filling_].octets;
  const std::size_t length = octets[am_length_at];
  if (length > config_.payload_max) {
    ++counters_.oversized;
    note_loss(loss::line_failed);
    return;
  }
  // The header's length is believed, whatever the frame brought.
  bytes packet{am_dispatch};
  const auto end = octets.begin() + static_cast<std::ptrdiff_t>(am_header_octets + length);
  packet.insert(packet.end(), octets.begin(), end);
  ++counters_.received;
  out.push_back(received{std::move(packet)});
}

void mote_port::transmit(instant now, mote_port_outputs& out) {
  if (now < uart_free_at_ || (acks_.empty() && queued() == 0))
    return;
  to_line next;
  if (!acks_.empty()) {
    ++counters_.acks_sent;
    next.octets = encode(frame{frame_type::ack, acks_.pop(), {}});
  } else {
    ++counters_.packets_sent;
    auto first = urgent_.empty() ? packets_.pop() : urgent_.pop();
    next = {encode(frame{frame_type::packet, 0, std::move(first.packet)}), first.from};
  }
  uart_free_at_ = now + transmission_time(next.octets.size(), config_.baud);
  out.push_back(std::move(next));
}

} // namespace rubicon::serial
