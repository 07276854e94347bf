#include "explain/media.hpp"
#include "network/am.hpp"
#include "traffic/program.hpp"

namespace rubicon::explain {

std::optional<sighting> air_follower::recognise(const record& r, mote_address who,
                                                std::uint32_t& fragment, std::uint32_t& fragments) {
  const auto am_type = static_cast<std::uint8_t>(r.channel);
  if (am_type == traffic::am_type)
    return messages_.recognise_flow(r.octets, who.island, r);
  if (am_type == network::am::smepp)
    return messages_.recognise_event(who.island, r);
  const auto content =
      frame_content_of(am_type, r.octets, who.mote, all_.all.known.sink_of(who.island));
  if (const auto* on_channel = std::get_if<channel_content>(&content))
    return messages_.recognise(*on_channel, who.island, r);
  const auto* part = std::get_if<carried_fragment>(&content);
  if (part == nullptr)
    return std::nullopt;
  fragment = part->part.index;
  fragments = part->part.last + 1U;
  return messages_.recognise(*part, r.cause, who.island, r);
}

void air_follower::on_send(const record& r) {
  const auto who = all_.all.known.address_of(r.from);
  if (!who)
    return;
  std::uint32_t fragment = 0;
  std::uint32_t fragments = 1;
  const auto what = recognise(r, *who, fragment, fragments);
  if (!what)
    return;
  const bool to_all = r.mote.mote == broadcast_mote;
  const crossing hop{*what,    medium::air,
                     r.from,   to_all ? "" : all_.all.known.path_of({who->island, r.mote.mote}),
                     any_peer, fragments};
  requests_[r.number] = {all_.hop_for(hop, r.cause, r), fragment, to_all};
}

void air_follower::on_frame(const record& r) {
  const auto asked = requests_.find(r.cause);
  if (asked == requests_.end())
    return;
  const auto& x = asked->second;
  all_.at(x.hop).attempts.push_back(
      {r.time, x.to_all ? (r.yes ? "delivered" : "nobody") : r.text, r.yes});
}

void air_follower::on_received(const record& r) {
  const auto asked = requests_.find(r.cause);
  if (asked != requests_.end() && all_.all.known.address_of(r.to))
    all_.arrive(asked->second.hop, asked->second.fragment, r.to, r);
}

void air_follower::on_done(const record& r) {
  if (const auto asked = requests_.extract(r.cause); !asked.empty())
    all_.at(asked.mapped().hop).failure = r.text == "sent" ? "" : r.text;
}

} // namespace rubicon::explain
