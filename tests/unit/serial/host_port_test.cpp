#include "serial/host_port.hpp"
#include "serial/raw_packet.hpp"

#include "support/catch.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using namespace rubicon::serial::test;

namespace {

packet_id id(std::uint64_t x) {
  return packet_id{x};
}

bytes packet(std::uint32_t number = 1) {
  return numbered_packet(number, 10);
}

bytes ack(std::uint8_t sequence) {
  return encode(frame{frame_type::ack, sequence, {}});
}

/// The only frame that was written.
frame written(const outputs& out) {
  const auto writes = all<to_line>(out);
  REQUIRE(writes.size() == 1);
  const auto frames = decode_all(writes[0].octets);
  REQUIRE(frames.size() == 1);
  return frames[0];
}

} // namespace

TEST_CASE("a packet is sent when its ack has come", "[serial][GW-16]") {
  host_port pc;
  CHECK(pc.current() == host_port::state::idle);
  const auto frame = written(pc.send(id(1), packet(), start));
  CHECK(frame.type == frame_type::packet_with_ack);
  CHECK(frame.packet == packet());
  CHECK(pc.current() == host_port::state::waiting);
  CHECK(pc.deadline() == start + 100ms);
  CHECK(pc.on_bytes(ack(static_cast<std::uint8_t>(frame.sequence + 1)), start + 5ms).empty());
  CHECK(pc.counters().stray_acks == 1);
  const auto out = pc.on_bytes(ack(frame.sequence), start + 10ms);
  REQUIRE(out.size() == 1);
  CHECK(all<sent>(out).at(0).id == id(1));
  CHECK_FALSE(pc.deadline());
  CHECK(pc.on_bytes(ack(frame.sequence), start + 11ms).empty());
  CHECK(pc.counters().stray_acks == 2);
}

TEST_CASE("a packet that is not acknowledged is written four times and then lost",
          "[serial][GW-16]") {
  host_port pc;
  int writes = static_cast<int>(all<to_line>(pc.send(id(1), packet(), start)).size());
  for (int i = 1; i <= 3; ++i) {
    const auto due = start + i * 100ms;
    REQUIRE(pc.deadline() == due);
    CHECK(pc.on_time(due - 1ns).empty());
    CHECK(written(pc.on_time(due)).packet == packet());
    ++writes;
  }
  CHECK(writes == 4);
  REQUIRE(pc.deadline() == start + 400ms);
  const auto out = pc.on_time(start + 400ms);
  REQUIRE(out.size() == 1);
  CHECK(all<lost>(out).at(0).id == id(1));
  CHECK(all<lost>(out).at(0).cause == lost_cause::no_ack);
  CHECK(pc.current() == host_port::state::idle);
  CHECK(pc.counters().attempts == 4);
  CHECK(pc.counters().no_ack == 1);
}

TEST_CASE("a late ack of an earlier attempt counts", "[serial][GW-16]") {
  host_port pc;
  const auto first = written(pc.send(id(1), packet(), start));
  const auto second = written(pc.on_time(start + 100ms));
  CHECK(first.sequence != second.sequence);
  CHECK(all<sent>(pc.on_bytes(ack(first.sequence), start + 101ms)).size() == 1);
  // The ack of the repeat then says nothing about the packet that follows.
  const auto next = written(pc.send(id(2), packet(2), start + 102ms));
  CHECK(pc.on_bytes(ack(second.sequence), start + 103ms).empty());
  CHECK(all<sent>(pc.on_bytes(ack(next.sequence), start + 104ms)).at(0).id == id(2));
}

TEST_CASE("packets wait their turn in order", "[serial][GW-16]") {
  host_port pc;
  auto current = written(pc.send(id(0), packet(0), start));
  for (std::uint32_t i = 1; i < 300; ++i) { // sequence numbers wrap meanwhile
    CHECK(pc.send(id(i), packet(i), start).empty());
    const auto out = pc.on_bytes(ack(current.sequence), start);
    REQUIRE(all<sent>(out).size() == 1);
    CHECK(all<sent>(out)[0].id == id(i - 1));
    current = written(out);
    CHECK(number_of(current.packet) == i);
  }
}

TEST_CASE("the queue takes its limit and loses the next", "[serial][GW-16][NFR-03]") {
  const std::size_t limit = GENERATE(0U, 1U, 64U);
  host_port_config config;
  config.queue_max = limit;
  host_port pc(config);
  static_cast<void>(pc.send(id(1000), packet(), start));
  for (std::uint32_t i = 0; i < limit; ++i)
    CHECK(pc.send(id(i), packet(i), start).empty());
  CHECK(pc.queued() == limit);
  const auto out = pc.send(id(2000), packet(), start);
  REQUIRE(out.size() == 1);
  CHECK(all<lost>(out).at(0).id == id(2000));
  CHECK(all<lost>(out).at(0).cause == lost_cause::queue_full);
  CHECK(pc.counters().queue_full == 1);
  CHECK(pc.counters().accepted == limit + 1);
}

TEST_CASE("an urgent packet overtakes what waits, and is not acknowledged", "[serial][CLK-08]") {
  host_port pc;
  CHECK(pc.wait(start) == 0s);
  static_cast<void>(pc.send(id(1), packet(1), start));
  CHECK(pc.send(id(2), packet(2), start).empty());
  const auto wait = pc.wait(start);
  CHECK(wait > 0s);
  const auto out = pc.send_urgent(packet(3), start);
  REQUIRE(out.size() == 1);
  const auto frames = decode_all(all<to_line>(out).at(0).octets);
  REQUIRE(frames.size() == 1);
  CHECK(frames[0].type == frame_type::packet);
  CHECK(number_of(frames[0].packet) == 3);
  CHECK(pc.wait(start) > wait); // the next one waits for it too
  CHECK(pc.wait(start + 1s) == 0s);
  CHECK(pc.queued() == 1);
  CHECK(pc.counters().urgent == 1);
  CHECK(pc.counters().accepted == 2);
}

TEST_CASE("a packet that would not do the sink good is refused", "[serial][GW-16]") {
  struct row {
    const char* what;
    bytes packet;
    lost_cause cause;
  };
  bytes too_much(8 + 115, 0x01);
  too_much[0] = 0;
  too_much[5] = 115;
  const row table[] = {
      {"nothing", {}, lost_cause::malformed},
      {"header cut", hex("00 00 02 00 00 00"), lost_cause::malformed},
      {"less than the length says", hex("00 00 02 00 00 02 22 06 01"), lost_cause::malformed},
      {"more than the length says", hex("00 00 02 00 00 00 22 06 01"), lost_cause::malformed},
      {"AM length above 114", too_much, lost_cause::too_long},
      {"frame above the mote's limit", bytes(packet_octets_max + 1, 0x02), lost_cause::too_long},
  };
  for (const auto& row : table) {
    CAPTURE(row.what);
    host_port pc;
    const auto out = pc.send(id(3), row.packet, start);
    REQUIRE(out.size() == 1);
    CHECK(all<lost>(out).at(0).id == id(3));
    CHECK(all<lost>(out).at(0).cause == row.cause);
    CHECK(pc.current() == host_port::state::idle);
    CHECK(pc.counters().refused == 1);
  }
  host_port_config config;
  config.payload_max = 28;
  host_port small_sink(config);
  CHECK(all<lost>(small_sink.send(id(1), numbered_packet(1, 29), start)).size() == 1);
  CHECK(all<to_line>(small_sink.send(id(2), numbered_packet(1, 28), start)).size() == 1);
  // A raw frame has a payload, too.
  const auto raw = [](std::size_t octets) {
    return encode_raw({7, 0, default_group, 6, bytes(octets)}, 1);
  };
  CHECK(objection_to(raw(29), 28) == lost_cause::too_long);
  CHECK(!objection_to(raw(28), 28));
  CHECK(!objection_to(bytes(40, 0x02), 28)); // whatever it is
  small_sink.set_payload_max(29);
  CHECK(!all<lost>(small_sink.send(id(3), numbered_packet(1, 30), start)).empty());
  CHECK(all<lost>(small_sink.send(id(4), numbered_packet(1, 29), start)).empty());
  host_port pc;
  CHECK(all<to_line>(pc.send(id(1), numbered_packet(1, 114), start)).size() == 1);
  host_port other;
  CHECK(all<to_line>(other.send(id(1), bytes(packet_octets_max, 0x02), start)).size() == 1);
}

TEST_CASE("a packet that wants an ack gets it before it goes up", "[serial][GW-16]") {
  host_port pc;
  const auto out = pc.on_bytes(encode(frame{frame_type::packet_with_ack, 0x7e, packet()}), start);
  REQUIRE(out.size() == 2);
  CHECK(std::get<to_line>(out[0]).octets == ack(0x7e));
  CHECK(std::get<received>(out[1]).packet == packet());
  const auto plain = pc.on_bytes(encode(frame{frame_type::packet, 0, packet()}), start);
  REQUIRE(plain.size() == 1);
  CHECK(std::get<received>(plain[0]).packet == packet());
  CHECK(pc.counters().received == 2);
  CHECK(pc.counters().acks_written == 1);
}

TEST_CASE("frames that are no packets stay below", "[serial][GW-16]") {
  host_port pc;
  CHECK(pc.on_bytes(encode(frame{frame_type::unknown, 0, {0x44}}), start).empty());
  CHECK(pc.counters().unknown_answers == 1);
  const auto out = pc.on_bytes(encode(frame{frame_type::packet_with_ack, 1, {}}), start);
  REQUIRE(out.size() == 1);
  CHECK(std::get<to_line>(out[0]).octets == ack(1));
  CHECK(pc.counters().empty == 1);
  auto noisy = encode(frame{frame_type::packet_with_ack, 1, packet()});
  noisy[4] ^= 1;
  CHECK(pc.on_bytes(noisy, start).empty());
  CHECK(pc.frames().bad_crc == 1);
}

TEST_CASE("octets may come in any pieces", "[serial][GW-16]") {
  const auto wire = encode(frame{frame_type::packet, 0, packet()});
  for (std::size_t cut = 0; cut <= wire.size(); ++cut) {
    host_port pc;
    auto got = all<received>(pc.on_bytes(byte_view(wire).first(cut), start));
    const auto rest = all<received>(pc.on_bytes(byte_view(wire).subspan(cut), start));
    got.insert(got.end(), rest.begin(), rest.end());
    REQUIRE(got.size() == 1);
    CHECK(got[0].packet == packet());
  }
}

TEST_CASE("a noisy line is repeated sooner until it falls silent twice", "[serial][GW-16]") {
  host_port pc;
  auto now = start;
  const auto lose = [&] {
    static_cast<void>(pc.send(id(9), packet(), now));
    while (pc.deadline())
      static_cast<void>(pc.on_time(now = *pc.deadline()));
  };
  static_cast<void>(pc.send(id(1), packet(), now));
  now += 100ms;
  const auto repeat = written(pc.on_time(now)); // the repeat is acked: noise
  now += 10ms;
  CHECK(all<sent>(pc.on_bytes(ack(repeat.sequence), now)).size() == 1);
  // The answer came 10 ms after its attempt; an eighth is added of what the line does not explain.
  constexpr duration usual_max = 11ms + 500us;
  constexpr duration usual_min = 10ms + 250us;
  const auto before = now;
  lose();
  CHECK(now - before > 7 * usual_min);
  CHECK(now - before < 7 * usual_max);
  static_cast<void>(pc.send(id(2), packet(), now));
  CHECK(*pc.deadline() > now + usual_min);
  CHECK(*pc.deadline() < now + usual_max);
  static_cast<void>(pc.on_time(*pc.deadline()));
  while (pc.deadline())
    static_cast<void>(pc.on_time(now = *pc.deadline()));
  static_cast<void>(pc.send(id(3), packet(), now));
  CHECK(pc.deadline() == now + 100ms);
}

TEST_CASE("patience is the configured wait until a repeat was needed", "[serial][GW-16]") {
  ack_patience patience;
  const auto wait = [&](bool last) { return patience.wait(2ms, 100ms, last); };
  CHECK(wait(false) == 100ms);
  for (int i = 0; i < 20; ++i)
    patience.on_answer(8ms, false);
  CHECK(wait(false) == 100ms);
  patience.on_answer(16ms, true);
  CHECK(wait(false) == 20ms + 250us);
  CHECK(wait(true) == 81ms);
  for (int i = 0; i < 15; ++i)
    patience.on_answer(8ms, false);
  CHECK(wait(false) == 20ms + 250us); // the slowest of sixteen
  patience.on_answer(8ms, false);
  CHECK(wait(false) == 11ms + 250us);
  for (int i = 16; i < 63; ++i)
    patience.on_answer(8ms, false);
  CHECK(wait(false) == 11ms + 250us);
  patience.on_answer(8ms, false); // the 64th in a row without a repeat
  CHECK(wait(false) == 100ms);
}

TEST_CASE("patience forgets its measurements after two silences and never exceeds its limit",
          "[serial][GW-16]") {
  ack_patience patience;
  const auto wait = [&](bool last) { return patience.wait(2ms, 100ms, last); };
  patience.on_answer(10ms, true);
  patience.on_silence();
  CHECK(wait(false) < 100ms);
  patience.on_answer(10ms, false);
  patience.on_silence(); // not in a row
  CHECK(wait(false) < 100ms);
  patience.on_silence();
  CHECK(wait(false) == 100ms);
  patience.on_answer(99ms, true);
  CHECK(wait(false) == 100ms);
  CHECK(wait(true) == 100ms);
}
