#include <algorithm>
#include <deque>
#include <map>

#include "support/catch.hpp"
#include "support/pick.hpp"
#include "transport/endpoint.hpp"

using namespace rubicon;
using namespace rubicon::transport;
using test::pick;

namespace {

constexpr island_id island{1};
constexpr mote_id alice{7};
constexpr mote_id bob{8};
constexpr instant start{};

endpoint make(mote_id self, std::uint64_t seed = 1) {
  endpoint_config config;
  config.self = self;
  return endpoint(config, random_stream(seed));
}

/// Carries segments between two endpoints, losing, repeating and reordering them at seeded rates.
struct lossy_pipe {
  endpoint& a;
  endpoint& b;
  double loss;
  random_stream dice;
  std::multimap<instant, std::pair<bool, bytes>> in_flight{}; ///< true: towards b
  std::vector<received> at_b{};
  std::map<ticket, int> outcomes{};
  std::map<ticket, bool> acked{};

  void take(bool from_a, const outputs& todo, instant now) {
    for (const auto& x : pick<to_network>(todo)) {
      if (dice.chance(loss))
        continue;
      const auto copies = dice.chance(0.1) ? 2 : 1;
      for (int i = 0; i < copies; ++i)
        in_flight.emplace(now + dice.between(1ms, 400ms), std::pair(from_a, x.segment));
    }
    for (const auto& x : pick<outcome>(todo)) {
      ++outcomes[x.id];
      acked[x.id] = x.acked;
    }
    if (!from_a)
      for (const auto& x : pick<received>(todo))
        at_b.push_back(x);
  }

  void run() {
    for (;;) {
      auto next = earliest(a.deadline(), b.deadline());
      if (!in_flight.empty())
        next = earliest(next, in_flight.begin()->first);
      if (!next)
        return;
      const auto now = *next;
      while (!in_flight.empty() && in_flight.begin()->first <= now) {
        const auto [to_b, octets] = in_flight.begin()->second;
        in_flight.erase(in_flight.begin());
        take(!to_b, (to_b ? b : a).on_segment(island, octets, now), now);
      }
      take(true, a.on_time(now), now);
      take(false, b.on_time(now), now);
    }
  }
};

} // namespace

TEST_CASE("a reliable message is acknowledged and passed up once", "[transport][MCK-10][MCK-12]") {
  auto a = make(alice);
  auto b = make(bob, 2);
  const auto sent = a.send(1, {own_island, bob}, 10, bytes{1, 2}, true, start);
  REQUIRE(sent.has_value());
  const auto packet = pick<to_network>(*sent).at(0);
  CHECK(packet.channel == 10);
  const auto at_b = b.on_segment(island, packet.segment, start);
  REQUIRE(pick<received>(at_b).size() == 1);
  CHECK(pick<received>(at_b)[0].source == mote_address{island, alice});
  CHECK(pick<received>(at_b)[0].payload == bytes{1, 2});
  const auto ack = pick<to_network>(at_b).at(0);
  CHECK(ack.destination == mote_address{island, alice});

  const auto done = a.on_segment(island, ack.segment, start + 5ms);
  REQUIRE(pick<outcome>(done).size() == 1);
  CHECK(pick<outcome>(done)[0].acked);
  CHECK_FALSE(a.deadline().has_value());

  const auto again = b.on_segment(island, packet.segment, start + 10ms);
  CHECK(pick<received>(again).empty());
  CHECK(pick<to_network>(again).size() == 1); // acknowledged again, its first ack may be lost
  CHECK(b.counters().duplicates == 1);
  CHECK(pick<outcome>(a.on_segment(island, ack.segment, start + 20ms)).empty());
  CHECK(a.counters().stray_acks == 1);
}

TEST_CASE("an unanswered message is repeated with growing waits and then fails",
          "[transport][MCK-10]") {
  auto a = make(alice);
  REQUIRE(a.send(1, {island, bob}, 10, {}, true, start).has_value());
  std::vector<duration> times;
  std::vector<outcome> ends;
  while (const auto due = a.deadline()) {
    CHECK(a.on_time(*due - 1ns).empty());
    const auto out = a.on_time(*due);
    if (!pick<to_network>(out).empty())
      times.push_back(due->time_since_epoch());
    for (const auto& x : pick<outcome>(out)) {
      CHECK(due->time_since_epoch() == 15500ms);
      ends.push_back(x);
    }
  }
  CHECK(times == std::vector<duration>{500ms, 1500ms, 3500ms, 7500ms});
  REQUIRE(ends.size() == 1);
  CHECK_FALSE(ends[0].acked);
  CHECK(a.counters().reliable_failed == 1);
}

TEST_CASE("a send is refused when it cannot be honoured", "[transport][MCK-09]") {
  auto a = make(alice);
  CHECK(a.send(1, {island, bob}, 10, bytes(payload_max), false, start).has_value());
  CHECK_FALSE(a.send(1, {island, bob}, 10, bytes(payload_max + 1), false, start).has_value());
  CHECK_FALSE(a.send(1, {island, broadcast_mote}, 10, {}, true, start).has_value());
  CHECK(a.send(1, {island, broadcast_mote}, 10, {}, false, start).has_value());
  for (ticket i = 0; i < 8; ++i)
    CHECK(a.send(i, {island, bob}, 10, {}, true, start).has_value());
  CHECK_FALSE(a.send(9, {island, bob}, 10, {}, true, start).has_value());
  CHECK(a.counters().refused == 3);
  CHECK(pick<outcome>(a.fail_all()).size() == 8);
  CHECK_FALSE(a.deadline().has_value());
}

TEST_CASE("an acknowledgement from another mote is not taken", "[transport]") {
  auto a = make(alice);
  const auto sent = a.send(1, {island, bob}, 10, {}, true, start);
  const auto sequence = decode_segment(pick<to_network>(*sent)[0].segment)->sequence;
  const segment stranger{mote_id{9}, sequence, 10, false, true, {}};
  CHECK(a.on_segment(island, encode(stranger), start).empty());
  CHECK(a.outstanding() == 1);
}

TEST_CASE("broken segments are counted and dropped", "[transport]") {
  auto a = make(alice);
  CHECK(a.on_segment(island, bytes{1, 2, 3}, start).empty());
  CHECK(a.counters().malformed == 1);
}

TEST_CASE("memory for duplicates is bounded and keeps the most recently heard", "[transport]") {
  endpoint_config config;
  config.self = bob;
  config.sources_max = 2;
  endpoint b(config, random_stream(1));
  const auto hear = [&](std::uint16_t mote) {
    return !pick<received>(
                b.on_segment(island, encode({mote_id{mote}, 1, 10, true, false, {}}), start))
                .empty();
  };
  CHECK(hear(1));
  CHECK(hear(2));
  CHECK_FALSE(hear(1));
  CHECK(hear(3)); // forgets 2
  CHECK_FALSE(hear(1));
  CHECK(hear(2));
}

TEST_CASE("over a lossy, repeating, reordering pipe every reliable message has one outcome and at "
          "most one delivery",
          "[transport][MCK-12][IF-07]") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    auto a = make(alice, seed);
    auto b = make(bob, seed + 1000);
    lossy_pipe between{a, b, 0.4, random_stream(seed)};
    for (ticket id = 1; id <= 8; ++id)
      between.take(
          true, *a.send(id, {island, bob}, 10, bytes{static_cast<std::uint8_t>(id)}, true, start),
          start);
    between.run();
    REQUIRE(between.outcomes.size() == 8);
    std::map<std::uint8_t, int> delivered;
    for (const auto& x : between.at_b)
      ++delivered[x.payload[0]];
    for (const auto& [id, count] : between.outcomes) {
      CHECK(count == 1);
      CHECK(delivered[static_cast<std::uint8_t>(id)] <= 1);
      if (between.acked[id])
        CHECK(delivered[static_cast<std::uint8_t>(id)] == 1);
    }
    CHECK(a.counters().reliable_sent == a.counters().reliable_acked + a.counters().reliable_failed);
  }
}
