#include "serial/frame.hpp"

#include <algorithm>

#include "support/catch.hpp"
#include "support/vectors.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using namespace rubicon::serial::test;

namespace {

bytes feed(frame_decoder& decoder, std::string_view text) {
  bytes sequences;
  for (const auto octet : hex(text))
    if (const auto x = decoder.on_octet(octet))
      sequences.push_back(x->sequence);
  return sequences;
}

/// Content of a packet frame that is `size` octets between its flags, CRC included.
frame frame_of_size(std::size_t size) {
  return {frame_type::packet, 0, bytes(size - 3, 0x11)};
}

bytes sealed(bytes content) {
  const unsigned crc = crc16(content);
  content.push_back(static_cast<std::uint8_t>(crc & 0xffU));
  content.push_back(static_cast<std::uint8_t>(crc >> 8));
  content.insert(content.begin(), flag_octet);
  content.push_back(flag_octet);
  return content;
}

} // namespace

TEST_CASE("the CRC has the check values of CRC-16/XMODEM", "[serial][A-50]") {
  CHECK(crc16(to_bytes("123456789")) == 0x31c3);
  CHECK(crc16({}) == 0);
  CHECK(crc16(bytes{0x00}) == 0);
  CHECK(crc16(bytes{0x45}) == 0x1861);
  CHECK(crc16(to_bytes("6789"), crc16(to_bytes("12345"))) == 0x31c3);
}

TEST_CASE("frames encode to and decode from what TinyOS tools write and read", "[serial][A-50]") {
  std::size_t cases = 0;
  for (const auto& x : rubicon::test::read_cases("tinyos/serial-frames.txt")) {
    if (!x.at("name").starts_with("ser-"))
      continue;
    ++cases;
    CAPTURE(x.at("name"));
    frame expected{static_cast<frame_type>(hex(x.at("type"))[0]), 0, {}};
    if (x.at("seq") != "-")
      expected.sequence = hex(x.at("seq"))[0];
    if (x.at("packet") != "-")
      expected.packet = hex(x.at("packet"));
    CHECK(to_hex(encode(expected)) == to_hex(hex(x.at("wire"))));
    CHECK(decode_all(hex(x.at("wire"))) == std::vector{expected});
  }
  CHECK(cases == 12);
}

TEST_CASE("a stream gives the packets that TinyOS tools deliver", "[serial][A-50][GW-16]") {
  std::size_t cases = 0;
  for (const auto& x : rubicon::test::read_cases("tinyos/serial-frames.txt")) {
    if (!x.at("name").starts_with("str-"))
      continue;
    ++cases;
    CAPTURE(x.at("name"));
    std::vector<bytes> packets;
    for (const auto& one : decode_all(hex(x.at("wire"))))
      packets.push_back(one.packet);
    CHECK(packets == hex_list(x.at("expect")));
  }
  CHECK(cases == 10);
}

TEST_CASE("every type, sequence and length of a frame survives the wire", "[serial][A-50]") {
  for (const auto type :
       {frame_type::ack, frame_type::packet_with_ack, frame_type::packet, frame_type::unknown}) {
    const bool numbered = type == frame_type::ack || type == frame_type::packet_with_ack;
    for (unsigned sequence = 0; sequence < (numbered ? 256U : 1U); ++sequence) {
      for (const std::size_t size : {0U, 1U, 2U, 122U, 251U, 252U}) {
        // Without a sequence number a frame needs one octet to be long enough.
        if ((type == frame_type::ack && size > 0) || (!numbered && size == 0))
          continue;
        frame x{type, static_cast<std::uint8_t>(sequence), {}};
        for (std::size_t i = 0; i < size; ++i)
          x.packet.push_back(static_cast<std::uint8_t>(i + sequence));
        REQUIRE(decode_all(encode(x)) == std::vector{x});
      }
    }
  }
}

TEST_CASE("a frame contains no flag but its own two", "[serial][A-50]") {
  for (unsigned value = 0; value < 256; ++value) {
    const auto wire = encode(frame{frame_type::packet_with_ack, static_cast<std::uint8_t>(value),
                                   bytes(20, static_cast<std::uint8_t>(value))});
    CHECK(std::count(wire.begin(), wire.end(), flag_octet) == 2);
    CHECK(wire.front() == flag_octet);
    CHECK(wire.back() == flag_octet);
  }
}

TEST_CASE("a decoder takes 256 octets between flags and no more", "[serial][A-50][NFR-03]") {
  CHECK(decode_all(encode(frame_of_size(frame_octets_max))).size() == 1);

  frame_decoder decoder;
  const auto feed_all = [&](const bytes& wire) {
    int frames = 0;
    for (const auto octet : wire)
      frames += decoder.on_octet(octet) ? 1 : 0;
    return frames;
  };
  CHECK(feed_all(encode(frame_of_size(frame_octets_max + 1))) == 0);
  CHECK(decoder.counters().too_long == 1);
  CHECK(feed_all(encode(frame_of_size(10))) == 1);
  CHECK(decoder.counters().good == 1);
  CHECK(decoder.counters().bad_crc == 0);
}

TEST_CASE("a decoder counts what it drops by cause and goes on", "[serial][A-50][GW-16]") {
  const std::string good = "7e43263b1c7e";
  struct row {
    const char* wire;
    std::uint64_t frame_counters::*cause;
  };
  const row table[] = {
      {"7e43263b1d7e", &frame_counters::bad_crc},
      {"7e437e", &frame_counters::too_short},
      {"7e43263b7e", &frame_counters::too_short},
      {"7e437d7e", &frame_counters::aborted},
  };
  for (const auto& row : table) {
    CAPTURE(row.wire);
    frame_decoder decoder;
    CHECK(feed(decoder, row.wire).empty());
    CHECK(decoder.counters().*row.cause == 1);
    CHECK(feed(decoder, good) == bytes{0x26});
    CHECK(decoder.counters().good == 1);
  }
  struct content_row {
    bytes content;
    std::uint64_t frame_counters::*cause;
  };
  const content_row contents[] = {
      {{0x43, 0x26, 0x00}, &frame_counters::malformed},
      {{0x40, 0x26}, &frame_counters::unknown_type},
      {{0x46, 0x26, 0x00}, &frame_counters::unknown_type},
      {{0x00, 0x00}, &frame_counters::unknown_type},
  };
  for (const auto& row : contents) {
    frame_decoder decoder;
    CHECK(feed(decoder, to_hex(sealed(row.content))).empty());
    CHECK(decoder.counters().*row.cause == 1);
    CHECK(feed(decoder, good) == bytes{0x26});
  }
}

TEST_CASE("an aborted frame takes the flag that aborts it along", "[serial][A-50]") {
  frame_decoder decoder;
  // The flag after the escape closes nothing and opens nothing: what follows is between frames.
  CHECK(feed(decoder, "7e437d7e43263b1c7e").empty());
  CHECK(feed(decoder, "43273b1c7e").empty()); // bad CRC: its opening flag was the last one above
  CHECK(decoder.counters().bad_crc == 1);
  CHECK(decoder.counters().aborted == 1);
}

TEST_CASE("idle flags and silence between frames count as nothing", "[serial][A-50]") {
  frame_decoder decoder;
  CHECK(feed(decoder, "11227e7e7e43263b1c7e7e7e").size() == 1);
  CHECK(decoder.counters().good == 1);
  CHECK(decoder.counters().too_short + decoder.counters().bad_crc == 0);
}

TEST_CASE("an unknown-type answer carries the refused type", "[serial][A-50]") {
  const auto frames = decode_all(hex("7eff01de137e"));
  REQUIRE(frames.size() == 1);
  CHECK(frames[0] == frame{frame_type::unknown, 0, bytes{0x01}});
}

TEST_CASE("one changed octet of a frame is always noticed", "[serial][A-50][GW-16]") {
  const frame original{frame_type::packet_with_ack, 0x26, hex("00ffff0000022206017e")};
  const auto wire = encode(original);
  for (std::size_t at = 0; at < wire.size(); ++at) {
    for (unsigned flip = 1; flip < 256; ++flip) {
      auto noisy = wire;
      noisy[at] = static_cast<std::uint8_t>(noisy[at] ^ flip);
      for (const auto& x : decode_all(noisy))
        REQUIRE(x == original);
    }
  }
}
