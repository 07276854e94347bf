#include "serial/packet.hpp"

#include "serial/frame.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using namespace rubicon::serial::test;

TEST_CASE("a serial active message has TinyOS's layout", "[serial][A-50]") {
  const auto x = decode_am_packet(hex("00 00 02 fe 01 03 22 93 0a 0b 0c"));
  REQUIRE(x);
  CHECK(x->destination == 0x0002);
  CHECK(x->source == 0xfe01);
  CHECK(x->group == 0x22);
  CHECK(x->am_type == 0x93);
  CHECK(x->payload == bytes{0x0a, 0x0b, 0x0c});
}

TEST_CASE("serial active messages of TinyOS tools decode and encode back", "[serial][A-50]") {
  std::size_t cases = 0;
  for (const auto& x : rubicon::test::read_cases("tinyos/serial-frames.txt")) {
    if (!x.contains("packet") || x.at("packet") == "-")
      continue;
    CAPTURE(x.at("name"));
    const auto packet = hex(x.at("packet"));
    const auto decoded = decode_am_packet(packet);
    if (packet[0] != am_dispatch) {
      REQUIRE_FALSE(decoded);
      CHECK(decoded.error() == errc::unsupported);
      continue;
    }
    ++cases;
    REQUIRE(decoded);
    CHECK(encode(*decoded) == packet);
  }
  CHECK(cases == 8);
}

TEST_CASE("every length of an active message survives encoding", "[serial][A-50]") {
  for (std::size_t size = 0; size <= am_payload_max; ++size) {
    for (const unsigned value : {0x0000U, 0x0001U, 0x00ffU, 0xff00U, 0xffffU}) {
      am_packet x;
      x.destination = static_cast<std::uint16_t>(value);
      x.source = static_cast<std::uint16_t>(~value);
      x.group = static_cast<std::uint8_t>(size);
      x.am_type = static_cast<std::uint8_t>(255 - size);
      x.payload.assign(size, 0x7e);
      const auto packet = encode(x);
      REQUIRE(packet.size() == 8 + size);
      const auto decoded = decode_am_packet(packet);
      REQUIRE(decoded);
      REQUIRE(*decoded == x);
    }
  }
}

TEST_CASE("a malformed active message is refused with its cause", "[serial][A-50]") {
  struct row {
    const char* what;
    bytes packet;
    errc cause;
  };
  bytes above_limit = hex("00 00 02 00 00 73 22 06");
  above_limit.insert(above_limit.end(), 0x73, 0x01);
  const row table[] = {
      {"nothing", {}, errc::truncated},
      {"dispatch alone", {0x00}, errc::truncated},
      {"header cut", hex("00 00 02 00 00 00 22"), errc::truncated},
      {"payload cut", hex("00 00 02 00 00 03 22 06 01 02"), errc::truncated},
      {"more than the length says", hex("00 00 02 00 00 01 22 06 01 02"), errc::too_long},
      {"115 octets", above_limit, errc::too_long},
      {"length field above the limit", hex("00 00 02 00 00 ff 22 06"), errc::too_long},
      {"another dispatch", hex("02 0f 41 88 11 22 00 ff ff"), errc::unsupported},
      {"another dispatch, short", {0xff}, errc::unsupported},
  };
  for (const auto& row : table) {
    CAPTURE(row.what);
    const auto x = decode_am_packet(row.packet);
    REQUIRE_FALSE(x);
    CHECK(x.error() == row.cause);
  }
}
