#include "explain/content.hpp"

#include "core/codec.hpp"
#include "network/am.hpp"
#include "network/channel_message.hpp"
#include "network/collection_packet.hpp"
#include "network/island_packet.hpp"
#include "network/router_message.hpp"
#include "peis/tuple_record.hpp"
#include "serial/packet.hpp"

namespace rubicon::explain {

namespace {

namespace am = network::am;

/// What Network's user sends begins with its AM type.
frame_content piece_in(byte_view content, bool is_down, mote_id origin, std::uint32_t sequence) {
  if (content.empty() || content[0] != am::packet)
    return {};
  auto part = piece_of(content.subspan(1));
  if (!part)
    return {};
  return carried_piece{is_down, origin, sequence, *std::move(part)};
}

frame_content routed(byte_view octets, bool is_down, mote_id origin, std::uint32_t sequence) {
  const auto message = network::decode_router_message(octets);
  const auto* content = message ? std::get_if<network::user_content>(&*message) : nullptr;
  return content == nullptr ? frame_content()
                            : piece_in(content->content, is_down, origin, sequence);
}

/// No packet has the number 0, so that it can mean "none"; ways do not mix.
std::uint32_t numbered(std::uint8_t way, std::uint16_t sequence) {
  return std::uint32_t{way} << 16U | sequence;
}

frame_content channel_content_of(byte_view payload) {
  const auto message = network::decode_channel_message(payload);
  const auto* data = message ? std::get_if<network::data_message>(&message->content) : nullptr;
  if (data == nullptr)
    return {};
  return channel_content{network::number_of(message->channel), data->sequence, data->content};
}

} // namespace

std::optional<piece> piece_of(byte_view octets) {
  if (octets.empty())
    return std::nullopt;
  piece x;
  x.index = octets[0] >> 4U;
  x.last = octets[0] & 0x0fU;
  if (x.index > x.last || (x.last > 0 && octets.size() < 3))
    return std::nullopt;
  if (x.last > 0)
    x.tag = octets[1];
  x.content = to_bytes(octets.subspan(x.last > 0 ? 2 : 1));
  return x;
}

frame_content frame_content_of(std::uint8_t am_type, byte_view payload, mote_id sender,
                               mote_id sink) {
  switch (am_type) {
  case am::up:
    if (const auto x = network::decode_up(payload))
      return routed(x->content, false, x->origin, numbered(am_type, x->sequence));
    return {};
  case am::down:
    if (const auto x = network::decode_down(payload))
      return routed(x->content, true, sink, numbered(am_type, x->sequence));
    return {};
  case am::flood:
    if (const auto x = network::decode_flood(payload))
      return routed(x->content, x->origin == sink, x->origin, numbered(am_type, x->sequence));
    return {};
  case am::local:
    return piece_in(payload, sender == sink, sender, 0);
  case am::channel:
    return channel_content_of(payload);
  default:
    return {};
  }
}

std::optional<serial_content> serial_content_of(byte_view octets, bool to_mote) {
  serial::frame_decoder decoder;
  std::optional<serial::frame> frame;
  for (const auto octet : octets)
    if (auto x = decoder.on_octet(octet))
      frame = std::move(x);
  if (!frame)
    return std::nullopt;
  serial_content out{frame->type, frame->sequence, {}};
  const auto packet = serial::decode_am_packet(frame->packet);
  if (!packet)
    return out;
  const mote_id origin = to_mote ? no_mote : mote_id(packet->source);
  if (packet->am_type == am::packet) {
    if (auto part = piece_of(packet->payload))
      out.part = carried_piece{to_mote, origin, 0, *std::move(part)};
  } else if (packet->am_type == (to_mote ? am::from_gateway : am::to_gateway)) {
    out.part = carried_piece{to_mote, origin, 0, {0, 0, 0, packet->payload}};
  }
  return out;
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

std::vector<carried_package> packages_of(byte_view octets) {
  std::vector<carried_package> out;
  for (auto header = peis::decode_header(octets); header; header = peis::decode_header(octets)) {
    const auto size = peis::header_size + header->length;
    if (size > octets.size())
      break;
    if (peis::is_legal(*header))
      out.push_back({*header, to_bytes(octets.first(size).subspan(peis::header_size))});
    octets = octets.subspan(size);
  }
  return out;
}

std::optional<peis::tuple> tuple_of(const carried_package& x) {
  const auto port = x.header.port;
  if (port != peis::port::push && port != peis::port::set)
    return std::nullopt;
  auto whole = peis::decode_tuple_message(payload(x.data));
  return whole ? std::optional(*std::move(whole)) : std::nullopt;
}

} // namespace rubicon::explain
