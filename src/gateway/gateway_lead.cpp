// One gateway among several of its island: when it leads, and what it passes on to the one that
// does (GW-14).
#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "gateway/gateway.hpp"
#include "gateway/tuples.hpp"

namespace rubicon::gateway {

/// The gateway that leads next may have the answers to what was in flight, and does not know the
/// questions. One that takes the lead is the PC of the island from here on.
void gateway::change_lead(leadership::change x, const occasion& at) {
  if (x == leadership::change::none)
    return;
  inputs_.fail_all(at);
  requested_.clear();
  pc_.discard();
  motes_.erase_outputs(at);
  if (x == leadership::change::taken) {
    requests_.forget_confirmed(at.now);
    take(pc_.begin_term(lead_.term(), sink_.is_up(), at.now), at);
  }
  at.out.emplace_back(
      text_tuple(std::string(device_role_key), device_role_text(lead_.leads(), at.now)));
  at.out.emplace_back(lead_changed{lead_.leads(), lead_.term()});
  others_.gateways().announce_soon(at.now);
}

void gateway::pass_on(island_id source, network::gateway_packet x, const occasion& at) {
  const auto leader = others().leader_of(config_.island);
  if (!leader) {
    ++counters_.undeliverable;
    note_loss(loss::not_leading);
    return;
  }
  ++counters_.relayed_out;
  at.out.emplace_back(relay_to{*leader, encode(relay(relayed_message{source, std::move(x)}))});
}

void gateway::on_relay(peer_id source, byte_view octets, const occasion& at) {
  begin(at.now);
  auto x = decode_relay(octets);
  const bool is_one_of_us = std::ranges::find(config_.gateways, source) != config_.gateways.end();
  if (!x || !is_one_of_us) {
    ++counters_.malformed;
    return;
  }
  std::visit([this, source, &at](auto& y) { on_relayed(source, std::move(y), at); }, *x);
}

/// Not passed on again: two that hold each other for the leader would not end.
void gateway::on_relayed(peer_id, relayed_message x, const occasion& at) {
  if (!lead_.leads()) {
    ++counters_.undeliverable;
    note_loss(loss::not_leading);
    return;
  }
  ++counters_.relayed_in;
  accept(x.source, std::move(x.packet), at);
}

void gateway::on_relayed(peer_id source, const relayed_input& x, const occasion& at) {
  const pending_input what{x.mote, x.channel, x.number, source};
  if (!lead_.leads() || !motes_.is_listed(x.mote)) {
    ++counters_.undeliverable;
    inputs_.report(what, input_outcome::unreachable, at);
    return;
  }
  ++counters_.relayed_in;
  submit(what, x.octets, at);
}

void gateway::on_relayed(peer_id, const relayed_outcome& x, const occasion& at) {
  inputs_.on_relayed(x, at);
}

} // namespace rubicon::gateway
