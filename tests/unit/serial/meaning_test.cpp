// What packets of TinyOS's own programs say.
#include "core/numbers/random.hpp"
#include "serial/meaning.hpp"
#include "serial/raw_packet.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::serial;

namespace {

std::string meaning(std::uint8_t am_type, std::string_view hex) {
  am_packet x;
  x.am_type = am_type;
  x.payload = from_hex(hex).value();
  return meaning_of(x);
}

} // namespace

TEST_CASE("packets of programs that come with TinyOS are recognised by type and length",
          "[serial][GW-17]") {
  CHECK(meaning(6, "0007") == "count 7");
  CHECK(meaning(6, "0064 0007") == "mote 100 count 7");
  CHECK(meaning(6, "00").empty());
  CHECK(meaning(6, "000700").empty());
  CHECK(meaning(0x93, "0001 01f4 0007 0003 0001 0002 0003 0004 0005 0006 0007 0008 0009 000a") ==
        "mote 7 interval 500 ms, 3 so far: 1 2 3 4 5 6 7 8 9 10");
  CHECK(meaning(0x93, "0001 01f4 0007 0003 0001 0002 0003 0004 0005") ==
        "mote 7 interval 500 ms, 3 so far: 1 2 3 4 5");
  CHECK(meaning(0x93, "0001 0400 0007 0003 0064 000a 00ff 0002") ==
        "mote 7 interval 1024 ms, 3 so far: reading 100 etx 10 link of 255 to 2"); // MViz
  CHECK(meaning(0x93, "0001 0400 0007 0003 0064 00ff 0002") ==
        "mote 7 interval 1024 ms, 3 so far: reading 100 link of 255 to 2");
  CHECK(meaning(0x93, "0001 01f4 0007").empty());
  CHECK(meaning(0x93, "0001 01f4 0007 0003 00").empty());
  CHECK(meaning(100, "48656c6c6f2066726f6d20746865206d6f74650a00000000000000000000") ==
        "printf \"Hello from the mote\\n\"");
  CHECK(meaning(100, "1b5b324a") == "printf \"\\x1b[2J\""); // which would clear a terminal
  CHECK(meaning(100, "") == "printf \"\"");
  CHECK(meaning(0x89, "002a").empty());
}

TEST_CASE("packets of CTP, dissemination and FTSP are shown with their fields", "[serial][GW-17]") {
  CHECK(meaning(0x71, "00 02 012c 0008 05 93 cafe") ==
        "ctp origin 8 hops 2 etx 300 sequence 5 collection 147: cafe");
  CHECK(meaning(0x71, "c0 00 0000 0008 05 93") ==
        "ctp origin 8 hops 0 etx 0 sequence 5 collection 147, asks for a route, congested");
  CHECK(meaning(0x71, "00 02 012c 0008 05").empty());
  CHECK(meaning(0x70, "00 07 00 0003 0014") == "ctp beacon sequence 7 parent 3 etx 20");
  CHECK(meaning(0x70, "02 07 80 ffff ffff 0003 ff 0004 7f") ==
        "ctp beacon sequence 7 parent 65535 etx 65535, asks for a route, hears mote 3 of 255, mote "
        "4 of 127");
  CHECK(meaning(0x70, "40 0003 0014") == "ctp beacon parent 3 etx 20, congested");
  CHECK(meaning(0x70, "01 07 00 0003 0014").empty()); // a link is missing
  CHECK(meaning(0x70, "00 07 00 0003 0014 00").empty());
  CHECK(meaning(0x60, "1234 00010003 cafe") == "dissemination key 4660 sequence 65539: cafe");
  CHECK(meaning(0x60, "1234 000100").empty());
  CHECK(meaning(0x61, "1234") == "dissemination probe key 4660");
  CHECK(meaning(0x61, "12").empty());
  CHECK(meaning(0x3e, "0001 0002 03 00010000") == "ftsp root 1 mote 2 sequence 3 time 65536");
  CHECK(meaning(0x3e, "0001 0002 03 000100").empty());
}

TEST_CASE("of a time-stamped message its time, its type and what is in it are shown",
          "[serial][GW-17]") {
  CHECK(meaning(0x3d, "0064 0007 06 00000200") == "stamped 512 type 6, mote 100 count 7");
  CHECK(meaning(0x3d, "cafe 89 ffffffff") == "stamped 4294967295 type 137");
  CHECK(meaning(0x3d, "06 00000200") == "stamped 512 type 6");
  CHECK(meaning(0x3d, "3d 00000001 3d 00000200") == "stamped 512 type 61");
  CHECK(meaning(0x3d, "00000200").empty());
}

TEST_CASE("whatever comes means something in one line or nothing", "[serial][GW-17]") {
  random_stream rng(5);
  for (int i = 0; i < 20'000; ++i) {
    am_packet x;
    x.am_type = static_cast<std::uint8_t>(rng.below(256));
    x.payload.resize(rng.below(am_payload_max + 1));
    for (auto& octet : x.payload)
      octet = static_cast<std::uint8_t>(rng.below(256));
    for (const auto c : meaning_of(x))
      CHECK(static_cast<unsigned char>(c) >= ' ');
  }
}

TEST_CASE("a frame of a CC1000 has the header of a serial packet", "[serial][GW-17]") {
  const auto x = decode_any_packet(from_hex("01 ffff 0007 02 22 06 002a").value());
  REQUIRE(x);
  CHECK(*x == am_packet{0xffff, 7, 0x22, 6, bytes{0, 42}});
  CHECK(decode_any_packet(from_hex("01 ffff 0007 03 22 06 002a").value()).error() ==
        errc::truncated);
  CHECK(decode_any_packet(bytes{1}).error() == errc::truncated);
  CHECK(decode_any_packet(bytes{3, 0, 0}).error() == errc::unsupported);
}
