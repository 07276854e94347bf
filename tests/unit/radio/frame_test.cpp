#include <algorithm>
#include <array>
#include <string>

#include "core/numbers/random.hpp"
#include "radio/frame.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

bytes with_fcs(bytes octets) {
  const auto sum = fcs(octets);
  octets.push_back(static_cast<std::uint8_t>(sum & 0xff));
  octets.push_back(static_cast<std::uint8_t>(sum >> 8));
  return octets;
}

bytes octets_of(const std::string& hex) {
  return from_hex(hex).value();
}

} // namespace

TEST_CASE("the FCS has its catalogue check value", "[radio][frame]") {
  CHECK(fcs(to_bytes("123456789")) == 0x2189);
  CHECK(fcs(octets_of("02006a")) == 0x79e4); // the standard's worked example
  CHECK(fcs({}) == 0);
  bytes octets;
  for (std::size_t size = 0; size <= psdu_max; ++size) { // whatever is left of whole steps
    unsigned crc = 0;
    for (const auto octet : octets) {
      crc ^= octet;
      for (int bit = 0; bit < 8; ++bit)
        crc = (crc & 1) != 0 ? (crc >> 1) ^ 0x8408U : crc >> 1;
    }
    CHECK(fcs(octets) == crc);
    octets.push_back(static_cast<std::uint8_t>(37 * size + 11));
  }
}

TEST_CASE("frames of TinyOS decode and encode back", "[radio][frame][golden]") {
  int decoded = 0;
  for (const auto& vector : test::read_cases("tinyos/radio-frames.txt")) {
    INFO(vector.at("name"));
    const auto psdu = octets_of(vector.at("psdu"));
    CHECK(octets_of(vector.at("phr")) == bytes{static_cast<std::uint8_t>(psdu.size())});
    CHECK(air_time(psdu.size()) == std::chrono::microseconds(std::stoi(vector.at("airtime_us"))));
    const auto x = decode(psdu);
    if (vector.at("name") == "rad-06") { // T-frame: no network octet
      REQUIRE_FALSE(x);
      CHECK(x.error() == errc::unsupported);
    } else if (vector.at("fcs") == "invalid") {
      REQUIRE_FALSE(x);
      CHECK(x.error() == errc::bad_checksum);
    } else {
      REQUIRE(x);
      CHECK(encode(*x) == psdu);
      ++decoded;
    }
  }
  CHECK(decoded == 6);
}

TEST_CASE("the fields of a frame stand where TinyOS puts them", "[radio][frame]") {
  const auto psdu = octets_of("618812220001000300 3f06 0001 75ed"); // rad-02
  const auto x = decode(psdu);
  REQUIRE(x);
  CHECK(x->type == frame_type::data);
  CHECK(x->ack_request);
  CHECK(x->dsn == 0x12);
  CHECK(x->pan == default_pan);
  CHECK(x->destination == mote_id{1});
  CHECK(x->source == mote_id{3});
  CHECK(x->am_type == 6);
  CHECK(to_hex(x->payload) == "0001");

  const auto ack = decode(octets_of("0200122b86")); // rad-03
  REQUIRE(ack);
  CHECK(ack->type == frame_type::ack);
  CHECK(ack->dsn == 0x12);
}

TEST_CASE("any field values survive encoding", "[radio][frame][NET-14]") {
  random_stream rng(3);
  for (std::size_t size = 0; size <= payload_max; ++size) {
    for (const bool ack : {false, true}) {
      bytes octets(size);
      for (auto& octet : octets)
        octet = static_cast<std::uint8_t>(rng.next());
      frame x;
      x.ack_request = ack;
      x.dsn = static_cast<std::uint8_t>(rng.next());
      x.pan = static_cast<std::uint16_t>(rng.next());
      x.destination = mote_id{static_cast<std::uint16_t>(rng.next())};
      x.source = mote_id{static_cast<std::uint16_t>(rng.next())};
      x.am_type = static_cast<std::uint8_t>(rng.next());
      x.payload = octets;
      const auto psdu = encode(x);
      CHECK(psdu.size() == overhead + size);
      CHECK(psdu.size() <= psdu_max);
      const auto y = decode(psdu);
      REQUIRE(y);
      CHECK(y->ack_request == ack);
      CHECK(y->dsn == x.dsn);
      CHECK(y->pan == x.pan);
      CHECK(y->destination == x.destination);
      CHECK(y->source == x.source);
      CHECK(y->am_type == x.am_type);
      CHECK(to_bytes(y->payload) == octets);
    }
  }
}

TEST_CASE("what is not a frame of ours is refused with its reason", "[radio][frame]") {
  const bytes good = octets_of("418811220001000300 3f06");
  const auto changed = [&](std::size_t at, std::uint8_t value) {
    auto x = good;
    x[at] = value;
    return with_fcs(x);
  };
  struct illegal {
    bytes psdu;
    errc why;
  };
  const std::array cases{
      illegal{{}, errc::truncated},
      illegal{octets_of("0200"), errc::truncated},
      illegal{with_fcs(octets_of("0200")), errc::truncated},                  // ack without DSN
      illegal{with_fcs(octets_of("02000102")), errc::too_long},               // ack with more
      illegal{with_fcs(octets_of("41881122000100030 03f")), errc::truncated}, // no AM type
      illegal{with_fcs(bytes(126, 0x41)), errc::too_long},                    // 128 octets
      illegal{changed(0, 0x40), errc::unsupported},                           // beacon
      illegal{changed(0, 0x43), errc::unsupported},                           // command
      illegal{changed(0, 0x49), errc::unsupported},                           // security
      illegal{changed(0, 0x51), errc::unsupported},                           // frame pending
      illegal{changed(0, 0x01), errc::unsupported},                           // two PAN ids
      illegal{changed(1, 0x8c), errc::unsupported},                           // long destination
      illegal{changed(1, 0xc8), errc::unsupported},                           // long source
      illegal{changed(1, 0x80), errc::unsupported},                           // no destination
      illegal{changed(1, 0x98), errc::unsupported}, // another frame version
      illegal{changed(9, 0x41), errc::unsupported}, // a LoWPAN frame
  };
  CHECK(decode(with_fcs(good)));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    INFO(i);
    const auto x = decode(cases[i].psdu);
    REQUIRE_FALSE(x);
    CHECK(x.error() == cases[i].why);
  }
}

TEST_CASE("every flipped bit is noticed", "[radio][frame]") {
  const auto good = with_fcs(octets_of("418811220001000300 3f06 0001"));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto x = good;
    x[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    const auto y = decode(x);
    REQUIRE_FALSE(y);
    CHECK(y.error() == errc::bad_checksum);
  }
}

TEST_CASE("a 100-octet frame occupies the channel for 3.4 ms", "[radio][frame][NET-15]") {
  CHECK(air_time(100) == 3392us);
  CHECK(air_time(ack_size) == 352us);
  CHECK(air_time(psdu_max) == 4256us);
}
