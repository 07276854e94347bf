// The small services of the network: their messages as text, and from a neighbour of our own kind.
// The first octet chooses the service.
#include <array>
#include <cassert>
#include <cstdint>
#include <string>

#include "peis/link/link.hpp"
#include "peis/overlay/network_clock.hpp"
#include "peis/p2p/p2p.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/heartbeat.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/trace.hpp"

using namespace rubicon;

namespace {

constexpr peer_id neighbour{10};
constexpr peis::link_id link{1};

void check_round_trips(byte_view octets) {
  if (const auto x = peis::decode_announcement(octets)) {
    const auto again = peis::decode_announcement(peis::encode(*x));
    assert(again && again->network == x->network && again->sender == x->sender);
  }
  if (const auto x = peis::decode_heartbeat(octets))
    assert(peis::decode_heartbeat(peis::encode(*x))->held == x->held);
  if (const auto x = peis::decode_trace(octets))
    assert(peis::decode_trace(peis::encode(*x))->hosts == x->hosts);
  if (const auto x = peis::decode_clock(octets, 1s))
    assert(peis::decode_clock(peis::encode(*x), 1s)->network_time == x->network_time);
  const std::string text(octets.begin(), octets.end());
  if (const auto x = peis::parse_link_url(text))
    assert(*peis::parse_link_url(peis::to_string(*x)) == *x);
}

peis::package_header header_of(peis::package_type type, std::uint16_t port, byte_view data) {
  static std::int32_t id = 1;
  peis::package_header x;
  x.id = x.ack_id = id++;
  x.type = type;
  x.source = neighbour;
  x.destination = peer_id{20};
  x.port = port;
  x.length = static_cast<std::uint16_t>(data.size());
  return x;
}

void settle(peis::p2p& x, instant now) {
  while (x.serve_next(now)) {
  }
  x.end_turn(now);
}

void deliver(peis::p2p& to, peis::package_type type, std::uint16_t port, byte_view data) {
  bytes octets;
  peis::encode(header_of(type, port, data), octets);
  octets.insert(octets.end(), data.begin(), data.end());
  to.on_link_octets(link, octets, instant{1s});
  settle(to, instant{1s});
}

peis::p2p befriended_peer() {
  peis::p2p_config config;
  config.id = peer_id{20};
  peis::p2p x(config, random_stream(1), instant{});
  x.on_link_open(link, peis::link_role::acceptor, instant{});
  const auto request = peis::encode(peis::connect_request{500, neighbour, 0, "default"});
  x.on_link_octets(link, request, instant{});
  settle(x, instant{});
  peis::host_record_message record;
  record.record.id = neighbour;
  record.record.magic = 7;
  record.record.marked = true;
  deliver(x, peis::package_type::link, peis::port::host_record, peis::encode(record));
  return x;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return 0;
  const auto octets = byte_view(data, size).subspan(1);
  check_round_trips(octets);
  auto peer = befriended_peer();
  peer.on_announcement(octets, instant{1s});
  constexpr std::array services{peis::port::heartbeat,  peis::port::clock,
                                peis::port::trace,      peis::port::trace_reply,
                                peis::port::dead_host,  peis::port::host_query,
                                peis::port::host_record};
  const auto port = services[data[0] % services.size()];
  const auto message = octets.first(std::min(octets.size(), peis::data_max));
  for (const auto type : {peis::package_type::link, peis::package_type::direct,
                          peis::package_type::broadcast, peis::package_type::link})
    deliver(peer, type, port, message);
  peer.flush(instant{1s});
  peer.on_time(instant{10s});
  peer.flush(instant{10s});
  return 0;
}
