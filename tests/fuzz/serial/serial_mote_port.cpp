// A mote's serial port under any octets at line speed: no crash, well-formed packets and acks only,
// and every good frame accounted for once.
#include <algorithm>

#include "fuzz/require.hpp"
#include "serial/cable/line_config.hpp"
#include "serial/frame.hpp"
#include "serial/mote_port.hpp"

using namespace rubicon;
using namespace rubicon::serial;

namespace {

void check(const mote_port_outputs& out) {
  for (const auto& one : out) {
    if (const auto* up = std::get_if<received>(&one)) {
      require(static_cast<bool>(decode_am_packet(up->packet)));
      continue;
    }
    frame_decoder decoder;
    std::optional<frame> last;
    for (const auto octet : std::get<to_line>(one).octets)
      last = decoder.on_octet(octet);
    require(last && last->type == frame_type::ack);
  }
}

/// Feeds `octets` in pieces of `piece`.
mote_port_counters run(byte_view octets, std::size_t piece) {
  mote_port_config config;
  config.payload_max = 28;
  mote_port port(config);
  instant now{};
  while (!octets.empty()) {
    const auto head = octets.first(std::min(piece, octets.size()));
    octets = octets.subspan(head.size());
    const auto end = now + transmission_time(head.size(), config.baud);
    for (auto due = port.deadline(); due && *due < end; due = port.deadline())
      check(port.on_time(now = std::max(now, *due)));
    now = end;
    check(port.on_bytes(head, now));
  }
  const auto& x = port.counters();
  require(x.frames_received == x.received + x.unknown_dispatch + x.oversized);
  return x;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  const auto single = run(octets, 1);
  const auto pieces = run(octets, 7);
  require(single.frames_received == pieces.frames_received);
  require(single.bad_crc == pieces.bad_crc);
  return 0;
}
