#include "gateway/sink_port.hpp"

#include <string>
#include <utility>

#include "gateway/tuples.hpp"
#include "network/wire.hpp"

namespace rubicon::gateway {

namespace {

constexpr std::size_t assemblies_max = 64; ///< long packets from the sink at the same time

} // namespace

sink_port::sink_port(duration silence_max)
    : silence_max_(silence_max), fragments_({.packets_max = assemblies_max}) {}

bool sink_port::on_packet(const occasion& at) {
  const auto before = std::exchange(last_packet_, at.now);
  if (std::exchange(up_, true))
    return false;
  at.out.emplace_back(text_tuple(std::string(device_line_key), line_text("up", at.now)));
  at.out.emplace_back(line_changed{true, before ? at.now - *before : duration{}});
  return true;
}

bool sink_port::on_time(const occasion& at) {
  if (!up_ || *last_packet_ + silence_max_ > at.now)
    return false;
  up_ = false;
  at.out.emplace_back(text_tuple(std::string(device_line_key), line_text("silent", *last_packet_)));
  at.out.emplace_back(line_changed{});
  return true;
}

std::optional<instant> sink_port::deadline() const {
  return up_ ? std::optional(*last_packet_ + silence_max_) : std::nullopt;
}

void sink_port::send(const network::island_packet& x, const occasion& at) {
  auto octets = encode(x);
  if (octets.size() <= network::frame_payload_max) {
    at.out.emplace_back(to_sink{x.mote, network::am::from_gateway, std::move(octets)});
    return;
  }
  const auto fragments = transport::cut(octets, network::frame_payload_max, tag_++);
  for (const auto& fragment : *fragments) // packet_max octets never are too many
    at.out.emplace_back(to_sink{x.mote, network::am::packet, fragment});
}

} // namespace rubicon::gateway
