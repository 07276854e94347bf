#include "mote/sink.hpp"

#include "network/am.hpp"
#include "network/island_packet.hpp"

namespace rubicon::mote {

sink_outputs sink::start(instant now) {
  return take(registrar_.start(now));
}

sink_outputs sink::on_frame(mote_id source, std::uint8_t am_type, byte_view payload, instant now) {
  if (am_type == network::am::component_management)
    return take(registrar_.on_frame(source, payload, now));
  auto out = take(registrar_.on_heard(source, now));
  if (am_type == network::am::to_gateway) {
    ++counters_.up;
    out.emplace_back(to_gateway{source, am_type, to_bytes(payload)});
  } else {
    ++counters_.unknown_type;
  }
  return out;
}

sink_outputs sink::on_packet(std::uint8_t am_type, byte_view payload, instant now) {
  if (am_type == network::am::from_gateway) {
    const auto packet = network::decode_island_packet(payload);
    if (!packet) {
      ++counters_.malformed;
      return {};
    }
    ++counters_.down;
    return {network::transmit{packet->mote, am_type, to_bytes(payload)}};
  }
  if (am_type == network::am::sink_event) {
    const auto event = network::decode_sink_event(payload);
    const auto* wanted = event ? std::get_if<network::describe>(&*event) : nullptr;
    if (wanted != nullptr)
      return take(registrar_.on_describe(wanted->mote, now));
    ++counters_.malformed;
    return {};
  }
  ++counters_.unknown_type;
  return {};
}

sink_outputs sink::on_time(instant now) {
  return take(registrar_.on_time(now));
}

sink_outputs sink::take(registrar_outputs from_registrar) const {
  sink_outputs out;
  for (auto& x : from_registrar) {
    if (const auto* message = std::get_if<to_mote>(&x))
      out.emplace_back(network::transmit{message->mote, network::am::component_management,
                                         encode(message->message)});
    else
      out.emplace_back(
          to_gateway{self_, network::am::sink_event, encode(std::get<network::sink_event>(x))});
  }
  return out;
}

} // namespace rubicon::mote
