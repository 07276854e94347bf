#include "gateway/other_islands.hpp"

#include <utility>

#include "core/account/message_ledger.hpp"
#include "gateway/others/strict.hpp"

namespace rubicon::gateway {

namespace {

void note_not_expressible(const occasion& at) {
  ++at.counters.unsayable;
  note_loss(loss::not_expressible);
}

} // namespace

wire_form other_islands::form_with(peer_id peer) const {
  return form_ == wire_form::strict54 ? form_ : gateways_.form_of(peer);
}

void other_islands::send(island_id island, network::gateway_packet x, bool reliable,
                         const occasion& at) {
  if (const auto meant = gateways_.meant_by(island); meant != island)
    talks_.note(island, meant, x.mote, x.body);
  const auto peer = gateways_.gateway_for(island);
  auto packet = std::optional(std::move(x));
  if (form_with(peer) == wire_form::strict54)
    packet = to_strict(*std::move(packet));
  if (packet)
    at.out.emplace_back(to_gateway{peer, encode(*packet), reliable});
  else
    note_not_expressible(at);
}

std::optional<other_islands::message> other_islands::on_message(peer_id source, byte_view octets,
                                                                const occasion& at) {
  auto packet = network::decode_gateway_packet(octets);
  if (!packet || source.value <= 0) {
    ++at.counters.malformed;
    return std::nullopt;
  }
  if (form_with(source) == wire_form::strict54) {
    auto ours = from_strict(*std::move(packet), ++strict_counter_);
    if (!ours) {
      note_not_expressible(at);
      return std::nullopt;
    }
    packet = *std::move(ours);
  }
  const auto island = talks_.source_of(gateways_.island_of(source), packet->mote, packet->body);
  return message{island, *std::move(packet)};
}

} // namespace rubicon::gateway
