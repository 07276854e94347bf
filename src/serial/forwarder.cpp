#include "serial/forwarder.hpp"

#include <cassert>
#include <utility>

namespace rubicon::serial {

namespace {

constexpr std::uint8_t greeting = 0x55;
constexpr std::uint8_t version = 0x20;
constexpr std::size_t forwarded_max = 255;

void append(bytes& to, byte_view octets) {
  to.insert(to.end(), octets.begin(), octets.end());
}

} // namespace

bytes forwarder_greeting() {
  return {greeting, version};
}

bytes encode_forwarded(byte_view packet) {
  assert(!packet.empty() && packet.size() <= forwarded_max);
  bytes out{static_cast<std::uint8_t>(packet.size())};
  append(out, packet);
  return out;
}

std::string_view to_string(refusal x) {
  switch (x) {
  case refusal::none:
    return "none";
  case refusal::other_protocol:
    return "it does not use the serial forwarder's protocol";
  case refusal::old_version:
    return "it uses the serial forwarder's protocol of TinyOS 1.x";
  case refusal::empty_packet:
    return "it sent a packet of no octets";
  }
  return "?";
}

std::vector<bytes> forwarder_decoder::on_octets(byte_view octets) {
  std::vector<bytes> out;
  for (const auto octet : octets) {
    if (refused_ != refusal::none)
      break;
    on_octet(octet, out);
  }
  return out;
}

void forwarder_decoder::on_octet(std::uint8_t octet, std::vector<bytes>& out) {
  switch (state_) {
  case state::first:
    if (octet == greeting)
      state_ = state::version;
    else
      refused_ = refusal::other_protocol;
    return;
  case state::version:
    if (octet >= version) // the lower of both versions is spoken, and that is ours
      state_ = state::length;
    else
      refused_ = refusal::old_version;
    return;
  case state::length:
    wanted_ = octet;
    state_ = state::packet;
    if (octet == 0)
      refused_ = refusal::empty_packet;
    return;
  case state::packet:
    packet_.push_back(octet);
    if (packet_.size() < wanted_)
      return;
    out.push_back(std::exchange(packet_, {}));
    state_ = state::length;
    return;
  }
}

forwarder_line::todo forwarder_line::on_pc(byte_view octets) {
  todo out;
  for (const auto octet : octets) {
    const auto x = frames_.on_octet(octet);
    if (!x || x->packet.empty() || x->packet.size() > forwarded_max)
      continue;
    if (x->type != frame_type::packet && x->type != frame_type::packet_with_ack)
      continue;
    append(out.to_forwarder, encode_forwarded(x->packet));
    if (x->type == frame_type::packet_with_ack)
      append(out.to_pc, encode(frame{frame_type::ack, x->sequence, {}}));
  }
  return out;
}

forwarder_line::todo forwarder_line::on_forwarder(byte_view octets) {
  todo out;
  for (auto& packet : decoder_.on_octets(octets))
    append(out.to_pc, encode(frame{frame_type::packet, 0, std::move(packet)}));
  return out;
}

bytes forwarder_line::on_connected() {
  decoder_ = {};
  return forwarder_greeting();
}

} // namespace rubicon::serial
