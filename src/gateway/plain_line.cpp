#include "gateway/plain_line.hpp"

#include "serial/packet.hpp"
#include "serial/raw_packet.hpp"

namespace rubicon::gateway {

std::optional<std::vector<sink_packet>> plain_line::on_packet(byte_view packet, instant now) {
  counters_.packets += config_.range ? 1 : 0;
  const auto x = serial::decode_any_packet(packet);
  if (!x) {
    const bool is_raw = !packet.empty() && packet.front() == serial::raw_dispatch;
    return drop(is_raw && x.error() == errc::unsupported ? "no_data" : "malformed");
  }
  const mote_id source(x->source);
  if (config_.range && !config_.range->has(source))
    return drop("out_of_range");
  auto said = motes_.on_packet(source, x->am_type, x->payload, now);
  if (!said)
    return drop("no_rule");
  is_raw_ = packet.front() == serial::raw_dispatch;
  if (said->empty())
    static_cast<void>(drop("table_full"));
  else
    counters_.taken += config_.range ? 1 : 0;
  return said;
}

std::optional<bytes> plain_line::on_input(mote_id mote, std::uint16_t channel, byte_view octets) {
  ++counters_.inputs;
  auto said = motes_.on_input(mote, channel, octets);
  if (!said || said->payload.size() > serial::am_payload_max) {
    ++counters_.inputs_failed["refused"];
    return {};
  }
  const serial::am_packet packet{mote.value, 0, config_.group, said->am_type,
                                 std::move(said->payload)};
  return is_raw_ ? serial::encode_raw(packet, sequence_++) : serial::encode(packet);
}

void plain_line::on_lost(serial::lost_cause cause) {
  const bool is_refused =
      cause == serial::lost_cause::too_long || cause == serial::lost_cause::malformed;
  ++counters_.inputs_failed[is_refused ? "refused" : std::string(to_string(cause))];
}

std::optional<std::vector<sink_packet>> plain_line::drop(const char* cause) {
  if (config_.range)
    ++counters_.dropped[cause];
  return {};
}

} // namespace rubicon::gateway
