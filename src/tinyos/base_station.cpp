#include "tinyos/base_station.hpp"

#include <utility>

#include "serial/raw_packet.hpp"

namespace rubicon::tinyos {

std::optional<serial::am_packet> base_station::on_frame(const air_frame& x) {
  if (x.payload.size() > config_.payload_max) {
    ++counters_.up_too_long;
    return {};
  }
  ++counters_.up;
  return serial::am_packet{x.destination.value, x.source.value,
                           static_cast<std::uint8_t>(x.pan & 0xffU), x.am_type,
                           to_bytes(x.payload)};
}

bytes base_station::on_raw_frame(byte_view frame) {
  ++counters_.up;
  ++counters_.up_raw;
  return serial::wrap_raw(frame);
}

std::optional<to_radio> base_station::on_packet(byte_view packet) {
  auto x = serial::decode_am_packet(packet);
  if (!x || x->payload.size() > config_.payload_max) {
    ++counters_.down_malformed;
    return {};
  }
  if (queue_.full()) {
    ++counters_.down_full;
    return {};
  }
  ++counters_.down;
  queue_.push({mote_id(x->destination), x->am_type, std::move(x->payload)});
  return queue_.size() == 1 ? std::optional(queue_.front()) : std::nullopt;
}

std::optional<to_radio> base_station::on_radio_done(radio_result x) {
  if (queue_.empty())
    return {};
  if (x == radio_result::busy) {
    ++counters_.down_repeats;
    return queue_.front();
  }
  ++(x == radio_result::sent ? counters_.down_sent : counters_.down_lost);
  static_cast<void>(queue_.pop());
  return queue_.empty() ? std::nullopt : std::optional(queue_.front());
}

} // namespace rubicon::tinyos
