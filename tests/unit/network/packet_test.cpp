#include "network/island_packet.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::network;

TEST_CASE("messages between islands have the octets of D1.1 5.4", "[network][WIR-01][WIR-02]") {
  const island_packet up{island_id{2}, mote_id{5}, 1, bytes{'h', 'i'}};
  CHECK(to_hex(encode(up)) == "00000002000500016869");
  CHECK(*decode_island_packet(encode(up)) == up);
  const gateway_packet across{mote_id{5}, 1, bytes{'h', 'i'}};
  CHECK(to_hex(encode(across)) == "000500016869");
  CHECK(*decode_gateway_packet(encode(across)) == across);
}

TEST_CASE("bodies may be empty and at most 256 octets and a transport header",
          "[network][WIR-03]") {
  CHECK(decode_island_packet(*from_hex("0000000200050001"))->body.empty());
  CHECK(decode_island_packet(*from_hex("00000002000500")).error() == errc::truncated);
  CHECK(decode_gateway_packet(*from_hex("000500")).error() == errc::truncated);
  bytes largest(8 + body_max);
  CHECK(decode_island_packet(largest));
  largest.push_back(0);
  CHECK(decode_island_packet(largest).error() == errc::too_long);
  CHECK(decode_gateway_packet(bytes(4 + body_max + 1)).error() == errc::too_long);
}
