#include <array>

#include "stream/message.hpp"
#include "stream/sensor_record.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::stream;

namespace {

bytes joined(bytes head, const bytes& tail) {
  head.insert(head.end(), tail.begin(), tail.end());
  return head;
}

} // namespace

TEST_CASE("messages of streams have their layout and come back as they were",
          "[stream][STR-13][STR-16]") {
  const std::array<std::pair<message, bytes>, 10> all{{
      {open_message{0x1234}, {1, 0x12, 0x34}},
      {open_message{0x1234, 5}, {1, 0x12, 0x34, 5}},
      {open_message{0x1234, 0, 9, {}}, {1, 0x12, 0x34, 0, 0, 9}},
      {open_message{0x1234, 5, 0, {{}}}, {1, 0x12, 0x34, 5, 0, 0, 0}},
      {open_message{7, 0, 0x0102, {{0xca}, {}, {0xfe, 0xbe}}},
       {1, 0, 7, 0, 1, 2, 1, 0xca, 0, 2, 0xfe, 0xbe}},
      {open_message{7, 1, 0xffff, {bytes(255)}}, joined({1, 0, 7, 1, 0xff, 0xff, 255}, bytes(255))},
      {ack_message{0x0102}, {4, 1, 2}},
      {open_ack_message{0x1234}, {2, 0x12, 0x34}},
      {write_message{0x0102, {0xca, 0xfe}}, {3, 1, 2, 0xca, 0xfe}},
      {write_message{0xffff, {}}, {3, 0xff, 0xff}},
  }};
  for (const auto& [content, octets] : all) {
    CHECK(encode(content) == octets);
    const auto decoded = decode_message(octets);
    REQUIRE(decoded);
    CHECK(*decoded == content);
  }
}

TEST_CASE("messages of streams that are cut, too long or unknown are told apart", "[stream]") {
  CHECK(decode_message({}).error() == errc::truncated);
  for (std::uint8_t kind = 1; kind <= 4; ++kind) {
    CHECK(decode_message(bytes{kind}).error() == errc::truncated);
    CHECK(decode_message(bytes{kind, 0}).error() == errc::truncated);
  }
  CHECK(decode_message(bytes{1, 0, 7, 0}).error() == errc::bad_value);
  CHECK(decode_message(bytes{1, 0, 7, 1, 0}).error() == errc::truncated);
  CHECK(decode_message(bytes{1, 0, 7, 1, 0, 0}).error() == errc::bad_value);
  CHECK(decode_message(bytes{1, 0, 7, 0, 0, 0}).error() == errc::bad_value);
  CHECK(decode_message(bytes{1, 0, 7, 0, 0, 5, 2, 9}).error() == errc::truncated);
  CHECK(decode_message(bytes{4, 0, 7, 0}).error() == errc::too_long);
  CHECK(decode_message(bytes{2, 0, 7, 0}).error() == errc::too_long);
  CHECK(decode_message(bytes{0, 0, 7}).error() == errc::unsupported);
  CHECK(decode_message(bytes{5, 0, 7}).error() == errc::unsupported);
}

TEST_CASE("a sensor record is 12 octets in network byte order", "[stream][A-35]") {
  const sensor_record x{{island_id{0x01020304}, mote_id{0x0506}}, 0x0708090a, -2};
  const bytes octets{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 0xff, 0xfe};
  CHECK(encode(x) == octets);
  const auto decoded = decode_sensor_record(octets);
  REQUIRE(decoded);
  CHECK(*decoded == x);
  CHECK(decode_sensor_record(byte_view(octets).first(11)).error() == errc::truncated);
  CHECK(decode_sensor_record(bytes(13)).error() == errc::too_long);
}
