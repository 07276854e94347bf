#include "network/channels/known_places.hpp"

#include "network/am.hpp"
#include "network/channels/channel_message.hpp"
#include "network/router_message.hpp"
#include "network/tree/collection_packet.hpp"

namespace rubicon::network {

std::optional<virtual_coordinates> known_places::find(mote_id x, instant now) const {
  if (x == self_)
    return own_.likely_place();
  const auto found = others_.find(x, now);
  return found ? found : own_.likely_place_of(x);
}

void known_places::learn(mote_id x, virtual_coordinates place, instant now) {
  if (x != self_)
    others_.learn(x, place, now);
}

/// Places in messages of others that pass: a mote's report to the sink, the sink's answer to a
/// mote, and where a channel is to lead. Most packets are none of these: their content is not
/// decoded.
void known_places::learn_from(std::uint8_t am_type, byte_view payload, instant now) {
  if (am_type == am::channel) {
    const auto x = decode_channel_message(payload);
    const auto* request = x ? std::get_if<connect_message>(&x->content) : nullptr;
    if (request != nullptr && request->place)
      learn(request->destination, *request->place, now);
  } else if (am_type == am::up) {
    constexpr auto kind_at = up_packet::header_size;
    if (payload.size() <= kind_at || payload[kind_at] != router_message(place_report{}).index())
      return;
    const auto x = decode_up(payload);
    const auto message = x ? decode_router_message(x->content) : errc::truncated;
    const auto* report = message ? std::get_if<place_report>(&*message) : nullptr;
    if (report != nullptr && report->place)
      learn(x->origin, *report->place, now);
  } else if (am_type == am::down) {
    const auto x = decode_down(payload);
    const auto message = x ? decode_router_message(x->content) : errc::truncated;
    const auto* answer = message ? std::get_if<place_answer>(&*message) : nullptr;
    if (answer != nullptr && answer->place)
      learn(answer->mote, *answer->place, now);
  }
}

} // namespace rubicon::network
