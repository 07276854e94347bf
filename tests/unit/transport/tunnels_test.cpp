#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "support/catch.hpp"
#include "support/pick.hpp"
#include "support/start.hpp"
#include "unit/transport/tunnels_fixture.hpp"

using namespace rubicon;
using namespace rubicon::transport;
using test::alice;
using test::bob;
using test::make_tunnels;
using test::pc;
using test::pick;
using world = test::tunnel_fixture;
using kind = tunnel_message::kind;
using test::start;

namespace {

/// The only end that this node has accepted.
tunnel_id accepted(world& x, mote_address who) {
  std::vector<tunnel_id> found;
  for (const auto& [id, y] : x.ends_at(who)) {
    if (!y.opened_here)
      found.push_back(id);
  }
  REQUIRE(found.size() == 1);
  return found[0];
}

bytes octets_of(const tunnels_outputs& out) {
  const auto packets = pick<packet_out>(out);
  REQUIRE(packets.size() == 1);
  return packets[0].octets;
}

} // namespace

TEST_CASE("tunnel messages keep their layout", "[transport][golden][WIR-01][PAR-01][PAR-02]") {
  auto a = make_tunnels(alice);
  auto b = make_tunnels(pc, 17); // 17: the third life, when lives have come round once
  auto [id, out] = a.connect(pc, start);
  CHECK(octets_of(out) == bytes{0x01, 0, 7, 0xff, 0xfd, 0, 1, 0x10});
  CHECK(pick<packet_out>(out)[0].destination == pc);
  out = b.on_packet(alice.island, octets_of(out), start);
  CHECK(octets_of(out) == bytes{0x82, 0xff, 0xfd, 0, 7, 0, 1, 0x13});
  const auto there = pick<tunnel_accepted>(out).at(0);
  CHECK(there.source == alice);
  static_cast<void>(a.on_packet(pc.island, octets_of(out), start));
  const bytes data{0x04, 0, 7, 0xff, 0xfd, 0, 1, 0x13, 0xaa};
  CHECK(octets_of(*a.send(id, bytes{0xaa}, start)) == data);
  const bytes data_back{0x84, 0xff, 0xfd, 0, 7, 0, 1, 0x13, 0xbb};
  CHECK(octets_of(*b.send(there.id, bytes{0xbb}, start)) == data_back);
  CHECK(octets_of(a.on_time(start + 10s)) == bytes{0x05, 0, 7, 0xff, 0xfd, 0, 1, 0x13});
  CHECK(octets_of(b.refuse(there.id)) == bytes{0x83, 0xff, 0xfd, 0, 7, 0, 1, 0x13});
  CHECK(octets_of(a.close(id)) == bytes{0x06, 0, 7, 0xff, 0xfd, 0, 1, 0x13});
  CHECK(octets_of(b.connect(alice, start).second) ==
        bytes{0x01, 0xff, 0xfd, 0, 7, 1, 1, 0x30}); // numbers begin elsewhere then
}

TEST_CASE("tunnel messages that mean nothing are refused", "[transport]") {
  const auto error = [](bytes x) {
    const auto decoded = decode_tunnel_message(x);
    CHECK(!decoded);
    return decoded ? errc{} : decoded.error();
  };
  CHECK(error({4, 0, 7, 0, 8, 0, 1}) == errc::truncated);
  bytes longest{4, 0, 7, 0, 8, 0, 1, 0x11};
  longest.resize(8 + tunnel_content_max);
  CHECK(longest.size() == 262);
  CHECK(decode_tunnel_message(longest));
  longest.push_back(0);
  CHECK(error(longest) == errc::too_long);
  CHECK(error({0, 0, 7, 0, 8, 0, 1, 0x11}) == errc::unsupported);
  CHECK(error({7, 0, 7, 0, 8, 0, 1, 0x11}) == errc::unsupported);
  CHECK(error({0x44, 0, 7, 0, 8, 0, 1, 0x11}) == errc::unsupported);
  CHECK(error({0x81, 0, 7, 0, 8, 0, 1, 0x10}) == errc::bad_value); // connect from the acceptor
  CHECK(error({0x02, 0, 7, 0, 8, 0, 1, 0x11}) == errc::bad_value); // accept from the opener
  CHECK(error({0x03, 0, 7, 0, 8, 0, 1, 0x11}) == errc::bad_value);
  CHECK(error({0x01, 0, 7, 0, 8, 0, 1, 0x11}) == errc::bad_value); // cannot know the acceptor
  CHECK(error({0x01, 0, 7, 0, 8, 0, 1, 0x00}) == errc::bad_value);
  CHECK(error({0x04, 0, 7, 0, 8, 0, 1, 0x10}) == errc::bad_value);
  CHECK(error({0x86, 0, 7, 0, 8, 0, 1, 0x10}) == errc::bad_value);
  CHECK(decode_tunnel_message(bytes{0x06, 0, 7, 0, 8, 0, 1, 0x10}));
  CHECK(error({0x05, 0, 7, 0, 8, 0, 1, 0x11, 0}) == errc::bad_value);         // content
  CHECK(error({0x04, 0xff, 0xff, 0, 8, 0, 1, 0x11}) == errc::bad_value);      // from everybody
  CHECK(error({0x04, 0xff, 0xfe, 0, 8, 0, 1, 0x11}) == errc::bad_value);      // from "myself"
  CHECK(decode_tunnel_message(bytes{0x04, 0xff, 0xfd, 0, 8, 0, 1, 0x11, 0})); // from a PC

  auto a = make_tunnels(alice);
  CHECK(a.on_packet(bob.island, bytes{4, 0}, start).empty());
  CHECK(a.counters().malformed == 1);
}

TEST_CASE("a tunnel carries contents both ways until either end closes it",
          "[transport][PAR-01][PAR-02][STR-18]") {
  for (const bool opener_closes : {true, false}) {
    for (const auto& [from, to] : {std::pair{alice, bob}, {alice, pc}, {pc, alice}, {pc, bob}}) {
      world x;
      const auto id = x.connect(from, to);
      CHECK_FALSE(x.send(from, id, 0)); // not open yet
      x.run_for(50ms);
      CHECK(x.ends_at(from)[id].is_open);
      const auto there = accepted(x, to);
      CHECK(x.send(from, id, 1));
      CHECK(x.send(to, there, 2));
      x.run_for(50ms);
      CHECK(x.ends_at(to)[there].received == std::vector<std::uint32_t>{1});
      CHECK(x.ends_at(from)[id].received == std::vector<std::uint32_t>{2});

      x.close(opener_closes ? from : to, opener_closes ? id : there);
      CHECK_FALSE(x.send(opener_closes ? from : to, opener_closes ? id : there, 3));
      x.run_for(50ms);
      CHECK((opener_closes ? x.ends_at(to)[there] : x.ends_at(from)[id]).why == tunnel_end::closed);
      CHECK(x.at(from).size() + x.at(to).size() == 0);
      CHECK_FALSE(x.at(from).deadline().has_value());
      CHECK_FALSE(x.at(to).deadline().has_value());
      CHECK(x.packets[kind::close] == 1);
      CHECK(x.at(from).counters().strays + x.at(to).counters().strays == 0);
      CHECK(x.at(from).counters().not_sent == (opener_closes ? 2 : 1));
    }
  }
}

TEST_CASE("a tunnel leads to where the addresses say", "[transport][PAR-05]") {
  auto a = make_tunnels(alice);
  const auto destination = [&](mote_address x) {
    const auto [id, out] = a.connect(x, start);
    static_cast<void>(a.close(id));
    return pick<packet_out>(out).at(0).destination;
  };
  CHECK(destination({own_island, mote_id{9}}) == mote_address{alice.island, mote_id{9}});
  CHECK(destination({own_island, no_mote}) == mote_address{alice.island, no_mote});
  CHECK(destination({own_island, own_mote}) == alice);
  CHECK(destination(bob) == bob);
  const auto [id, out] = a.connect({bob.island, broadcast_mote}, start);
  CHECK(pick<packet_out>(out).empty());
  CHECK(pick<tunnel_ended>(out).at(0).why == tunnel_end::unreachable);

  auto b = make_tunnels({bob.island, mote_id{9}});
  CHECK(b.on_packet(alice.island, octets_of(a.connect(bob, start).second), start).empty());
  CHECK(b.counters().misdirected == 1);
}

TEST_CASE("an opener asks with growing waits and gives up after the timeout",
          "[transport][STR-19]") {
  auto a = make_tunnels(alice);
  const auto id = a.connect(bob, start).first;
  std::vector<duration> times;
  std::vector<tunnel_ended> ends;
  while (const auto due = a.deadline()) {
    CHECK(a.on_time(*due - 1ns).empty());
    const auto out = a.on_time(*due);
    CHECK(pick<packet_out>(out).size() == 1); // the last one is a close
    times.push_back(due->time_since_epoch());
    for (const auto& x : pick<tunnel_ended>(out))
      ends.push_back(x);
  }
  CHECK(times == std::vector<duration>{1s, 3s, 7s, 15s, 23s, 30s});
  REQUIRE(ends.size() == 1);
  CHECK(ends[0].id == id);
  CHECK(ends[0].why == tunnel_end::unreachable);
  CHECK(a.size() == 0);
  CHECK(a.counters().retries == 5);
  CHECK(a.counters().unreachable == 1);
}

TEST_CASE("an opener waits as long as radios sleep on either side", "[transport][STR-19]") {
  const auto slacks = std::make_shared<const std::map<island_id, answer_slack>>(
      std::map<island_id, answer_slack>{{alice.island, {120s, 30s}}, {bob.island, {8s, 4s}}});
  struct wanted {
    mote_address from;
    mote_address to;
    duration slack;
  };
  const mote_address neighbour{alice.island, mote_id{9}};
  const mote_address gateway{alice.island, no_mote};
  for (const auto& x : {wanted{alice, pc, 120s},
                        {pc, alice, 120s},
                        {alice, bob, 128s},
                        {alice, neighbour, 120s},
                        {gateway, alice, 120s},
                        {gateway, pc, 0s}}) {
    auto core = make_tunnels(x.from, 0, 4, slacks);
    static_cast<void>(core.connect(x.to, start));
    CHECK(core.deadline() == start + 1s + x.slack);
    auto last = start;
    for (std::optional<instant> due; (due = core.deadline()); last = *due)
      static_cast<void>(core.on_time(*due));
    CHECK(last == start + 30s + 2 * x.slack);
  }
}

TEST_CASE("a tunnel to motes that sleep lives on a packet a period, whatever the delay",
          "[transport][STR-19]") {
  const auto slacks = std::make_shared<const std::map<island_id, answer_slack>>(
      std::map<island_id, answer_slack>{{alice.island, {300s, 30s}}});
  for (const auto seed : {1U, 2U, 3U, 4U, 5U}) {
    world x(30s, 0.1, seed, 4, slacks);
    const auto id = x.connect(alice, pc);
    x.run_for(2h);
    CHECK(x.ends_at(alice)[id].is_open);
    CHECK_FALSE(x.ends_at(alice)[id].is_over);
    CHECK(x.at(alice).counters().keep_alives <= 60);
    CHECK(x.at(pc).counters().keep_alives <= 60);
  }
}

TEST_CASE("an acceptor whose accepts are lost is told that the opener has given up",
          "[transport][STR-19]") {
  auto a = make_tunnels(alice);
  auto b = make_tunnels(bob, 3);
  auto packet = octets_of(a.connect(bob, start).second);
  int accepts = 0;
  for (auto now = start;; now = *a.deadline()) {
    if (now > start)
      packet = octets_of(a.on_time(now));
    const auto out = b.on_packet(alice.island, packet, now);
    accepts += static_cast<int>(pick<tunnel_accepted>(out).size());
    if (!a.deadline()) {
      CHECK(pick<tunnel_ended>(out).at(0).why == tunnel_end::closed);
      break;
    }
    CHECK(pick<packet_out>(out).size() == 1);
  }
  CHECK(accepts == 1);
  CHECK(b.size() == 0);
}

TEST_CASE("any packet of the acceptor tells that it has accepted", "[transport]") {
  auto a = make_tunnels(alice);
  auto b = make_tunnels(bob);
  const auto [id, connect] = a.connect(bob, start);
  const auto at_b = b.on_packet(alice.island, octets_of(connect), start);
  const auto there = pick<tunnel_accepted>(at_b).at(0).id;
  const auto data = octets_of(*b.send(there, bytes{1}, start));
  const auto out = a.on_packet(bob.island, data, start);
  REQUIRE(out.size() == 2);
  CHECK(std::get<tunnel_connected>(out[0]).id == id);
  CHECK(std::get<tunnel_received>(out[1]).content == bytes{1});
  CHECK(a.on_packet(bob.island, octets_of(at_b), start).empty()); // the accept, late
  CHECK(a.send(id, bytes(tunnel_content_max), start).has_value());
  CHECK_FALSE(a.send(id, bytes(tunnel_content_max + 1), start).has_value());
  CHECK(a.counters().not_sent == 1);
}

TEST_CASE("an acceptor refuses what its application does not want", "[transport]") {
  world x;
  const auto id = x.connect(alice, bob);
  x.run_for(50ms);
  x.refuse(bob, accepted(x, bob));
  x.run_for(50ms);
  CHECK(x.ends_at(alice)[id].why == tunnel_end::refused);
  CHECK(x.at(alice).counters().refused == 1);
  CHECK(x.at(alice).size() + x.at(bob).size() == 0);
  CHECK(x.at(bob).close(tunnel_id{99}).empty());
}

TEST_CASE("a full table refuses at either end", "[transport][STR-19]") {
  world x(20ms, 0, 1, 2);
  for (int i = 0; i < 2; ++i)
    x.connect(alice, bob);
  const auto third = x.connect(alice, bob); // alice's own table
  CHECK(x.ends_at(alice)[third].why == tunnel_end::refused);
  CHECK(x.at(alice).counters().no_room == 1);
  x.run_for(50ms);
  const auto fourth = x.connect(pc, bob);
  x.run_for(50ms);
  CHECK(x.ends_at(pc)[fourth].why == tunnel_end::refused);
  CHECK(x.at(pc).size() == 0);
  CHECK(x.at(bob).counters().no_room == 1);
  CHECK(x.at(bob).size() == 2);
  CHECK(x.at(alice).counters().connected == 2);

  x.close(alice, x.ends_at(alice).begin()->first);
  x.run_for(50ms);
  const auto fifth = x.connect(pc, bob);
  x.run_for(50ms);
  CHECK(x.ends_at(pc)[fifth].is_open);
}

TEST_CASE("two nodes may open tunnels to each other with the same number at once",
          "[transport][PAR-05]") {
  world x;
  const auto a = x.connect(alice, bob);
  const auto b = x.connect(bob, alice);
  x.run_for(50ms);
  const auto from_b = accepted(x, alice);
  const auto from_a = accepted(x, bob);
  CHECK((x.ends_at(alice)[a].is_open && x.ends_at(bob)[b].is_open));
  CHECK(x.send(alice, a, 1));
  CHECK(x.send(alice, from_b, 2));
  CHECK(x.send(bob, b, 3));
  CHECK(x.send(bob, from_a, 4));
  x.run_for(50ms);
  CHECK(x.ends_at(bob)[from_a].received == std::vector<std::uint32_t>{1});
  CHECK(x.ends_at(bob)[b].received == std::vector<std::uint32_t>{2});
  CHECK(x.ends_at(alice)[from_b].received == std::vector<std::uint32_t>{3});
  CHECK(x.ends_at(alice)[a].received == std::vector<std::uint32_t>{4});
  x.close(alice, a);
  x.run_for(50ms);
  CHECK(x.ends_at(bob)[from_a].is_over);
  CHECK_FALSE(x.ends_at(bob)[b].is_over);
  CHECK(x.at(alice).size() == 1);
  CHECK(x.at(bob).size() == 1);
}

TEST_CASE("an idle tunnel lives on keep-alives", "[transport]") {
  world x;
  const auto id = x.connect(alice, bob);
  x.run_for(10min);
  CHECK_FALSE(x.ends_at(alice)[id].is_over);
  CHECK(x.at(alice).counters().keep_alives == 60); // the last at the end
  CHECK(x.at(bob).counters().keep_alives == 59);
  for (int i = 0; i < 20; ++i) { // what sends anyway sends no keep-alives
    CHECK(x.send(alice, id, 1));
    x.run_for(5s);
  }
  CHECK(x.at(alice).counters().keep_alives == 60);
  CHECK(x.at(bob).counters().keep_alives == 69);
}

TEST_CASE("both ends of a tunnel notice the silence when the way between them is gone",
          "[transport][STR-19]") {
  world x;
  const auto id = x.connect(alice, bob);
  x.run_for(1s);
  const auto there = accepted(x, bob);
  x.off.insert(bob);
  x.run_until(start + 35s);
  CHECK_FALSE(x.ends_at(alice)[id].is_over);
  x.run_for(1s);
  CHECK(x.ends_at(alice)[id].why == tunnel_end::silent);
  CHECK(x.ends_at(bob)[there].why == tunnel_end::silent);
  CHECK(x.at(alice).counters().silent == 1);
  CHECK_FALSE(x.at(alice).deadline().has_value());
}

TEST_CASE("a survivor learns of a restart with its next packet", "[transport][SYN-17]") {
  for (const bool opener_restarts : {true, false}) {
    world x;
    const auto id = x.connect(alice, bob);
    x.run_for(1s);
    const auto there = accepted(x, bob);
    x.restart(opener_restarts ? alice : bob);
    const auto survivor = opener_restarts ? bob : alice;
    const auto left = opener_restarts ? there : id;
    CHECK(x.send(survivor, left, 1));
    x.run_for(50ms);
    CHECK(x.ends_at(survivor)[left].why == tunnel_end::closed);
    CHECK(x.at(opener_restarts ? alice : bob).counters().strays == 1);
    CHECK(x.contents == 0);
    CHECK(x.packets[kind::close] == 1);
  }
}

TEST_CASE("an opener that was started again opens a new tunnel, not the old one",
          "[transport][STR-19]") {
  world x(20ms, 0, 1, 1); // so that the old one would collide
  x.connect(alice, bob);
  x.run_for(1s);
  const auto old = accepted(x, bob);
  x.restart(alice);
  const auto id = x.connect(alice, bob); // the same number again
  x.run_for(50ms);
  CHECK(x.ends_at(bob)[old].why == tunnel_end::closed);
  CHECK(x.ends_at(alice)[id].is_open);
  CHECK(x.at(bob).counters().accepted == 2);
  CHECK(x.at(bob).size() == 1);
  CHECK(x.send(alice, id, 1));
  x.run_for(50ms);
  CHECK(x.contents == 1);
}

TEST_CASE("packets of an earlier life do not disturb a tunnel", "[transport]") {
  auto a = make_tunnels(alice);
  auto b = make_tunnels(bob, 14); // the life after is the first one again
  auto [id, connect] = a.connect(bob, start);
  auto out = b.on_packet(alice.island, octets_of(connect), start);
  const auto old_accept = octets_of(out);
  static_cast<void>(a.on_packet(bob.island, old_accept, start));
  const auto old_data = octets_of(*a.send(id, bytes{1}, start));

  SECTION("of the opener") {
    a = make_tunnels(alice, 1);
    auto [next, again] = a.connect(bob, start);
    out = b.on_packet(alice.island, octets_of(again), start);
    CHECK(pick<tunnel_ended>(out).size() == 1);
    CHECK(pick<tunnel_accepted>(out).size() == 1);
    out = b.on_packet(alice.island, octets_of(connect), start); // late, or a copy
    CHECK(pick<tunnel_accepted>(out).empty());
    CHECK(pick<tunnel_ended>(out).empty());
    CHECK(a.on_packet(bob.island, octets_of(out), start).empty());
    out = b.on_packet(alice.island, old_data, start);
    CHECK(pick<tunnel_received>(out).empty());
    CHECK(a.on_packet(bob.island, octets_of(out), start).empty()); // a close of the old one
    CHECK((a.size() == 1 && b.size() == 1));
    CHECK((a.counters().strays == 2 && b.counters().strays == 2));
  }
  SECTION("of the acceptor") {
    static_cast<void>(a.close(id));
    auto [next, again] = a.connect(bob, start);
    b = make_tunnels(bob, 15);
    static_cast<void>(b.on_packet(alice.island, octets_of(again), start));
    CHECK(b.size() == 1);
    out = b.on_packet(alice.island, old_data, start);
    CHECK(a.on_packet(bob.island, octets_of(out), start).empty()); // a close of the old one
    CHECK((a.size() == 1 && b.size() == 1));
  }
}

TEST_CASE("a connect of an earlier life that nobody has seen ends nothing", "[transport]") {
  for (const std::uint32_t earlier : {0U, 14U}) { // 14: the next life is the first one again
    auto b = make_tunnels(bob);
    auto old = make_tunnels(alice, earlier);
    auto a = make_tunnels(alice, earlier + 1);
    const auto late = octets_of(old.connect(bob, start).second);
    CHECK(b.connect(alice, start).second.size() == 1); // connecting: with whatever life
    const auto now = octets_of(a.connect(bob, start).second);
    CHECK(pick<tunnel_accepted>(b.on_packet(alice.island, now, start)).size() == 1);
    const auto out = b.on_packet(alice.island, late, start);
    CHECK(pick<tunnel_ended>(out).empty());
    CHECK(pick<tunnel_accepted>(out).empty());
    CHECK(old.on_packet(bob.island, octets_of(out), start).size() == 1); // ended: closed
    CHECK(b.size() == 2);
  }
}

TEST_CASE("a number in use is not given to another tunnel", "[transport]") {
  auto a = make_tunnels(alice);
  const auto first = octets_of(a.connect(bob, start).second);
  for (int i = 1; i < 0x10000; ++i)
    static_cast<void>(a.close(a.connect(bob, start).first));
  const auto next = octets_of(a.connect(bob, start).second);
  CHECK(decode_tunnel_message(first)->number == 1);
  CHECK(decode_tunnel_message(next)->number == 2);
}

TEST_CASE("a connect that comes again is not a second tunnel", "[transport][STR-19]") {
  auto a = make_tunnels(alice);
  auto b = make_tunnels(bob);
  const auto [id, connect] = a.connect(bob, start);
  const auto first = b.on_packet(alice.island, octets_of(connect), start);
  const auto again = b.on_packet(alice.island, octets_of(connect), start + 1s);
  CHECK(octets_of(again) == octets_of(first));
  CHECK(pick<tunnel_accepted>(again).empty());

  static_cast<void>(b.close(pick<tunnel_accepted>(first).at(0).id)); // and the close is lost
  const auto late = b.on_packet(alice.island, octets_of(connect), start + 2s);
  CHECK(pick<tunnel_accepted>(late).empty());
  CHECK(b.size() == 0);
  const auto out = a.on_packet(bob.island, octets_of(late), start + 2s);
  CHECK(pick<tunnel_ended>(out).at(0).why == tunnel_end::closed);
}

TEST_CASE("only the last tunnels that ended are remembered", "[transport]") {
  auto b = make_tunnels(bob);
  std::vector<bytes> connects;
  for (std::uint8_t i = 0; i < 5; ++i) {
    connects.push_back({0x01, 0, 7, 0, 8, 0, i, 0x10});
    const auto out = b.on_packet(alice.island, connects.back(), start);
    static_cast<void>(b.close(pick<tunnel_accepted>(out).at(0).id));
  }
  CHECK(pick<tunnel_accepted>(b.on_packet(alice.island, connects[1], start)).empty());
  CHECK(pick<tunnel_accepted>(b.on_packet(alice.island, connects[0], start)).size() == 1);
  CHECK(b.footprint() == 4 * 28 + 4 * 8 + 16);
}

TEST_CASE("a packet for an unknown tunnel is answered with close, and a close with nothing",
          "[transport]") {
  auto a = make_tunnels(alice);
  tunnel_message x{kind::data, false, bob.mote, alice.mote, 5, 2, 9, {1}};
  const auto out = a.on_packet(bob.island, encode(x), start);
  REQUIRE(pick<packet_out>(out).size() == 1);
  CHECK(pick<packet_out>(out)[0].destination == bob);
  const tunnel_message close{kind::close, true, alice.mote, bob.mote, 5, 2, 9, {}};
  CHECK(*decode_tunnel_message(octets_of(out)) == close);
  x.content.clear();
  x.what = kind::keep_alive;
  CHECK(octets_of(a.on_packet(bob.island, encode(x), start)) == encode(close));
  x.what = kind::close;
  CHECK(a.on_packet(bob.island, encode(x), start).empty());
  x.from_acceptor = true;
  x.what = kind::accept;
  CHECK(pick<packet_out>(a.on_packet(bob.island, encode(x), start)).size() == 1);
  x.what = kind::refuse;
  CHECK(a.on_packet(bob.island, encode(x), start).empty());
  CHECK(a.counters().strays == 5);
  CHECK(a.size() == 0);
}
