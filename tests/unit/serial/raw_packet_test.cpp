// Raw frames of IEEE 802.15.4, as a base station's second variant gives them.
#include <algorithm>
#include <string>

#include "core/numbers/random.hpp"
#include "serial/raw_packet.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace rubicon;
using namespace rubicon::serial;

namespace {

/// The packet that a base station makes of what it has received: it keeps the FCS.
bytes packet_of(const std::string& phr, const std::string& psdu) {
  auto out = from_hex("02" + phr + psdu).value();
  out.resize(out.size() - 2);
  return out;
}

errc error_of(const std::string& hex) {
  const auto x = decode_raw_packet(from_hex(hex).value());
  REQUIRE(!x);
  return x.error();
}

/// 41 88, sequence 17, to all of PAN 0022, from 3, AM type 6, 0001.
const std::string blink = "020f41881122 00ffff03003f060001";

} // namespace

TEST_CASE("raw frames of TinyOS's motes are active messages", "[serial][golden][GW-17]") {
  int messages = 0;
  for (const auto& vector : rubicon::test::read_cases("tinyos/radio-frames.txt")) {
    INFO(vector.at("name"));
    const auto packet = packet_of(vector.at("phr"), vector.at("psdu"));
    const auto x = decode_raw_packet(packet);
    REQUIRE(x);
    const auto message = decode_any_packet(packet);
    if (vector.at("name") == "rad-03") {
      CHECK(x->kind == raw_kind::ack);
      CHECK(x->sequence == 0x12);
      CHECK(!x->destination.address);
      CHECK(!x->source.address);
      CHECK(x->body.empty());
    }
    if (vector.at("name") == "rad-03" || vector.at("name") == "rad-06") {
      CHECK(!am_packet_in(*x)); // an acknowledgement; a T-frame
      REQUIRE(!message);
      CHECK(message.error() == errc::unsupported);
      continue;
    }
    REQUIRE(message);
    CHECK(message->group == 0x22);
    ++messages;
    if (!x->asks_ack && *x->destination.pan < 256)
      CHECK(encode_raw(*message, x->sequence) == packet);
  }
  CHECK(messages >= 5);
}

TEST_CASE("the fields of a raw frame stand where the standard puts them", "[serial][GW-17]") {
  const auto x = decode_raw_packet(from_hex("020f618812220001000300 3f060001").value());
  REQUIRE(x);
  CHECK(x->kind == raw_kind::data);
  CHECK(x->asks_ack);
  CHECK(!x->is_pending);
  CHECK(!x->is_secured);
  CHECK(x->sequence == 0x12);
  CHECK(x->destination == raw_end{0x22, 1, false});
  CHECK(x->source == raw_end{{}, 3, false});
  const auto message = am_packet_in(*x);
  REQUIRE(message);
  CHECK(*message == am_packet{1, 3, 0x22, 6, bytes{0, 1}});

  // Long addresses, a PAN each: no active message.
  const auto both = decode_raw_packet(
      from_hex("021b01cc05 2200 0102030405060708 2300 1112131415161718 aabb").value());
  REQUIRE(both);
  CHECK(both->destination == raw_end{0x22, 0x0807060504030201, true});
  CHECK(both->source == raw_end{0x23, 0x1817161514131211, true});
  CHECK(to_hex(both->body) == "aabb");
  CHECK(!am_packet_in(*both));

  const auto beacon = decode_raw_packet(from_hex("020b00800122000000ff0f").value());
  REQUIRE(beacon);
  CHECK(beacon->kind == raw_kind::beacon);
  CHECK(!beacon->destination.address);
  CHECK(beacon->source == raw_end{0x22, 0, false});
}

TEST_CASE("raw frames that are none are refused", "[serial][GW-17]") {
  CHECK(error_of("02") == errc::truncated);
  CHECK(error_of("00ffff00000022060001") == errc::unsupported);
  CHECK(error_of("0204418811") == errc::bad_value); // shorter than an acknowledgement
  CHECK(error_of("0280" + std::string(2 * 126, '0')) == errc::too_long);
  CHECK(error_of("020e41881122 00ffff03003f060001") == errc::too_long);  // one octet more than said
  CHECK(error_of("021041881122 00ffff03003f060001") == errc::truncated); // one less
  CHECK(error_of("020f44881122 00ffff03003f060001") == errc::bad_value); // reserved type
  CHECK(error_of("020f41841122 00ffff03003f060001") == errc::bad_value); // reserved address mode
  CHECK(error_of("020541cc11") == errc::truncated);                      // no room for addresses
  const auto whole = from_hex(blink).value();
  REQUIRE(decode_raw_packet(whole));
  for (std::size_t size = 0; size < whole.size(); ++size)
    CHECK(!decode_raw_packet(byte_view(whole).first(size)));
  auto secured = whole;
  secured[2] |= 0x08;
  REQUIRE(decode_raw_packet(secured));
  CHECK(!am_packet_in(*decode_raw_packet(secured)));
}

TEST_CASE("active messages become raw frames and come back", "[serial][GW-17]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    random_stream rng(seed);
    for (const std::size_t size : {std::size_t{0}, std::size_t{rng.below(114)}, am_payload_max}) {
      am_packet x;
      x.destination = static_cast<std::uint16_t>(rng.below(65536));
      x.source = static_cast<std::uint16_t>(rng.below(65536));
      x.group = static_cast<std::uint8_t>(rng.below(256));
      x.am_type = static_cast<std::uint8_t>(rng.below(256));
      x.payload.resize(size);
      std::ranges::generate(x.payload, [&] { return static_cast<std::uint8_t>(rng.below(256)); });
      const auto packet = encode_raw(x, static_cast<std::uint8_t>(seed));
      const auto back = decode_any_packet(packet);
      REQUIRE(back);
      CHECK(*back == x);
      // A changed octet is another frame, or none: never more than came.
      for (int i = 0; i < 50; ++i) {
        auto bad = packet;
        bad[rng.below(bad.size())] = static_cast<std::uint8_t>(rng.below(256));
        if (const auto found = decode_any_packet(bad))
          CHECK(found->payload.size() <= am_payload_max);
      }
    }
  }
}
