#include "serial/mote_port.hpp"

#include "serial/cable/line_config.hpp"
#include "serial/frame.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using namespace rubicon::serial::test;

namespace {

constexpr std::uint32_t baud = 57600;

struct port_events {
  std::vector<bytes> payloads;
  bytes acks;
  std::vector<bytes> packets; ///< frames of packets that the mote wrote
};

void note(port_events& x, const mote_port_outputs& out) {
  for (const auto& one : all<received>(out)) {
    const auto packet = decode_am_packet(one.packet);
    REQUIRE(packet);
    x.payloads.push_back(packet->payload);
  }
  for (const auto& one : all<to_line>(out)) {
    for (const auto& written : decode_all(one.octets)) {
      if (written.type == frame_type::ack)
        x.acks.push_back(written.sequence);
      else
        x.packets.push_back(written.packet);
    }
  }
}

/// A mote whose UART receives octets at line speed, one by one or a whole text at once.
struct bench {
  explicit bench(mote_port_config config = {}) : port(config) {}

  port_events feed(byte_view octets, bool whole = false) {
    port_events x;
    if (whole) {
      now += transmission_time(octets.size(), baud);
      note(x, port.on_bytes(octets, now));
    } else {
      for (std::size_t i = 0; i < octets.size(); ++i) {
        wait(x, transmission_time(1, baud));
        note(x, port.on_bytes(octets.subspan(i, 1), now));
      }
    }
    wait(x, idle);
    return x;
  }

  port_events feed(std::string_view text) { return feed(hex(text)); }

  void wait(port_events& x, duration time) {
    const auto end = now + time;
    for (auto due = port.deadline(); due && *due <= end; due = port.deadline()) {
      now = std::max(now, *due);
      note(x, port.on_time(now));
    }
    now = end;
  }

  mote_port port;
  instant now = start;
  duration idle = 1s; ///< after each text
};

bytes packet_frame(std::uint8_t number, frame_type type = frame_type::packet_with_ack) {
  am_packet x;
  x.payload = {number, number};
  return encode(frame{type, number, encode(x)});
}

bytes joined(std::initializer_list<bytes> parts) {
  bytes all_octets;
  for (const auto& x : parts)
    all_octets.insert(all_octets.end(), x.begin(), x.end());
  return all_octets;
}

} // namespace

TEST_CASE("a mote receives and acks what TinyOS's own serial stack does", "[serial][GW-16]") {
  const bool whole = GENERATE(false, true);
  bench mote;
  std::size_t cases = 0;
  for (const auto& x : rubicon::test::read_cases("tinyos/mote-streams.txt")) {
    ++cases;
    CAPTURE(x.at("name"), whole);
    const auto result = mote.feed(hex(x.at("wire")), whole);
    CHECK(result.payloads == hex_list(x.at("radio")));
    CHECK(to_hex(result.acks) == (x.at("acks") == "-" ? "" : to_hex(hex(x.at("acks")))));
  }
  CHECK(cases == 18);
}

TEST_CASE("a mote counts what it drops by cause and receives the next frame", "[serial][GW-16]") {
  struct row {
    const char* what;
    bytes wire;
    std::uint64_t mote_port_counters::*cause;
  };
  auto bad_crc = packet_frame(9);
  bad_crc[5] ^= 1;
  const row table[] = {
      {"bad CRC", bad_crc, &mote_port_counters::bad_crc},
      {"no sequence", hex("7e447e"), &mote_port_counters::too_short},
      {"no CRC", hex("7e44017e"), &mote_port_counters::too_short},
      {"half a CRC", hex("7e45617e"), &mote_port_counters::too_short},
      {"an ack", hex("7e43142a0a7e"), &mote_port_counters::unknown_type},
      {"type 40", hex("7e40142a0a7e"), &mote_port_counters::unknown_type},
      {"dispatch 2", encode(frame{frame_type::packet, 0, {2, 5, 6, 7}}),
       &mote_port_counters::unknown_dispatch},
      {"no dispatch", hex("7e4561187e"), &mote_port_counters::unknown_dispatch},
  };
  for (const auto& row : table) {
    CAPTURE(row.what);
    bench mote;
    CHECK(mote.feed(row.wire).payloads.empty());
    CHECK(mote.port.counters().*row.cause == 1);
    CHECK(mote.feed(packet_frame(7)).acks == bytes{7});
  }
}

TEST_CASE("a mote acks even an empty packet", "[serial][GW-16]") {
  bench mote;
  const auto result = mote.feed(encode(frame{frame_type::packet_with_ack, 0x33, {}}));
  CHECK(result.acks == bytes{0x33});
  CHECK(result.payloads.empty());
}

TEST_CASE("a mote takes 254 octets after type and sequence and no more", "[serial][GW-16]") {
  for (const auto type : {frame_type::packet, frame_type::packet_with_ack}) {
    bench mote;
    bytes longest(packet_octets_max, 0x01);
    longest[0] = 2;
    static_cast<void>(mote.feed(encode(frame{type, 1, longest})));
    CHECK(mote.port.counters().frames_received == 1);
    longest.push_back(0x01);
    static_cast<void>(mote.feed(encode(frame{type, 2, longest})));
    CHECK(mote.port.counters().frames_received == 1);
    CHECK(mote.port.counters().too_long == 1);
    // Its closing flag is the first that is looked for, so the next frame is received.
    CHECK(mote.feed(packet_frame(3)).acks == bytes{3});
  }
}

TEST_CASE("a pending escape survives flags until a frame ends", "[serial][GW-16]") {
  const auto type_flipped = [](bytes wire) {
    wire[1] ^= escape_mask; // so that the escape restores the type
    return wire;
  };
  bench mote;
  CHECK(mote.feed(joined({hex("7d"), type_flipped(packet_frame(1))})).acks == bytes{1});
  CHECK(mote.feed(joined({hex("7e7d"), type_flipped(packet_frame(2))})).acks == bytes{2});
  CHECK(mote.feed(joined({hex("7e7d"), packet_frame(3)})).acks.empty());
  CHECK(mote.port.counters().unknown_type == 1);
  // Pending when a bad frame ends: cleared, and the flag opens the next frame.
  auto next = packet_frame(4);
  next.erase(next.begin());
  CHECK(mote.feed(joined({hex("7e45007d7e"), next})).acks == bytes{4});
  // Pending when a good frame ends: cleared too.
  auto good = packet_frame(5);
  good.insert(good.end() - 1, escape_octet);
  CHECK(mote.feed(joined({good, packet_frame(6)})).acks == bytes{5, 6});
}

TEST_CASE("a frame that starts while all receive buffers are in use is not acked",
          "[serial][NFR-03]") {
  mote_port_config config;
  config.service_time = 100ms;
  bench mote(config);
  mote.idle = 0ms;
  const auto result =
      mote.feed(joined({packet_frame(1), packet_frame(2), packet_frame(3), packet_frame(4)}));
  CHECK(result.payloads.size() == 2);
  CHECK(mote.port.counters().no_buffer == 2);
  mote.idle = 1s;
  CHECK(mote.feed(packet_frame(5, frame_type::packet)).acks == bytes{}); // the first two acks left
  CHECK(mote.port.counters().acks_sent == 2);
  CHECK(mote.feed(packet_frame(6)).acks == bytes{6});
}

TEST_CASE("the length in an active message's header is believed", "[serial][GW-16]") {
  bench mote;
  am_packet first;
  first.payload = {1, 2, 3, 4, 5, 6};
  CHECK(mote.feed(encode(frame{frame_type::packet, 0, encode(first)})).payloads ==
        std::vector<bytes>{first.payload});
  const auto longer = hex("00 00 02 00 00 06 22 06 0a 0b");
  CHECK(mote.feed(encode(frame{frame_type::packet, 0, longer})).payloads ==
        std::vector<bytes>{bytes{0x0a, 0x0b, 3, 4, 5, 6}});
  const auto shorter = hex("00 00 02 00 00 01 22 06 0c 0d");
  CHECK(mote.feed(encode(frame{frame_type::packet, 0, shorter})).payloads ==
        std::vector<bytes>{bytes{0x0c}});
  // Not even a header: the rest of it is what the frame before left.
  CHECK(mote.feed(encode(frame{frame_type::packet, 0, {0x00, 0xff}})).payloads ==
        std::vector<bytes>{bytes{0x0c}});
}

TEST_CASE("octets beyond the message buffer are dropped and the frame acked", "[serial][GW-16]") {
  mote_port_config config;
  config.payload_max = 28;
  bench mote(config);
  am_packet x;
  x.payload.assign(28, 0x11);
  auto packet = encode(x);
  packet.resize(packet.size() + 60, 0x22);
  const auto cut = mote.feed(encode(frame{frame_type::packet_with_ack, 1, packet}));
  CHECK(cut.acks == bytes{1});
  CHECK(cut.payloads == std::vector<bytes>{x.payload});

  x.payload.assign(29, 0x33);
  const auto refused = mote.feed(encode(frame{frame_type::packet_with_ack, 2, encode(x)}));
  CHECK(refused.acks == bytes{2});
  CHECK(refused.payloads.empty());
  CHECK(mote.port.counters().oversized == 1);
  CHECK(mote.feed(packet_frame(3)).acks == bytes{3});
}

TEST_CASE("a mote writes packets as 45, one frame at a time", "[serial][GW-01]") {
  mote_port port;
  const auto packet = numbered_packet(1, 28);
  const auto first = all<to_line>(port.send(packet, start));
  REQUIRE(first.size() == 1);
  CHECK(decode_all(first[0].octets) == std::vector{frame{frame_type::packet, 0, packet}});
  CHECK_FALSE(port.deadline());
  CHECK(port.send(packet, start).empty());
  const auto free = start + transmission_time(first[0].octets.size(), baud);
  CHECK(port.deadline() == free);
  CHECK(port.on_time(free - 1ns).empty());
  CHECK(all<to_line>(port.on_time(free)).size() == 1);
  CHECK(port.counters().packets_sent == 2);
}

TEST_CASE("a mote's transmit queue drops the newest beyond twelve", "[serial][GW-01][NFR-03]") {
  bench mote;
  port_events x;
  for (std::uint32_t i = 0; i < 13; ++i) // one on the wire, twelve waiting
    note(x, mote.port.send(numbered_packet(i, 10), mote.now));
  CHECK(mote.port.queued() == 12);
  CHECK(mote.port.counters().queue_full == 0);
  note(x, mote.port.send(numbered_packet(13, 10), mote.now));
  CHECK(mote.port.counters().queue_full == 1);
  mote.wait(x, 1s);
  REQUIRE(x.packets.size() == 13);
  for (std::uint32_t i = 0; i < 13; ++i)
    CHECK(number_of(x.packets[i]) == i);
  CHECK_FALSE(mote.port.deadline());
}

TEST_CASE("an urgent packet waits for the frame that is being written alone", "[serial][CLK-08]") {
  bench mote;
  port_events x;
  CHECK(mote.port.wait(mote.now) == 0s);
  for (std::uint32_t i = 0; i < 13; ++i)
    note(x, mote.port.send(numbered_packet(i, 10), mote.now));
  const auto wait = mote.port.wait(mote.now);
  CHECK(wait == *mote.port.deadline() - mote.now);
  for (std::uint32_t i = 20; i < 24; ++i)
    note(x, mote.port.send(numbered_packet(i, 10), mote.now, urgency::before_others));
  CHECK(mote.port.counters().queue_full == 0);
  note(x, mote.port.send(numbered_packet(24, 10), mote.now, urgency::before_others));
  CHECK(mote.port.counters().queue_full == 1);
  mote.wait(x, wait);
  REQUIRE(x.packets.size() == 2);
  CHECK(number_of(x.packets[1]) == 20);
  mote.wait(x, 1s);
  REQUIRE(x.packets.size() == 17);
  CHECK(number_of(x.packets[4]) == 23);
  CHECK(number_of(x.packets[5]) == 1);

  note(x, mote.port.send(numbered_packet(1, 10), mote.now));
  note(x, mote.port.send(numbered_packet(2, 10), mote.now, urgency::before_others));
  mote.port.stop();
  CHECK(mote.port.counters().discarded == 1);
}

TEST_CASE("acks overtake packets, and at most five wait", "[serial][NFR-03]") {
  mote_port_config config;
  config.service_time = 0ms;
  bench mote(config);
  port_events x;
  note(x, mote.port.send(numbered_packet(0, 114), mote.now));
  note(x, mote.port.send(numbered_packet(1, 114), mote.now));
  // Seven frames come in while the first packet is on the wire for 22 ms.
  for (std::uint8_t i = 1; i <= 7; ++i)
    note(x, mote.port.on_bytes(packet_frame(i), mote.now + std::chrono::milliseconds(i)));
  CHECK(x.acks.empty());
  CHECK(x.payloads.size() == 7);
  CHECK(mote.port.counters().acks_lost == 2);
  const auto before = x.packets.size();
  while (mote.port.deadline() && x.acks.size() < 5) {
    note(x, mote.port.on_time(*mote.port.deadline()));
    CHECK(x.packets.size() == before);
  }
  CHECK(x.acks == bytes{1, 2, 3, 4, 5});
  note(x, mote.port.on_time(*mote.port.deadline()));
  CHECK(x.packets.size() == 2);
}

TEST_CASE("a stopped port receives and sends nothing until it is started", "[serial][GW-01]") {
  bench mote;
  port_events x;
  for (std::uint32_t i = 0; i < 4; ++i)
    note(x, mote.port.send(numbered_packet(i, 10), mote.now));
  static_cast<void>(mote.port.on_bytes(hex("7e4510"), mote.now));
  mote.port.stop();
  CHECK_FALSE(mote.port.deadline());
  CHECK(mote.port.send(numbered_packet(9, 10), mote.now).empty());
  CHECK(mote.port.counters().discarded == 4);
  const auto deaf = mote.feed(packet_frame(1));
  CHECK(deaf.acks.empty());
  CHECK(deaf.payloads.empty());
  mote.port.start();
  CHECK(mote.feed(packet_frame(2)).acks == bytes{2});
}
