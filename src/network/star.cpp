#include "network/star.hpp"

#include "core/codec.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"

namespace rubicon::network {

void star::join(island_id island, mote_id sink) {
  island_ = island;
  sink_ = sink;
  joined_ = true;
}

outputs star::send(mote_address destination, std::uint16_t channel, bytes segment) {
  if (!joined_) {
    ++counters_.before_join;
    return {};
  }
  if (destination.island == own_island)
    destination.island = island_;
  if (destination.mote == own_mote)
    destination.mote = self_;
  const bool local = destination.island == island_ && destination.mote != no_mote;
  if (local && destination.mote == self_)
    return {arrived{island_, channel, std::move(segment)}};
  if (local) {
    byte_writer out;
    out.big(channel).append(segment);
    return {transmit{destination.mote, am::local, out.finish()}};
  }
  return {transmit{
      sink_, am::to_gateway,
      encode(island_packet{destination.island, destination.mote, channel, std::move(segment)})}};
}

outputs star::on_frame(std::uint8_t am_type, byte_view payload) {
  if (am_type == am::local) {
    byte_reader in(payload);
    const auto channel = in.big<std::uint16_t>();
    if (!in.ok()) {
      ++counters_.malformed;
      return {};
    }
    return {arrived{island_, channel, to_bytes(in.rest())}};
  }
  auto packet = decode_island_packet(payload);
  if (!packet) {
    ++counters_.malformed;
    return {};
  }
  if (packet->mote != self_ && packet->mote != broadcast_mote) {
    ++counters_.misdirected;
    return {};
  }
  return {arrived{packet->island, packet->channel, std::move(packet->body)}};
}

bool star::owns(std::uint8_t am_type) {
  return am_type == am::local || am_type == am::from_gateway;
}

} // namespace rubicon::network
