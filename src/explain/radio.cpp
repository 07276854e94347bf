// The part of the builder that follows frames on the air.
#include <algorithm>

#include "explain/builder.hpp"
#include "flow/program.hpp"
#include "network/am.hpp"
#include "radio/frame.hpp"

namespace rubicon::explain {

namespace {

/// A radio request that is open for so long will never end: its mote or air is gone.
constexpr std::size_t requests_max = 256;

bool carries_age(std::uint8_t am_type) {
  return am_type == network::am::channel || am_type == network::am::beacon;
}

} // namespace

void builder::on_radio_send(const record& r) {
  const auto who = all_.known.address_of(r.from);
  if (!who)
    return;
  const auto am_type = static_cast<std::uint8_t>(r.channel);
  request asked{r.from, r.id, r.mote.mote, am_type, r.octets, no_node, 0};
  const auto content =
      frame_content_of(am_type, r.octets, who->mote, all_.known.sink_of(who->island));
  std::optional<sighting> what;
  std::uint32_t sequence = 0;
  std::uint8_t pieces = 1;
  if (const auto* part = std::get_if<carried_piece>(&content)) {
    what = recognise(*part, medium::air, who->island, r);
    asked.piece = part->part.index;
    sequence = part->sequence;
    pieces = static_cast<std::uint8_t>(part->part.last + 1);
  } else if (const auto* on_channel = std::get_if<channel_content>(&content)) {
    what = recognise_channel(*on_channel, who->island, r);
    sequence = on_channel->sequence + 1U;
  } else if (am_type == flow::am_type) {
    what = recognise_flow(r.octets, who->island, r);
    sequence = 1;
  }
  if (what) {
    const bool to_all = asked.destination == broadcast_mote;
    const crossing way{*what, medium::air, r.from,
                       to_all ? "" : all_.known.path_of({who->island, asked.destination})};
    asked.hop = last_hop(way);
    if (asked.hop != no_node) {
      const auto& sent = pieces_[asked.hop];
      const auto same = sent.find(asked.piece);
      if (same != sent.end() && (sequence == 0 || same->second.sequence != sequence))
        asked.hop = no_node; // sent anew, not repeated
    }
    if (asked.hop == no_node) {
      asked.hop = begin_hop(way, r);
      at(asked.hop).pieces = pieces;
    }
    pieces_[asked.hop][asked.piece].sequence = sequence;
  }
  auto& open = requests_[*who];
  if (open.size() >= requests_max)
    open.pop_front();
  open.push_back(std::move(asked));
}

/// Whose frame this is; nullptr if nobody here has asked for it.
builder::request* builder::request_of(island_id island, const bytes& psdu) {
  const auto frame = radio::decode(psdu);
  if (!frame)
    return nullptr;
  const auto open = requests_.find({island, frame->source});
  if (open == requests_.end())
    return nullptr;
  const auto is_it = [&](const request& x) {
    if (x.am_type != frame->am_type || x.destination != frame->destination ||
        x.octets.size() != frame->payload.size())
      return false;
    return carries_age(x.am_type) || std::ranges::equal(x.octets, frame->payload);
  };
  const auto found = std::ranges::find_if(open->second, is_it);
  return found == open->second.end() ? nullptr : &*found;
}

void builder::on_frame(const record& r) {
  const auto* asked = request_of(r.mote.island, r.octets);
  if (asked == nullptr || asked->hop == no_node)
    return;
  const bool to_all = asked->destination == broadcast_mote;
  at(asked->hop)
      .attempts.push_back({r.time, to_all ? (r.yes ? "delivered" : "nobody") : r.text, r.yes});
}

void builder::on_frame_received(const record& r) {
  const auto who = all_.known.address_of(r.to);
  auto* asked = who ? request_of(who->island, r.octets) : nullptr;
  if (asked == nullptr || asked->hop == no_node)
    return;
  arrive_piece(asked->hop, asked->piece, r.to, r);
}

void builder::on_radio_done(const record& r) {
  const auto who = all_.known.address_of(r.to);
  const auto open = who ? requests_.find(*who) : requests_.end();
  if (open == requests_.end())
    return;
  const auto found = std::ranges::find(open->second, r.id, &request::token);
  if (found == open->second.end())
    return;
  if (found->hop != no_node)
    at(found->hop).failure = r.text == "sent" ? "" : r.text;
  open->second.erase(found);
}

} // namespace rubicon::explain
