#include <algorithm>
#include <map>
#include <vector>

#include "support/catch.hpp"
#include "support/pick.hpp"
#include "support/start.hpp"
#include "transport/messenger.hpp"

using namespace rubicon;
using namespace rubicon::transport;
using test::pick;
using test::start;

namespace {

constexpr island_id island{1};
constexpr mote_id alice_mote{7};
constexpr mote_id bob_mote{8};

messenger make(mote_id self, std::uint32_t incarnation = 0, std::uint64_t seed = 1) {
  messenger_config config;
  config.self = self;
  config.incarnation = incarnation;
  messenger x(config, random_stream(seed));
  x.join(island);
  return x;
}

/// Two ends and a network between them that loses, repeats and reorders segments at seeded rates.
/// Either end may be started again; what is in flight stays in flight.
class pair_of_ends {
public:
  pair_of_ends(double loss, duration delay_max, std::uint64_t seed = 1)
      : loss_(loss), delay_max_(delay_max), rng_(seed) {
    restart(alice_mote);
    restart(bob_mote);
  }

  void restart(mote_id who) {
    auto& x = nodes_[who];
    if (x.end) {
      for (const auto& [id, ended] : x.outcomes)
        aborted += ended == 0 ? 1 : 0;
    }
    x.outcomes.clear();
    x.end = make(who, x.lives++, rng_.next());
    x.handled.clear();
  }

  messenger& at(mote_id who) { return *nodes_.at(who).end; }
  [[nodiscard]] instant now() const { return now_; }

  /// @returns whether it was accepted
  bool send(mote_id from, mote_id to, std::uint16_t number, std::uint8_t am_type = 10) {
    auto todo = at(from).send(
        number, {own_island, to}, am_type,
        {static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number)}, true, now_);
    if (!todo)
      return false;
    nodes_[from].outcomes[number] = 0;
    take(from, *todo);
    return true;
  }

  void run_for(duration length) {
    const auto end = now_ + length;
    while (true) {
      auto next = earliest(at(alice_mote).deadline(), at(bob_mote).deadline());
      if (!in_flight_.empty())
        next = earliest(next, in_flight_.begin()->first);
      if (!next || *next > end) {
        now_ = end;
        return;
      }
      now_ = std::max(now_, *next);
      while (!in_flight_.empty() && in_flight_.begin()->first <= now_) {
        const auto x = in_flight_.extract(in_flight_.begin());
        take(x.mapped().first, at(x.mapped().first).on_segment(island, x.mapped().second, now_));
      }
      for (const auto who : {alice_mote, bob_mote})
        take(who, at(who).on_time(now_));
    }
  }

  void settle() { run_for(5min); }

  std::vector<std::uint16_t> handled;  ///< by anybody, in order
  std::map<std::uint16_t, bool> acked; ///< of messages that have ended
  std::map<std::uint16_t, int> ends;   ///< outcomes of each message
  int aborted = 0;                     ///< open when their sender was started again
  double copies = 0;                   ///< chance that a segment is repeated

private:
  struct node {
    std::optional<messenger> end;
    std::uint32_t lives = 0;
    std::map<std::uint16_t, int> outcomes;
    std::vector<std::uint16_t> handled;
  };

  void take(mote_id who, const outputs& todo) {
    for (const auto& x : pick<to_network>(todo)) {
      if (rng_.chance(loss_))
        continue;
      const int count = rng_.chance(copies) ? 2 : 1;
      for (int i = 0; i < count; ++i)
        in_flight_.emplace(now_ + rng_.between(1ms, delay_max_),
                           std::pair(x.destination.mote, x.segment));
    }
    for (const auto& x : pick<outcome>(todo)) {
      const auto number = static_cast<std::uint16_t>(x.id);
      ++nodes_[who].outcomes[number];
      ++ends[number];
      acked[number] = x.acked;
    }
    for (const auto& x : pick<received>(todo))
      handled.push_back(static_cast<std::uint16_t>(x.payload.at(0) << 8 | x.payload.at(1)));
  }

  double loss_;
  duration delay_max_;
  random_stream rng_;
  instant now_;
  std::map<mote_id, node> nodes_;
  std::multimap<instant, std::pair<mote_id, bytes>> in_flight_;
};

int count_of(const std::vector<std::uint16_t>& all, std::uint16_t x) {
  return static_cast<int>(std::count(all.begin(), all.end(), x));
}

} // namespace

TEST_CASE("a reliable message is greeted, acknowledged and passed up once",
          "[transport][GEN-08][MCK-10][MCK-12]") {
  auto a = make(alice_mote);
  auto b = make(bob_mote, 3, 2);
  const auto asked = a.send(1, {own_island, bob_mote}, 10, bytes{1, 2}, true, start);
  REQUIRE(asked.has_value());
  const auto hello = pick<to_network>(*asked).at(0);
  CHECK(hello.destination == mote_address{island, bob_mote});
  const auto known = b.on_segment(island, hello.segment, start);
  CHECK(pick<received>(known).empty());
  const auto sent = a.on_segment(island, pick<to_network>(known).at(0).segment, start);
  const auto packet = pick<to_network>(sent).at(0);
  CHECK(packet.channel == 10);
  CHECK(decode_segment(packet.segment)->receiver == 3);

  const auto at_b = b.on_segment(island, packet.segment, start);
  REQUIRE(pick<received>(at_b).size() == 1);
  CHECK(pick<received>(at_b)[0].source == mote_address{island, alice_mote});
  CHECK(pick<received>(at_b)[0].payload == bytes{1, 2});
  const auto ack = pick<to_network>(at_b).at(0);
  const auto done = a.on_segment(island, ack.segment, start + 5ms);
  REQUIRE(pick<outcome>(done).size() == 1);
  CHECK(pick<outcome>(done)[0].acked);
  CHECK_FALSE(a.deadline().has_value());

  const auto again = b.on_segment(island, packet.segment, start + 10ms);
  CHECK(pick<received>(again).empty());
  CHECK(pick<to_network>(again).size() == 1); // acknowledged again, its first ack may be lost
  CHECK(b.counters().duplicates == 1);
  CHECK(pick<outcome>(a.on_segment(island, ack.segment, start + 20ms)).empty());
  CHECK(a.counters().stray_answers == 1);
}

TEST_CASE("only the first message to a receiver costs a greeting", "[transport][MCK-12]") {
  pair_of_ends x(0, 10ms);
  for (std::uint16_t i = 0; i < 5; ++i)
    CHECK(x.send(alice_mote, bob_mote, i));
  x.settle();
  CHECK(x.at(alice_mote).counters().hellos == 1);
  CHECK(x.handled == std::vector<std::uint16_t>{0, 1, 2, 3, 4});
  CHECK(x.at(alice_mote).counters().retries == 0);
}

TEST_CASE("an unanswered message is repeated with growing waits and then fails",
          "[transport][MCK-10]") {
  auto a = make(alice_mote);
  REQUIRE(a.send(1, {island, bob_mote}, 10, {}, true, start).has_value());
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

TEST_CASE("a send is refused when it cannot be honoured", "[transport][MCK-09][WIR-03]") {
  auto a = make(alice_mote);
  CHECK(a.send(1, {island, bob_mote}, 10, bytes(256), false, start).has_value());
  CHECK_FALSE(a.send(1, {island, bob_mote}, 10, bytes(257), false, start).has_value());
  CHECK_FALSE(a.send(1, {island, broadcast_mote}, 10, {}, true, start).has_value());
  CHECK(a.send(1, {island, broadcast_mote}, 10, {}, false, start).has_value());
  for (ticket i = 0; i < 8; ++i)
    CHECK(a.send(i, {island, bob_mote}, 10, {}, true, start).has_value());
  CHECK_FALSE(a.send(9, {island, bob_mote}, 10, {}, true, start).has_value());
  CHECK(a.counters().refused == 3);
  CHECK(pick<outcome>(a.fail_all()).size() == 8);
  CHECK_FALSE(a.deadline().has_value());
}

TEST_CASE("answers of others are not taken", "[transport][MCK-12]") {
  auto a = make(alice_mote);
  const auto sent = a.send(1, {island, bob_mote}, 10, {}, true, start);
  auto answer = *decode_segment(pick<to_network>(*sent)[0].segment);
  answer.what = segment::kind::acknowledgement;
  answer.source = mote_id{9};
  CHECK(a.on_segment(island, encode(answer), start).empty());
  answer.source = bob_mote;
  answer.sender = 5; // to another incarnation of ours
  CHECK(a.on_segment(island, encode(answer), start).empty());
  CHECK(a.counters().stray_answers == 2);
  CHECK(a.outstanding() == 1);
}

TEST_CASE("broken segments are counted and dropped", "[transport]") {
  auto a = make(alice_mote);
  CHECK(a.on_segment(island, bytes{1, 2, 3}, start).empty());
  CHECK(a.counters().malformed == 1);
}

TEST_CASE("a receiver without room delays its senders and loses nothing", "[transport][MCK-18]") {
  pair_of_ends x(0.1, 20ms);
  x.at(bob_mote).hold(10);
  for (std::uint16_t i = 0; i < 8; ++i)
    CHECK(x.send(alice_mote, bob_mote, i));
  CHECK(x.send(bob_mote, alice_mote, 100));
  x.run_for(2min);
  CHECK(x.handled == std::vector<std::uint16_t>{100});
  CHECK(x.ends.size() == 1);
  CHECK(x.at(bob_mote).counters().throttled > 100);
  x.at(bob_mote).release(10);
  x.settle();
  CHECK(x.handled == std::vector<std::uint16_t>{100, 0, 1, 2, 3, 4, 5, 6, 7});
  CHECK(x.at(alice_mote).counters().reliable_acked == 8);
}

TEST_CASE("a receiver without room for one AM type takes the others", "[transport][NFR-04]") {
  pair_of_ends x(0, 20ms);
  x.at(bob_mote).hold(10);
  CHECK(x.send(alice_mote, bob_mote, 1, 11));
  x.settle();
  CHECK(x.handled == std::vector<std::uint16_t>{1});
}

TEST_CASE("another incarnation of the receiver is greeted when it is known to be one",
          "[transport][DIS-07][MCK-12]") {
  pair_of_ends x(0, 10ms);
  CHECK(x.send(alice_mote, bob_mote, 1));
  x.settle();
  x.restart(bob_mote);
  x.at(alice_mote).forget_incarnation({own_island, bob_mote});
  CHECK(x.send(alice_mote, bob_mote, 2));
  x.settle();
  CHECK(x.handled == std::vector<std::uint16_t>{1, 2});
  CHECK(x.at(bob_mote).counters().strangers == 0);
  CHECK(x.at(alice_mote).counters().hellos == 2);
}

TEST_CASE("another incarnation of the receiver refuses what was for the first",
          "[transport][DIS-07][MCK-12]") {
  pair_of_ends x(0, 10ms);
  CHECK(x.send(alice_mote, bob_mote, 1));
  x.settle();
  x.restart(bob_mote);
  CHECK(x.send(alice_mote, bob_mote, 2));
  CHECK(x.send(alice_mote, bob_mote, 3));
  x.settle();
  CHECK(x.handled == std::vector<std::uint16_t>{1, 3});
  CHECK_FALSE(x.acked.at(2));
  CHECK(x.at(bob_mote).counters().strangers == 1);
}

TEST_CASE("a receiver is not greeted in the midst of a message", "[transport][DIS-07][MCK-12]") {
  pair_of_ends x(0, 10ms);
  CHECK(x.send(alice_mote, bob_mote, 1));
  x.settle();
  auto& a = x.at(alice_mote);
  const auto first =
      pick<to_network>(*a.send(2, {own_island, bob_mote}, 10, {2}, true, x.now())).at(0);
  a.forget_incarnation({own_island, bob_mote}); // whether it has the message nobody knows
  const auto again = pick<to_network>(a.on_time(*a.deadline())).at(0);
  CHECK(again.segment == first.segment);
}

TEST_CASE("a receiver that has forgotten its sender is greeted again", "[transport][AM-03]") {
  messenger_config config;
  config.self = bob_mote;
  config.sources_max = 1;
  messenger b(config, random_stream(1));
  auto a = make(alice_mote);
  auto c = make(mote_id{9});
  int arrived = 0;
  const auto deliver = [&](messenger& from, ticket id) {
    auto todo = *from.send(id, {island, bob_mote}, 10, {1}, true, start);
    while (!pick<to_network>(todo).empty()) {
      const auto answer = b.on_segment(island, pick<to_network>(todo)[0].segment, start);
      arrived += static_cast<int>(pick<received>(answer).size());
      todo = from.on_segment(island, pick<to_network>(answer).at(0).segment, start);
    }
    return pick<outcome>(todo).at(0).acked;
  };
  CHECK(deliver(a, 1));
  CHECK(deliver(c, 1));
  CHECK(deliver(a, 2));
  CHECK(arrived == 3);
}

TEST_CASE("many starts of a sender are not taken for old ones for ever", "[transport][DIS-07]") {
  pair_of_ends x(0, 10ms);
  CHECK(x.send(alice_mote, bob_mote, 1));
  x.settle();
  for (int i = 0; i < 12; ++i)
    x.restart(alice_mote);
  CHECK(x.send(alice_mote, bob_mote, 2));
  x.settle();
  CHECK(x.handled == std::vector<std::uint16_t>{1, 2});
}

TEST_CASE("a reliable message that no program takes fails at once", "[transport][ACK-01][AM-01]") {
  messenger_config config;
  config.self = alice_mote;
  messenger a(config, random_stream(1));
  config.self = bob_mote;
  messenger b(config, random_stream(2));
  a.join(island);
  b.join(island);
  const auto only_10 = [](std::uint8_t am_type) { return am_type == 10; };
  const auto deliver = [&](ticket id, std::uint8_t am_type) {
    auto todo = *a.send(id, {island, bob_mote}, am_type, {1}, true, start);
    std::size_t arrived = 0;
    while (!pick<to_network>(todo).empty()) {
      const auto at_b = b.on_segment(island, pick<to_network>(todo).at(0).segment, start, only_10);
      arrived += pick<received>(at_b).size();
      todo = a.on_segment(island, pick<to_network>(at_b).at(0).segment, start);
    }
    CHECK(pick<outcome>(todo).at(0).acked == (arrived == 1));
    return arrived == 1;
  };
  CHECK(deliver(1, 10));
  CHECK(!deliver(2, 11));
  CHECK(deliver(3, 10)); // the session goes on
  CHECK(a.counters().failed_no_program == 1);
  CHECK(b.counters().no_program == 1);
}

TEST_CASE("memory for sources and sessions is bounded", "[transport][AM-03]") {
  messenger_config config;
  config.self = bob_mote;
  config.sources_max = 2;
  config.sessions_max = 2;
  messenger b(config, random_stream(1));
  b.join(island);
  const auto hear = [&](std::uint16_t mote, segment::kind what, std::uint16_t counter) {
    segment x;
    x.source = mote_id{mote};
    x.what = what;
    x.counter = counter;
    const auto answer = pick<to_network>(b.on_segment(island, encode(x), start));
    return decode_segment(answer.at(0).segment)->what;
  };
  for (std::uint16_t mote = 1; mote <= 3; ++mote) {
    CHECK(hear(mote, segment::kind::hello, 1) == segment::kind::acknowledgement);
    CHECK(hear(mote, segment::kind::reliable, 2) == segment::kind::acknowledgement);
  }
  CHECK(hear(2, segment::kind::reliable, 2) == segment::kind::acknowledgement);
  CHECK(hear(1, segment::kind::reliable, 2) == segment::kind::refused); // forgotten
  CHECK(b.counters().received == 3);
}

TEST_CASE("a session above their limit ends with its last message", "[transport][AM-03]") {
  messenger_config config;
  config.self = alice_mote;
  config.sessions_max = 1;
  messenger a(config, random_stream(1));
  a.join(island);
  std::map<mote_id, segment> sent; // last to each
  const auto take = [&](const outputs& todo) {
    for (const auto& x : pick<to_network>(todo))
      sent[x.destination.mote] = *decode_segment(x.segment);
  };
  const auto send = [&](mote_id to) {
    take(a.send(1, {own_island, to}, 10, {1}, true, start).value());
  };
  const auto acknowledge = [&](mote_id from) {
    auto answer = sent.at(from);
    answer.source = from;
    answer.what = segment::kind::acknowledgement;
    answer.receiver = 0;
    answer.payload.clear();
    take(a.on_segment(island, encode(answer), start));
  };
  constexpr mote_id carol{9};
  for (const auto to : {bob_mote, carol})
    send(to); // neither can be forgotten while its message is in flight
  for (const auto from : {bob_mote, bob_mote, carol, carol})
    acknowledge(from); // the greeting, then the message
  CHECK(a.outstanding() == 0);
  CHECK(a.counters().hellos == 2);
  send(carol);
  CHECK(sent.at(carol).what == segment::kind::reliable);
  send(bob_mote);
  CHECK(sent.at(bob_mote).what == segment::kind::hello);
}

TEST_CASE("who answers slowly is asked once, after a few messages", "[transport][MCK-12][MCK-18]") {
  const auto round_trip = GENERATE(duration(100ms), duration(900ms), duration(3s));
  auto a = make(alice_mote);
  auto b = make(bob_mote);
  std::map<instant, std::pair<mote_id, bytes>> in_flight; // to whom
  instant now = start;
  int acked = 0;
  const auto take = [&](mote_id from, const outputs& todo) {
    for (const auto& x : pick<to_network>(todo)) {
      auto at = now + round_trip / 2;
      while (in_flight.contains(at))
        at += 1ns;
      in_flight[at] = {from == alice_mote ? bob_mote : alice_mote, x.segment};
    }
    for (const auto& x : pick<outcome>(todo))
      acked += x.acked ? 1 : 0;
  };
  std::uint64_t retries = 0;
  for (ticket i = 0; i < 20; ++i) {
    if (i == 4)
      retries = a.counters().retries;
    take(alice_mote, *a.send(i, {island, bob_mote}, 10, {1}, true, now));
    for (const auto end = now + 20s; now < end;) {
      now = std::min(end, *earliest(a.deadline(), end));
      if (!in_flight.empty())
        now = std::min(now, in_flight.begin()->first);
      while (!in_flight.empty() && in_flight.begin()->first <= now) {
        const auto [to, octets] = in_flight.extract(in_flight.begin()).mapped();
        take(to, (to == alice_mote ? a : b).on_segment(island, octets, now));
      }
      take(alice_mote, a.on_time(now));
    }
  }
  CHECK(acked == 20);
  CHECK(a.counters().retries == retries);
}

TEST_CASE("a receiver that is gone is given up at the same time, however slowly it answered",
          "[transport][MCK-12]") {
  messenger_config config;
  config.self = alice_mote;
  messenger a(config, random_stream(1));
  a.join(island);
  auto now = start;
  const auto answer = [&](const outputs& todo) {
    auto x = *decode_segment(pick<to_network>(todo).at(0).segment);
    x.source = bob_mote;
    x.what = segment::kind::acknowledgement;
    x.payload.clear();
    return encode(x);
  };
  auto todo = *a.send(1, {island, bob_mote}, 10, {1}, true, now);
  for (int i = 0; i < 12; ++i) { // the greeting, then messages: each is answered after 400 ms
    const auto octets = answer(todo);
    auto next = a.on_segment(island, octets, now += 400ms);
    if (pick<to_network>(next).empty())
      next = *a.send(2, {island, bob_mote}, 10, {1}, true, now);
    todo = next;
  }
  const auto asked = now;
  int attempts = 1;
  while (a.outstanding() > 0) {
    now = *a.deadline();
    attempts += static_cast<int>(pick<to_network>(a.on_time(now)).size());
  }
  CHECK(attempts == 5);
  CHECK(now - asked == 31 * config.ack_wait);
}

TEST_CASE("over a bad network every reliable message ends once and arrives once at most, in order",
          "[transport][MCK-12][MCK-18][IF-07][RTG-07]") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    pair_of_ends x(0.3, 400ms, seed);
    x.copies = 0.2;
    for (std::uint16_t i = 0; i < 8; ++i)
      REQUIRE(x.send(alice_mote, bob_mote, i));
    x.settle();
    REQUIRE(x.ends.size() == 8);
    CHECK(std::is_sorted(x.handled.begin(), x.handled.end()));
    for (const auto& [number, count] : x.ends) {
      CHECK(count == 1);
      const auto arrived = count_of(x.handled, number);
      CHECK(arrived <= 1);
      if (x.acked[number])
        CHECK(arrived == 1);
    }
  }
}

TEST_CASE("restarts of either end double nothing and leave nothing open",
          "[transport][MCK-12][DIS-07][IF-07]") {
  int reported_failed_yet_arrived = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    pair_of_ends x(0.2, 600ms, seed);
    x.copies = 0.2;
    random_stream rng(seed, "restarts");
    std::uint16_t accepted = 0;
    for (std::uint16_t i = 0; i < 40; ++i) {
      if (x.send(i % 2 == 0 ? alice_mote : bob_mote, i % 2 == 0 ? bob_mote : alice_mote, i))
        ++accepted;
      x.run_for(rng.between(0s, 1s));
      if (rng.chance(0.15))
        x.restart(rng.chance(0.5) ? alice_mote : bob_mote);
    }
    x.settle();
    REQUIRE(x.ends.size() + static_cast<std::size_t>(x.aborted) == accepted);
    for (const auto& [number, count] : x.ends)
      CHECK(count == 1);
    for (std::uint16_t i = 0; i < 40; ++i) {
      CHECK(count_of(x.handled, i) <= 1);
      const auto ended = x.acked.find(i);
      if (ended != x.acked.end() && ended->second)
        CHECK(count_of(x.handled, i) == 1);
      else if (ended != x.acked.end())
        reported_failed_yet_arrived += count_of(x.handled, i);
    }
  }
  CHECK(reported_failed_yet_arrived > 0); // legal, and it does happen
}
