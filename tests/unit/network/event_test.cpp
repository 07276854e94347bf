#include "network/sink_event.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::network;

TEST_CASE("every event between sink and gateway survives the line", "[network][DIS-03]") {
  const std::pair<sink_event, std::string> rows[] = {
      {mote_joined{mote_id{7}, 2, 101, bytes{0xaa}}, "0100070000000200000065aa"},
      {mote_left{mote_id{7}, leave_cause::silence}, "02000702"},
      {roster{4, 1, 2, {{mote_id{7}, 2}, {mote_id{8}, 0}}}, "0300040102000700000002000800000000"},
      {roster{5, 0, 1, {}}, "0300050001"},
      {describe{mote_id{7}}, "040007"},
      {time_request{0x0102}, "060102000000000000000000000000"},
      {gateway_poll{1, 0x0203, true}, "08000000010000020301"},
      {gateway_answer{1, 0x0203}, "090000000100000203"},
      {time_answer{0x0102, std::chrono::microseconds(0x0304050607),
                   std::chrono::microseconds(0x08090a0b)},
       "070102000000030405060708090a0b"},
      {time_answer{0x0102, // the last microsecond of 2149
                   std::chrono::microseconds(0x142e2f9efdffff), std::chrono::microseconds(1)},
       "07010200142e2f9efdffff00000001"},
  };
  for (const auto& [event, octets] : rows) {
    CHECK(to_hex(encode(event)) == octets);
    const auto back = decode_sink_event(*from_hex(octets));
    REQUIRE(back);
    CHECK(*back == event);
  }
}

TEST_CASE("a question for the time takes the line as long as its answer", "[network][CLK-08]") {
  CHECK(encode(time_request{1}).size() == encode(time_answer{1, {}}).size());
}

TEST_CASE("a full roster page fits a serial packet", "[network]") {
  roster page{1, 0, 1, {}};
  for (std::uint16_t i = 0; i < roster_entries_max; ++i)
    page.entries.push_back({mote_id{i}, 0});
  CHECK(encode(page).size() <= 114);
  auto octets = encode(page);
  octets.insert(octets.end(), 6, 0);
  CHECK(decode_sink_event(octets).error() == errc::too_long);
}

TEST_CASE("events that make no sense are refused", "[network]") {
  CHECK(decode_sink_event({}).error() == errc::truncated);
  CHECK(decode_sink_event(*from_hex("0a")).error() == errc::unsupported);
  CHECK(decode_sink_event(*from_hex("01000700")).error() == errc::truncated);
  CHECK(decode_sink_event(*from_hex("02000709")).error() == errc::bad_value);
  CHECK(decode_sink_event(*from_hex("0200070200")).error() == errc::too_long);
  CHECK(decode_sink_event(*from_hex("0300040202")).error() == errc::bad_value);
  CHECK(decode_sink_event(*from_hex("03000400010007")).error() == errc::truncated);
  CHECK(decode_sink_event(*from_hex("0400")).error() == errc::truncated);
  CHECK(decode_sink_event(*from_hex("06010200")).error() == errc::truncated);
  CHECK(decode_sink_event(*from_hex("0601020000000000000001")).error() == errc::bad_value);
  CHECK(decode_sink_event(*from_hex("07010200142e2f9efe000000000000")).error() == errc::bad_value);
  CHECK(decode_sink_event(*from_hex("070102800000000000000000000000")).error() == errc::bad_value);
  CHECK(decode_sink_event(*from_hex("07010200000003040506070000000008")).error() == errc::too_long);
}
