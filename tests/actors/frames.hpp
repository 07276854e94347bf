// Frames as neighbours of an actor under test would send and see them.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "actors/messages/air.hpp"
#include "actors/messages/serial.hpp"
#include "mote/join/management.hpp"
#include "network/am.hpp"
#include "network/router_message.hpp"
#include "network/tree/collection_packet.hpp"
#include "radio/frame.hpp"
#include "serial/frame.hpp"
#include "serial/packet.hpp"

namespace rubicon::test {

/// What the air hands to a radio's owner.
[[nodiscard]] inline frame_received radio_frame(mote_id source, mote_id destination,
                                                std::uint8_t am_type, const bytes& octets,
                                                std::uint8_t island = 5) {
  radio::frame x;
  x.pan = island; // that of all tests here
  x.source = source;
  x.destination = destination;
  x.am_type = am_type;
  x.payload = octets;
  return {payload(radio::encode(x)), -60};
}

/// The component management message in a frame on its way up to the sink.
template <class Message>
[[nodiscard]] std::optional<Message> management_in(const radio_send& x) {
  if (x.am_type != network::am::up)
    return std::nullopt;
  const auto packet = network::decode_up(x.octets.view());
  if (!packet)
    return std::nullopt;
  const auto content = network::decode_router_message(packet->content);
  const auto* octets = content ? std::get_if<network::user_content>(&*content) : nullptr;
  if (octets == nullptr || octets->content.at(0) != network::am::component_management)
    return std::nullopt;
  const auto message = mote::decode_management(byte_view(octets->content).subspan(1));
  if (!message || !std::holds_alternative<Message>(*message))
    return std::nullopt;
  return std::get<Message>(*message);
}

/// A serial frame with an active message.
[[nodiscard]] inline serial_octets serial_frame(const serial::am_packet& x, serial::frame_type type,
                                                std::uint8_t sequence = 0) {
  return {payload(serial::encode(serial::frame{type, sequence, serial::encode(x)}))};
}

/// The frames that were written to a line, acks included.
[[nodiscard]] inline std::vector<serial::frame> frames_in(const std::vector<serial_write>& writes) {
  std::vector<serial::frame> frames;
  serial::frame_decoder decoder;
  for (const auto& x : writes) {
    for (const auto octet : x.octets.view()) {
      if (auto frame = decoder.on_octet(octet))
        frames.push_back(*std::move(frame));
    }
  }
  return frames;
}

/// The active messages in them.
[[nodiscard]] inline std::vector<serial::am_packet>
packets_in(const std::vector<serial_write>& writes) {
  std::vector<serial::am_packet> packets;
  for (const auto& frame : frames_in(writes)) {
    if (auto packet = serial::decode_am_packet(frame.packet))
      packets.push_back(*std::move(packet));
  }
  return packets;
}

} // namespace rubicon::test
