#include "mote/join/descriptor.hpp"
#include "mote/join/management.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::mote;

TEST_CASE("a descriptor is a list of tagged fields", "[mote][DIS-01][DIS-09]") {
  const descriptor x{101, 0x3, 0x1, 7500};
  CHECK(to_hex(encode(x)) == "0104000000650204000000030304000000010404"
                             "00001d4c");
  const auto back = decode_descriptor(encode(x));
  REQUIRE(back);
  CHECK(*back == x);
}

TEST_CASE("a reader of descriptors skips tags it does not know", "[mote][DIS-09]") {
  const auto x = decode_descriptor(*from_hex("09021234010400000065"));
  REQUIRE(x);
  CHECK(x->type == 101);
}

TEST_CASE("broken descriptors are refused", "[mote]") {
  CHECK(decode_descriptor({}).error() == errc::unsupported);
  CHECK(decode_descriptor(*from_hex("02040000")).error() == errc::truncated);
  CHECK(decode_descriptor(*from_hex("010400000065 02")).error() == errc::truncated);
  CHECK(decode_descriptor(*from_hex("0102 0065")).error() == errc::bad_value);
}

TEST_CASE("component management messages survive the radio", "[mote][DIS-08]") {
  const std::pair<management, std::string> rows[] = {
      {join_request{7, 2, bytes{0xaa}}, "01000700000002aa"},
      {join_reply{7, island_id{1}, mote_id{5}, 1000, {}}, "02000700000001000500 0003e8"},
      {join_reply{7, island_id{1}, mote_id{5}, 1000, {island_id{21}, island_id{254}}},
       "02000700000001000500 0003e8 15fe"},
      {join_confirm{7, 2, bytes{0xaa}}, "03000700000002aa"},
      {leave_notice{}, "04"},
      {keep_alive{2, {}}, "050000000200"},
      {keep_alive{2, {true, false}}, "050000000201"},
      {keep_alive{2, {false, true}}, "050000000202"},
      {keep_alive{2, {}, 0x0a0b0c0d}, "0500000002000a0b0c0d"},
      {join_refusal{0x0102}, "080102"},
      {rejoin_prompt{}, "06"},
      {slot_notice{0x0102, {3, 4}}, "070102 0003 0004"},
      {slot_grant{{0x0102, 4}}, "090102 0004"},
  };
  for (const auto& [message, octets] : rows) {
    CHECK(encode(message) == *from_hex(octets));
    const auto back = decode_management(encode(message));
    REQUIRE(back);
    CHECK(*back == message);
  }
}

TEST_CASE("component management messages that are short, long or unknown are refused", "[mote]") {
  CHECK(decode_management({}).error() == errc::truncated);
  CHECK(decode_management(*from_hex("0100")).error() == errc::truncated);
  CHECK(decode_management(*from_hex("02000700000001")).error() == errc::truncated);
  CHECK(decode_management(*from_hex("050000000204")).error() == errc::bad_value);
  CHECK(decode_management(*from_hex("05000000020000000000")).error() == errc::bad_value);
  CHECK(decode_management(*from_hex("0401")).error() == errc::too_long);
  CHECK(decode_management(*from_hex("0500000002000a0b0c")).error() == errc::truncated);
  CHECK(decode_management(*from_hex("08")).error() == errc::truncated);
  CHECK(decode_management(*from_hex("07000100020003 04")).error() == errc::too_long);
  CHECK(decode_management(*from_hex("09000100")).error() == errc::truncated);
  CHECK(decode_management(*from_hex("0a")).error() == errc::unsupported);
}
