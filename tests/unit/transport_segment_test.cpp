#include "support/catch.hpp"
#include "transport/segment.hpp"

using namespace rubicon;
using namespace rubicon::transport;

TEST_CASE("a segment has the 6-octet header of WIR-04", "[transport][WIR-04]") {
  const segment x{mote_id{5}, 0x1234, 10, true, false, bytes{'h', 'i'}};
  CHECK(to_hex(encode(x)) == "000512340a016869");
  const auto back = decode_segment(encode(x));
  REQUIRE(back);
  CHECK(*back == x);
  CHECK(to_hex(encode({mote_id{5}, 0x1234, 10, false, true, {}})) == "000512340a02");
}

TEST_CASE("a segment that is short, long or has impossible flags is refused", "[transport]") {
  CHECK(decode_segment(*from_hex("000512340a")).error() == errc::truncated);
  CHECK(decode_segment(*from_hex("000512340a04")).error() == errc::bad_value);
  CHECK(decode_segment(*from_hex("000512340a03")).error() == errc::bad_value);
  CHECK(decode_segment(*from_hex("000512340a0268")).error() == errc::bad_value);
  bytes largest(header_size + payload_max);
  CHECK(decode_segment(largest));
  largest.push_back(0);
  CHECK(decode_segment(largest).error() == errc::too_long);
}
