#include "support/catch.hpp"
#include "transport/segment.hpp"

using namespace rubicon;
using namespace rubicon::transport;

TEST_CASE("segments keep their layout", "[transport][golden][WIR-04]") {
  const segment x{mote_id{0x0102}, 0x345, 0xa, 7, segment::kind::reliable, 21, {0xaa}};
  const auto octets = encode(x);
  CHECK(octets == bytes{0x01, 0x02, 0xa3, 0x45, 0x07, 21 << 3 | 1, 0xaa});
  CHECK(*decode_segment(octets) == x);
}

TEST_CASE("segments that mean nothing are refused", "[transport][WIR-04]") {
  CHECK(decode_segment(bytes{0, 1, 0, 2, 10}).error() == errc::truncated);
  CHECK(decode_segment(bytes(6 + 257)).error() == errc::too_long);
  CHECK(decode_segment(bytes{0, 1, 0, 2, 10, 3}));
  CHECK(decode_segment(bytes{0, 1, 0, 2, 10, 3, 1}).error() == errc::bad_value); // answer, payload
  CHECK(decode_segment(bytes{0, 1, 0, 2, 10, 4}).error() == errc::bad_value);
  CHECK(decode_segment(bytes{0, 1, 0, 2, 10, 2, 1}).error() == errc::bad_value); // answer, payload
  CHECK(decode_segment(bytes(6 + 256)));
}
