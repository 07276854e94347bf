#include <bit>
#include <limits>

#include "support/catch.hpp"
#include "synaptic/message.hpp"
#include "synaptic/parameters.hpp"

using namespace rubicon;
using namespace rubicon::synaptic;

TEST_CASE("messages have these octets", "[synaptic][SYN-12]") {
  struct {
    message content;
    const char* octets;
  } const cases[] = {
      {open_message{10, 2}, "11 0a 02"},
      {open_ack_message{}, "12"},
      {open_nak_message{}, "13"},
      {vector_message{0x01020304, 5, {1.0F, -2.5F}}, "14 01020304 05 3f800000 c0200000"},
      {stop_message{0x01020304}, "15 01020304"},
      {stop_ack_message{7}, "16 00000007"},
  };
  for (const auto& x : cases) {
    const auto octets = *from_hex(x.octets);
    CHECK(to_hex(encode(x.content)) == to_hex(octets));
    const auto decoded = decode_message(octets);
    REQUIRE(decoded);
    CHECK(*decoded == x.content);
    CHECK(is_synaptic(octets));
  }
}

TEST_CASE("values that are no numbers keep their bits", "[synaptic][SYN-12]") {
  const auto quiet = std::numeric_limits<float>::quiet_NaN();
  const auto octets = encode(vector_message{1, 0, {quiet, -0.0F}});
  const auto decoded = decode_message(octets);
  REQUIRE(decoded);
  const auto& values = std::get<vector_message>(*decoded).values;
  CHECK(std::bit_cast<std::uint32_t>(values[0]) == std::bit_cast<std::uint32_t>(quiet));
  CHECK(std::bit_cast<std::uint32_t>(values[1]) == 0x80000000);
}

TEST_CASE("a long vector takes as many packets as it needs", "[synaptic][SYN-12]") {
  std::vector<float> values(255);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(i);
  for (const std::size_t packet_max : {10U, 13U, 14U, 108U, 2000U}) {
    std::vector<float> joined;
    for (const auto& packet : encode_vector(9, values, packet_max)) {
      CHECK(packet.size() <= packet_max);
      const auto part = std::get<vector_message>(*decode_message(packet));
      CHECK(part.tick == 9);
      CHECK(part.first == joined.size());
      joined.insert(joined.end(), part.values.begin(), part.values.end());
    }
    CHECK(joined == values);
  }
  CHECK(encode_vector(9, values, 108).size() == 11);
  CHECK(encode_vector(9, std::vector<float>(25), 108).size() == 1);
}

TEST_CASE("malformed messages are refused", "[synaptic][SYN-12]") {
  struct {
    const char* octets;
    errc why;
  } const cases[] = {
      {"", errc::truncated},
      {"11", errc::truncated},
      {"11 01", errc::truncated},
      {"11 00 01", errc::bad_value},
      {"11 01 00", errc::bad_value},
      {"11 01 01 00", errc::too_long},
      {"12 00", errc::too_long},
      {"13 00", errc::too_long},
      {"14 00000001 00", errc::truncated},
      {"14 00000001 00 3f8000", errc::truncated},
      {"14 00000001 00 3f800000 00", errc::truncated},
      {"15 000000", errc::truncated},
      {"15 00000000 00", errc::too_long},
      {"16", errc::truncated},
      {"01 0000", errc::unsupported},
      {"17", errc::unsupported},
      {"10", errc::unsupported},
  };
  for (const auto& x : cases) {
    INFO(x.octets);
    const auto decoded = decode_message(*from_hex(x.octets));
    REQUIRE_FALSE(decoded);
    CHECK(decoded.error() == x.why);
  }
}

TEST_CASE("the first octet tells synaptic channels from streams", "[synaptic][SYN-17]") {
  for (int kind = 0; kind < 256; ++kind) {
    const bytes octets{static_cast<std::uint8_t>(kind)};
    CHECK(is_synaptic(octets) == (kind >= 0x11 && kind <= 0x16));
  }
  CHECK_FALSE(is_synaptic({}));
}

TEST_CASE("parameters are ten octets", "[synaptic][SYN-13]") {
  CHECK(parameters_size == 10);
  CHECK(parse_parameters(std::array<std::uint8_t, 10>{}) == parameters{});
  CHECK(parse_parameters(std::array<std::uint8_t, 10>{0, 255}) == parameters{});
  const std::array<std::uint8_t, 10> octets{0x01, 0x02, 3, 0x15};
  const parameters x{island_id{0x0102}, 3, 0x15};
  CHECK(parse_parameters(octets) == x);
  CHECK(encode(x) == octets);
  CHECK(encode(parameters{}) == std::array<std::uint8_t, 10>{0, 0, 1});
  auto reserved = octets;
  reserved[9] = 1;
  CHECK(parse_parameters(reserved) == x);
}
