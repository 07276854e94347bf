// The peer-to-peer layer fed with arbitrary octets by the other end of a link: first as an
// acceptor, then after a good handshake. What decodes as packages must encode back.
#include <cassert>
#include <cstdint>

#include "peis/link/link.hpp"
#include "peis/p2p/p2p.hpp"

using namespace rubicon;

namespace {

peis::p2p fresh_peer() {
  peis::p2p_config config;
  config.id = peer_id{20};
  return {config, random_stream(1), instant{}};
}

void check_round_trip(byte_view octets) {
  peis::stream_decoder decoder;
  decoder.feed(octets);
  std::size_t at = 0;
  while (const auto x = decoder.next()) {
    bytes again;
    peis::encode(x->header, again);
    const auto original = octets.subspan(at, peis::header_size);
    assert(std::equal(again.begin(), again.end() - 2, original.begin())); // but for the padding
    at += peis::header_size + x->header.length;
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  check_round_trip(octets);
  auto peer = fresh_peer();
  const peis::link_id first{1};
  const peis::link_id second{2};
  peer.on_link_open(first, peis::link_role::acceptor, instant{});
  peer.on_link_octets(first, octets, instant{});
  peer.on_link_open(second, peis::link_role::acceptor, instant{});
  const auto request = peis::encode(peis::connect_request{500, peer_id{10}, 4, "default"});
  peer.on_link_octets(second, request, instant{});
  const auto half = size / 2;
  peer.on_link_octets(second, octets.first(half), instant{});
  peer.on_link_octets(second, octets.subspan(half), instant{1s});
  peer.flush(instant{1s});
  for (int i = 0; i < 4; ++i) {
    const auto deadline = peer.deadline();
    assert(deadline);
    peer.on_time(*deadline);
    peer.flush(*deadline);
  }
  peer.on_link_closed(second, instant{1h});
  return 0;
}
