#include "explain/content.hpp"

#include "core/codec.hpp"
#include "network/am.hpp"
#include "network/channels/channel_message.hpp"
#include "network/island_packet.hpp"
#include "network/router_message.hpp"
#include "network/tree/collection_packet.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "serial/frame.hpp"
#include "serial/packet.hpp"

namespace rubicon::explain {

namespace {

namespace am = network::am;

/// What Network's user sends begins with its AM type.
frame_content piece_in(byte_view content, bool is_down) {
  if (content.empty() || content[0] != am::packet)
    return {};
  auto part = fragment_of(content.subspan(1));
  if (!part)
    return {};
  return carried_fragment{is_down, *std::move(part)};
}

frame_content routed(byte_view octets, bool is_down) {
  const auto message = network::decode_router_message(octets);
  const auto* content = message ? std::get_if<network::user_content>(&*message) : nullptr;
  return content == nullptr ? frame_content() : piece_in(content->content, is_down);
}

frame_content channel_content_of(byte_view payload) {
  const auto message = network::decode_channel_message(payload);
  const auto* data = message ? std::get_if<network::data_message>(&message->content) : nullptr;
  if (data == nullptr)
    return {};
  return channel_content{network::number_of(message->channel), data->content};
}

} // namespace

std::optional<fragment> fragment_of(byte_view octets) {
  if (octets.empty())
    return std::nullopt;
  fragment x;
  x.index = octets[0] >> 4U;
  x.last = octets[0] & 0x0fU;
  if (x.index > x.last || (x.last > 0 && octets.size() < 3))
    return std::nullopt;
  x.content = to_bytes(octets.subspan(x.last > 0 ? 2 : 1));
  return x;
}

frame_content frame_content_of(std::uint8_t am_type, byte_view payload, mote_id sender,
                               mote_id sink) {
  switch (am_type) {
  case am::up:
    if (const auto x = network::decode_up(payload))
      return routed(x->content, false);
    return {};
  case am::down:
    if (const auto x = network::decode_down(payload))
      return routed(x->content, true);
    return {};
  case am::flood:
    if (const auto x = network::decode_flood(payload))
      return routed(x->content, x->origin == sink);
    return {};
  case am::local:
    return piece_in(payload, sender == sink);
  case am::channel:
    return channel_content_of(payload);
  default:
    return {};
  }
}

std::optional<carried_fragment> serial_part_of(byte_view octets, bool to_mote) {
  serial::frame_decoder decoder;
  std::optional<serial::frame> frame;
  for (const auto octet : octets)
    if (auto x = decoder.on_octet(octet))
      frame = std::move(x);
  const auto packet =
      frame ? serial::decode_am_packet(frame->packet) : result<serial::am_packet>(errc::truncated);
  if (!packet)
    return std::nullopt;
  if (packet->am_type == am::packet) {
    if (auto part = fragment_of(packet->payload))
      return carried_fragment{to_mote, *std::move(part)};
  } else if (packet->am_type == (to_mote ? am::from_gateway : am::to_gateway)) {
    return carried_fragment{to_mote, {0, 0, packet->payload}};
  }
  return std::nullopt;
}

std::optional<envelope> envelope_of(byte_view packet, bool is_down, island_id here) {
  auto x = network::decode_island_packet(packet);
  if (!x)
    return std::nullopt;
  const auto named = x->island == own_island ? here : x->island;
  return envelope{{is_down ? named : here, no_mote},
                  {is_down ? here : named, x->mote},
                  x->channel,
                  std::move(x->body)};
}

std::optional<envelope> envelope_of(byte_view message, peer_id source, peer_id destination) {
  auto x = network::decode_gateway_packet(message);
  if (!x || source.value <= 0 || destination.value <= 0)
    return std::nullopt;
  return envelope{{island_id(static_cast<std::uint32_t>(source.value)), no_mote},
                  {island_id(static_cast<std::uint32_t>(destination.value)), x->mote},
                  x->channel,
                  std::move(x->body)};
}

std::optional<carried_package> package_of(byte_view octets) {
  const auto header = peis::decode_header(octets);
  if (!header || !peis::is_legal(*header) || peis::header_size + header->length > octets.size())
    return std::nullopt;
  return carried_package{*header, to_bytes(octets.subspan(peis::header_size, header->length))};
}

std::optional<peis::tuple> tuple_of(const carried_package& x) {
  const auto port = x.header.port;
  if (port != peis::port::push && port != peis::port::set)
    return std::nullopt;
  auto whole = peis::decode_tuple_message(payload(x.data), {}); // only its times need more
  return whole ? std::optional(*std::move(whole)) : std::nullopt;
}

} // namespace rubicon::explain
