#include "gateway/plain/plain_line.hpp"

#include <utility>

#include "network/am.hpp"
#include "serial/packet.hpp"
#include "serial/raw_packet.hpp"

namespace rubicon::gateway {

namespace {

/// Whether the islands' own program says such packets.
bool is_of_sink(std::uint8_t am_type) {
  return am_type == network::am::sink_event || am_type == network::am::to_gateway ||
         am_type == network::am::packet;
}

/// A packet, or what a frame of another layout carries. The source is no mote's if it has none.
struct plain_message {
  mote_id source;
  std::optional<std::uint8_t> am_type;
  bytes payload;
};

/// Errors: those of decode_any_packet(); unsupported for frames that carry no readable data.
result<plain_message> decode_message(byte_view packet) {
  if (auto x = serial::decode_any_packet(packet))
    return plain_message{mote_id(x->source), x->am_type, std::move(x->payload)};
  else if (x.error() != errc::unsupported)
    return x.error();
  auto frame = serial::decode_raw_packet(packet);
  if (!frame || frame->kind != serial::raw_kind::data || frame->is_secured)
    return errc::unsupported;
  const auto source = static_cast<std::uint16_t>(frame->source.address.value_or(no_mote.value));
  return plain_message{mote_id(source), {}, std::move(frame->body)};
}

} // namespace

std::optional<std::vector<sink_packet>> plain_line::on_packet(byte_view packet, instant now) {
  const auto x = decode_message(packet);
  const bool is_raw = !packet.empty() && packet.front() == serial::raw_dispatch;
  if (!x) {
    if (config_.range)
      drop(is_raw && x.error() == errc::unsupported ? "no_data" : "malformed");
    return {};
  }
  const auto from = motes_.sender_of(x->source, x->am_type, x->payload);
  if (from.rule == nullptr) {
    if (!x->am_type)
      drop("no_data");
    else if (config_.range && !config_.range->has(from.mote))
      drop("out_of_range");
    else if (config_.range || !is_of_sink(*x->am_type))
      drop("no_rule");
    return {};
  }
  auto said = motes_.on_packet(x->source, x->am_type, x->payload, now);
  if (x->am_type) // what is written to inputs has the form of packets
    is_raw_ = is_raw;
  if (said->empty()) {
    drop("table_full");
  } else {
    ++counters_.packets;
    ++counters_.taken;
  }
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

void plain_line::drop(const char* cause) {
  ++counters_.packets;
  ++counters_.dropped[cause];
}

} // namespace rubicon::gateway
