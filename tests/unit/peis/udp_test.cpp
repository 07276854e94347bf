// Sessions over UDP: the core alone, over simulated networks.
#include <cmath>
#include <string>

#include "support/catch.hpp"
#include "unit/peis/udp_pair.hpp"

namespace rubicon::peis {
namespace {

using test::udp_network;
using test::udp_pair;
using step = udp_handshake::step;

bytes random_octets(random_stream& rng, std::size_t size) {
  bytes x(size);
  for (auto& each : x)
    each = static_cast<std::uint8_t>(rng.next());
  return x;
}

/// Sends `all` in pieces of random sizes.
void send_in_pieces(udp_pair::end& from, udp_token session, const bytes& all, random_stream& rng) {
  for (std::size_t at = 0; at < all.size();) {
    const auto size = std::min<std::size_t>(all.size() - at, 1 + rng.below(3000));
    from.port.send(session, to_bytes(byte_view(all).subspan(at, size)));
    at += size;
  }
}

/// Octets a second that reach b while a always has something to send.
double goodput(udp_pair& x, udp_token session, duration length) {
  const auto before = x.b.received[session].size();
  const auto end = x.now + length;
  while (x.now < end) {
    while (x.a.port.unacknowledged() < 512 * 1024)
      x.a.port.send(session, bytes(16 * 1024, 'x'));
    x.run(1ms);
  }
  return static_cast<double>(x.b.received[session].size() - before) / seconds(length);
}

} // namespace

TEST_CASE("the keyed hash is that of its authors", "[peis][UDP-01]") {
  const udp_secret key = {0x0706050403020100, 0x0f0e0d0c0b0a0908};
  bytes octets;
  CHECK(keyed_hash(key, octets) == 0x726fdb47dd0e0e31); // their vectors.h
  for (std::uint8_t i = 0; i < 15; ++i)
    octets.push_back(i);
  CHECK(keyed_hash(key, octets) == 0xa129ca6149be45e5); // their paper, appendix A
}

TEST_CASE("datagrams come back as they were, and nothing else is one", "[peis][UDP-01]") {
  const udp_handshake hello{step::open, 7, {0x0123456789abcdef}, 42};
  const auto octets = encode(hello);
  REQUIRE(octets.size() == udp_handshake_size);
  CHECK(std::get<udp_handshake>(*decode_udp_datagram(octets)) == hello);
  const bytes content(udp_content_max, 'c');
  udp_segment segment;
  segment.room = 1;
  segment.token = {2};
  segment.sequence = 3;
  segment.expected = 4;
  segment.number = 5;
  segment.newest = 6;
  segment.count = 7;
  segment.credit = 8;
  segment.content = content;
  bytes whole;
  encode(segment, whole);
  REQUIRE(whole.size() == udp_datagram_max);
  const auto decoded = decode_udp_datagram(whole);
  REQUIRE(decoded);
  bytes again;
  encode(std::get<udp_segment>(*decoded), again);
  CHECK(again == whole);
  for (std::size_t size = 0; size < udp_segment_header; ++size)
    CHECK(decode_udp_datagram(byte_view(whole).first(size)).error() == errc::truncated);
  CHECK(decode_udp_datagram(byte_view(whole).first(udp_segment_header)).error() ==
        errc::bad_value); // a number, and no part
  whole.push_back(0);
  CHECK(decode_udp_datagram(whole).error() == errc::too_long);
  auto longer = octets;
  longer.push_back(0);
  CHECK(decode_udp_datagram(longer).error() == errc::too_long);
  for (const std::size_t at : {0U, 3U, 4U}) {
    auto wrong = octets;
    wrong[at] = 99;
    CHECK(decode_udp_datagram(wrong).error() == errc::bad_value);
  }
}

TEST_CASE("all octets come once and in order, whatever the network loses, repeats and reorders",
          "[peis][UDP-01]") {
  const auto loss = GENERATE(0.0, 0.05, 0.2);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(loss, seed);
    random_stream rng(seed);
    udp_network network;
    network.loss = loss;
    network.twice = rng.unit() * 0.1;
    network.delay = rng.between(100us, 30ms);
    network.jitter = rng.between(duration(0), 20ms);
    udp_pair x(network, seed);
    const auto session = x.open();
    REQUIRE(x.b.opened == std::vector{session});
    const auto there = random_octets(rng, 1 + rng.below(300'000));
    const auto back = random_octets(rng, 1 + rng.below(100'000));
    send_in_pieces(x.a, session, there, rng);
    x.run(rng.between(duration(0), 100ms));
    send_in_pieces(x.b, session, back, rng);
    const auto is_done = [&] {
      return x.a.port.unacknowledged() == 0 && x.b.port.unacknowledged() == 0;
    };
    REQUIRE(x.run_until(is_done, 120s));
    REQUIRE(x.b.received[session] == there);
    REQUIRE(x.a.received[session] == back);
    CHECK(x.a.acknowledged[session] == there.size());
    CHECK(x.a.held_max <= 2 * udp_session_config{}.parts_max);
    CHECK(x.b.held_max <= 2 * udp_session_config{}.parts_max);
    CHECK(x.a.closed.empty());
    CHECK(x.b.closed.empty());
    CHECK(x.a.port.counters().impossible + x.b.port.counters().impossible == 0);
  }
}

TEST_CASE("a session without loss sends nothing twice, and sleeps when there is nothing to say",
          "[peis][UDP-01]") {
  udp_pair x;
  const auto session = x.open();
  x.a.port.send(session, bytes(1'000'000, 'x'));
  REQUIRE(x.run_until([&] { return x.a.port.unacknowledged() == 0; }, 60s));
  CHECK(x.a.port.counters().parts_resent == 0);
  CHECK(x.a.port.counters().parts_sent == (1'000'000 + udp_content_max - 1) / udp_content_max);
  x.run(1s);
  CHECK(!x.a.port.deadline());
  CHECK(!x.b.port.deadline());
}

TEST_CASE("the window grows by a tenth an interval without loss, and shrinks when much is lost",
          "[peis][UDP-02]") {
  udp_rate rate;
  std::uint64_t newest = 0;
  std::uint64_t count = 0;
  instant now{};
  const auto interval = [&](std::uint64_t lost) {
    rate.note_limited();
    newest += 100;
    count += 100 - lost;
    now += 20ms;
    rate.on_round_trip(20ms, now);
    rate.on_report(newest, count, newest, now);
    return static_cast<double>(rate.window());
  };
  auto before = interval(0);
  for (int i = 0; i < 30; ++i) {
    const auto after = interval(0);
    CHECK(after / before > 1.04);
    CHECK(after / before < 1.16); // whole datagrams
    before = after;
  }
  for (int i = 0; i < 5; ++i) { // radio
    const auto after = interval(5);
    CHECK(after > before);
    before = after;
  }
  for (int i = 0; i < 10; ++i)
    before = interval(22);
  CHECK(interval(22) == before); // neither
  for (int i = 0; i < 4; ++i)
    before = interval(30);
  for (int i = 0; i < 5; ++i) {
    const auto after = interval(30);
    CHECK(after / before == Approx(0.7).epsilon(0.04));
    before = after;
  }
  for (int i = 0; i < 50; ++i)
    before = interval(60);
  CHECK(before == udp_rate_config{}.window_min);
  rate = udp_rate();
  newest = count = 0;
  rate.on_report(50, 50, 50, instant{1s}); // the window was not used up
  CHECK(rate.window() == 16);
}

TEST_CASE("the window shrinks where a queue fills, though little is lost", "[peis][UDP-02]") {
  udp_rate rate;
  rate.on_round_trip(20ms, instant{});
  for (int i = 0; i < 50; ++i)
    rate.on_round_trip(60ms, instant{});
  rate.note_limited();
  rate.on_report(100, 100, 100, instant{1s});
  CHECK(rate.window() == 16); // without loss it stays
  rate.note_limited();
  rate.on_report(200, 195, 200, instant{2s});
  CHECK(rate.window() == 13);
}

TEST_CASE("retries wait for the measured round trip, and ever longer", "[peis][UDP-02]") {
  udp_rate rate;
  CHECK(rate.retry_after(0) == udp_rate::retry_first);
  rate.on_round_trip(100ms, instant{});
  CHECK(rate.retry_after(0) == 300ms); // mean and four deviations of half of it: RFC 6298 2.2
  CHECK(rate.retry_after(1) == 600ms);
  CHECK(rate.retry_after(9) == udp_rate::retry_max);
  for (int i = 0; i < 100; ++i)
    rate.on_round_trip(100us, instant{});
  CHECK(rate.retry_after(0) == udp_rate::retry_min);
}

TEST_CASE("a twentieth lost at random does not starve a session", "[peis][UDP-02]") {
  const auto rate_at = [](double loss) {
    udp_network network;
    network.loss = loss;
    network.delay = 10ms;
    udp_pair x(network);
    const auto session = x.open();
    static_cast<void>(goodput(x, session, 2s));
    return goodput(x, session, 5s);
  };
  const auto without = rate_at(0);
  const auto at_5 = rate_at(0.05);
  const auto at_30 = rate_at(0.3);
  CAPTURE(without, at_5, at_30);
  CHECK(without > 15e6); // what the owner hands over at a time, 512 KiB, each round trip
  CHECK(at_5 > 0.4 * without);
  CHECK(at_5 > 10 * 1.22 * 1400 / 0.02 / std::sqrt(0.05)); // ten times what one TCP of Reno carries
  CHECK(at_30 < 0.1 * without);
  CHECK(at_30 > 1e5); // eight datagrams a round trip, not nothing
}

TEST_CASE("a session finds what a narrow network carries", "[peis][UDP-02]") {
  udp_network network;
  network.octets_per_s = 1.25e6; // 10 Mbit/s
  network.queue_max = GENERATE(30U, 100U, 1000U);
  network.delay = 10ms;
  udp_pair x(network);
  const auto session = x.open();
  static_cast<void>(goodput(x, session, 2s));
  const auto before = x.a.port.counters();
  const auto carried = goodput(x, session, 10s);
  const auto after = x.a.port.counters();
  const auto sent = static_cast<double>(after.parts_sent - before.parts_sent);
  const auto resent = static_cast<double>(after.parts_resent - before.parts_resent);
  CAPTURE(network.queue_max, carried, sent, resent);
  CHECK(carried > 0.8 * network.octets_per_s);
  CHECK(resent < 0.15 * sent);
}

TEST_CASE("an owner that reads nothing makes the other side wait, within bounds",
          "[peis][UDP-01]") {
  udp_pair x;
  const auto session = x.open();
  x.b.port.read(session, false);
  const bytes all(3'000'000, 'x');
  x.a.port.send(session, all);
  x.run(60s);
  CHECK(x.b.received[session].empty());
  const auto arrived = all.size() - x.a.port.unacknowledged();
  CHECK(arrived > 500'000);
  CHECK(arrived < (udp_session_config{}.parts_max + 17) * udp_content_max);
  CHECK(x.a.port.counters().parts_resent < 10'000); // it asks now and then
  x.b.port.read(session, true);
  REQUIRE(x.run_until([&] { return x.a.port.unacknowledged() == 0; }, 30s));
  CHECK(x.b.received[session] == all);
}

TEST_CASE("a session that is closed has sent what it was given", "[peis][UDP-01]") {
  udp_network network;
  network.loss = 0.2;
  udp_pair x(network, 3);
  const auto session = x.open();
  x.a.port.send(session, bytes(50'000, 'x'));
  x.a.port.close(session, x.now);
  x.a.port.send(session, bytes(1, 'y')); // too late
  x.run_until([&] { return x.a.port.sessions() == 0; }, 10s);
  CHECK(x.b.received[session].size() == 50'000);
  CHECK(x.a.closed.empty());
  x.b.port.send(session, bytes(1, 'z')); // word of the end was lost, or was not: this brings it
  x.run(10s);
  CHECK(x.b.closed == std::vector{session});
  CHECK(x.b.port.sessions() == 0);
}

TEST_CASE("an end that is no more is noticed", "[peis][UDP-01]") {
  udp_pair x;
  const auto session = x.open();
  SECTION("it has started anew") {
    x.b.port = udp_port({}, {5, 6});
    x.a.port.send(session, bytes(1, 'x'));
    CHECK(x.run_until([&] { return !x.a.closed.empty(); }, 100ms));
  }
  SECTION("it is silent") {
    x.network.loss = 1;
    x.a.port.send(session, bytes(1, 'x'));
    x.run(7s);
    CHECK(x.a.closed.empty());
    CHECK(x.run_until([&] { return !x.a.closed.empty(); }, 3s));
  }
}

TEST_CASE("an attempt ends when no answer comes, or a refusal", "[peis][UDP-01][LNK-07]") {
  udp_port_config config;
  SECTION("no answer") {
    udp_pair x({}, 1, config);
    x.network.loss = 1;
    x.a.port.connect(attempt_id{9}, udp_pair::b_address, 3s, x.now);
    x.run(2999ms);
    CHECK(x.a.refused.empty());
    CHECK(x.run_until([&] { return x.a.refused == std::vector{attempt_id{9}}; }, 10ms));
    CHECK(x.octets_sent < 10 * udp_handshake_size);
  }
  SECTION("no room") {
    config.sessions_max = 0;
    udp_pair x({}, 1, config);
    x.a.port.connect(attempt_id{9}, udp_pair::b_address, 3s, x.now);
    CHECK(x.run_until([&] { return !x.a.refused.empty(); }, 100ms));
    CHECK(x.b.port.counters().refused == 1);
  }
  SECTION("another network") {
    config.networks = {*parse_ipv4_network("192.168.0.0/16")};
    udp_pair x({}, 1, config);
    x.a.port.connect(attempt_id{9}, udp_pair::b_address, 1s, x.now);
    x.run(2s);
    CHECK(x.a.refused.size() == 1);
    CHECK(x.b.port.counters().sent == 0);
    CHECK(x.b.port.counters().foreign > 1);
  }
}

// Hostile datagrams.

TEST_CASE("who asks in another's name costs no memory, and gets no more octets than it sent",
          "[peis][UDP-01]") {
  udp_port port({}, {1, 2});
  std::size_t asked = 0;
  std::size_t answered = 0;
  instant now{};
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const udp_address victim{{10, 1, static_cast<std::uint8_t>(i >> 8U), 7}, 7};
    const auto kind = i % 2 == 0 ? step::hello : step::open;
    const auto octets = encode(udp_handshake{kind, 9, {i + 1}, i});
    asked += octets.size();
    port.on_datagram(victim, octets, now);
    for (const auto& each : port.flush(now))
      answered += each.octets.size();
    now += 10us;
  }
  CHECK(port.sessions() == 0);
  CHECK(port.take_events().empty());
  CHECK(answered > 0);
  CHECK(answered <= 1200 * udp_handshake_size); // 1000 a second, and a burst
  CHECK(answered < asked);
  CHECK(port.counters().bad_cookies == 50'000);
  CHECK(port.counters().unanswered > 40'000);
}

TEST_CASE("a cookie is good at its own address, for its own session, and for a while",
          "[peis][UDP-01]") {
  const udp_cookies x({3, 4});
  const udp_address here{{10, 0, 0, 1}, 5};
  const udp_token session{77};
  const auto cookie = x.cookie(here, session, instant{1s});
  CHECK(x.is_good(cookie, here, session, instant{1s}));
  CHECK(x.is_good(cookie, here, session, instant{11s}));
  CHECK_FALSE(x.is_good(cookie, here, session, instant{21s}));
  CHECK_FALSE(x.is_good(cookie, {here.ip, 6}, session, instant{1s}));
  CHECK_FALSE(x.is_good(cookie, {{10, 0, 0, 2}, 5}, session, instant{1s}));
  CHECK_FALSE(x.is_good(cookie, here, {78}, instant{1s}));
  CHECK_FALSE(udp_cookies({3, 5}).is_good(cookie, here, session, instant{1s}));
}

TEST_CASE("a session is not disturbed by who is not on its path", "[peis][UDP-01]") {
  udp_pair x;
  const auto session = x.open();
  const udp_address elsewhere{{10, 0, 0, 9}, 9};
  udp_segment forged;
  forged.token = session;
  forged.number = 1;
  forged.credit = 100;
  const auto content = to_bytes("forged");
  forged.content = content;
  bytes octets;
  encode(forged, octets);
  x.b.port.on_datagram(elsewhere, octets, x.now); // knows the name, is elsewhere
  x.b.port.on_datagram(elsewhere, encode(udp_handshake{step::gone, 0, session, 0}), x.now);
  x.b.port.on_datagram(udp_pair::a_address, encode(udp_handshake{step::gone, 0, {1}, 0}), x.now);
  CHECK(x.b.port.counters().unknown == 3);
  x.a.port.send(session, to_bytes("good"));
  x.run(1s);
  CHECK(x.b.received[session] == to_bytes("good"));
  CHECK(x.b.closed.empty());
}

TEST_CASE("datagrams that are repeated later do nothing", "[peis][UDP-01]") {
  udp_pair x;
  x.keeps = true;
  const auto session = x.open();
  x.a.port.send(session, bytes(20'000, 'x'));
  x.run(1s);
  const auto seen = x.seen;
  for (const auto& each : seen)
    x.b.port.on_datagram(each.from, each.octets, x.now);
  x.run(1s);
  CHECK(x.b.received[session].size() == 20'000);
  CHECK(x.b.opened.size() == 1);
  CHECK(x.b.port.counters().repeated >= 15);
  x.a.port.close(session, x.now);
  x.run(1s);
  REQUIRE(x.b.port.sessions() == 0);
  for (const auto& each : seen)
    x.b.port.on_datagram(each.from, each.octets, x.now);
  CHECK(x.b.port.sessions() == 0);
  CHECK(x.b.port.counters().refused > 0);
}

TEST_CASE("parts without room and word of parts that were never sent are dropped",
          "[peis][UDP-01]") {
  udp_pair x;
  const auto session = x.open();
  const auto forge = [&](const udp_segment& segment) {
    bytes octets;
    encode(segment, octets);
    x.b.port.on_datagram(udp_pair::a_address, octets, x.now);
  };
  const auto content = to_bytes("x");
  udp_segment y;
  y.token = session;
  y.number = 1;
  y.content = content;
  for (const std::uint64_t sequence : {std::uint64_t{512}, std::uint64_t{1} << 40U, UINT64_MAX}) {
    y.sequence = sequence;
    forge(y);
  }
  CHECK(x.b.port.counters().out_of_window == 3);
  y.sequence = 511;
  forge(y);
  CHECK(x.b.port.find(session)->held() == 1);
  y.expected = 1;
  forge(y);
  y.expected = UINT64_MAX;
  forge(y);
  y.expected = 0;
  y.newest = 1;
  forge(y);
  CHECK(x.b.port.counters().impossible == 3);
  CHECK(x.b.closed.empty());
}

} // namespace rubicon::peis
