// Attackers who have recorded, stolen or kept something: what each can do, and for how long.
#include <algorithm>

#include "core/codec.hpp"
#include "smepp/handshake.hpp"
#include "smepp_world.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::smepp;
using namespace rubicon::smepp::test;

namespace {

group_description kitchen(duration period = 0s) {
  group_description x{.name = "kitchen", .master = key_of(9), .is_closed = true};
  if (period > 0s)
    x.management = {period, 100ms};
  return x;
}

group_id create(world& w, std::size_t i, const group_description& x) {
  return std::get<group_id>(w.with(
      i, [&](peer& each, instant t, outputs& out) { return each.smepp_createGroup(x, t, out); }));
}

const group& group_of(world& w, std::size_t i, group_id id) {
  return *w.at(i).groups().find(id);
}

bool is_in(world& w, std::size_t i, group_id id) {
  return w.at(i).groups().find(id) != nullptr;
}

std::uint64_t sent(world& w, std::size_t i, const std::string& what) {
  const auto& all = w.at(i).counters().sent;
  return all.contains(what) ? all.at(what) : 0;
}

/// Somebody within reach of all, under any name.
class intruder {
public:
  /// Has the network's keys. @param counter above those that its names have used
  explicit intruder(world& w, std::uint64_t counter = 20'000) : w_(w), counter_(counter) {}

  void say(std::size_t to, mote_id name, mote_id receiver, const message& x,
           group_id group = network_level, session_id session = {},
           const std::vector<session_keys>& keys = {}) {
    auto own = sealer(name, group, keys);
    w_.inject(to, name, receiver, *own.seal(receiver, group, session, encode(x)));
  }

  /// The messages that somebody has sent to a name, at network level.
  template <class Message>
  std::vector<Message> overheard(mote_id from, mote_id to) {
    std::vector<Message> all;
    security own({.self = mote_id{200}}, 0);
    own.set_network_keys(w_.network, w_.now());
    for (const auto& x : w_.air()) {
      if (x.from != from || x.to != to)
        continue;
      const auto opened = own.open(x.from, x.to, x.octets, w_.now());
      if (const auto* const frame = std::get_if<opened_frame>(&opened))
        if (const auto said = decode(frame->content))
          if (const auto* const found = std::get_if<Message>(&*said))
            all.push_back(*found);
    }
    return all;
  }

private:
  security sealer(mote_id name, group_id group, const std::vector<session_keys>& keys) {
    security own({.self = name}, counter_ += 3);
    own.set_network_keys(w_.network, w_.now());
    if (group != network_level)
      own.set_group(group, keys);
    return own;
  }

  world& w_;
  std::uint64_t counter_;
};

/// What an intruder gets who joins, or catches up, in another's name.
struct break_in {
  bool was_asked = false;
  bool was_admitted = false;
  bool has_keys = false; ///< and could open them
};

break_in enter_as(world& w, std::size_t at, mote_id name, const group_description& x,
                  group_id group, bool as_member, const agreement& identity,
                  const key_share& shown) {
  const mote_id member{static_cast<std::uint16_t>(at)};
  intruder who(w);
  randomness secrets{random_stream(55)};
  const auto own = agreement::make(secrets);
  w.record_air(true);
  w.forget_air();
  break_in result;
  who.say(at, name, member, join{group, 77});
  w.run_for(1s);
  const auto asked = who.overheard<join_challenge>(member, name);
  if (asked.empty())
    return result;
  result.was_asked = true;
  join_proof proof{group, 77, asked.back().cookie, 1, as_member, own.share(), shown, {}};
  handshake with{name, member, proof, {}, terms_of(x)};
  const auto credential = credential_of(x, w.network);
  proof.proof = join_tag(credential, with);
  who.say(at, name, member, proof);
  w.run_for(1s);
  const auto accepted = who.overheard<join_accept>(member, name);
  if (accepted.empty())
    return result;
  result.was_admitted = true;
  with.share = accepted.back().share;
  result.has_keys =
      unwrap(accept_key(credential, with, *own.agree(with.share), *identity.agree(with.share)),
             accepted.back().keys, carrier_of(accepted.back()))
          .has_value();
  return result;
}

std::vector<std::size_t> all_of(const world& w) {
  std::vector<std::size_t> all;
  for (std::size_t i = 1; i <= w.size(); ++i)
    all.push_back(i);
  return all;
}

} // namespace

// ---- into another group

TEST_CASE("who has a master key enters no group without it", "[smepp][SMP-05][SMP-09]") {
  for (const bool is_closed : {false, true}) {
    world w({.peers = 3}); // 1 is an impostor that has the network's keys, 3 is true
    auto false_one = kitchen();
    false_one.is_closed = is_closed;
    false_one.master = is_closed ? std::optional(key_of(66)) : std::nullopt;
    const auto rogue = create(w, 1, false_one);
    const auto genuine = create(w, 3, kitchen());
    CHECK(w.join(2, rogue, key_of(9), {.name = "kitchen"}) == failure::wrong_master_key);
    CHECK(w.join(2, rogue, std::nullopt, {.name = "kitchen", .master = key_of(9)}) ==
          failure::wrong_master_key);
    w.run_for(30s);
    w.at(2).provision("kitchen", key_of(9));
    CHECK(w.join(2, rogue, std::nullopt, {.name = "kitchen"}) == failure::wrong_master_key);
    CHECK_FALSE(is_in(w, 2, rogue));
    CHECK(w.at(1).smepp_getPeers(rogue).size() == 1);
    // Who looks with the key sees who has it first.
    CHECK(w.find_groups(2, {.name = "kitchen", .master = key_of(9)}).front() == genuine);
    CHECK(w.join(2, genuine, key_of(9), {.name = "kitchen", .master = key_of(9)}) == std::nullopt);
  }
}

TEST_CASE("what others say of a group does not hold up who joins it", "[smepp][SMP-08][SMP-09]") {
  for (const bool with_key : {false, true})
    for (const std::uint16_t name :
         std::initializer_list<std::uint16_t>{1, 9}) { // the member's own, or another
      world w({.peers = 2});
      w.record_air(true);
      const auto group = create(w, 1, kitchen(2s));
      w.run_for(10s);
      intruder who(w);
      group_filter filter{.name = "kitchen"};
      if (with_key)
        filter.master = key_of(9);
      w.with(2, [&](peer& each, instant t, outputs& out) { each.smepp_getGroups(filter, t, out); });
      for (int i = 0; i < 30; ++i) {
        w.run_for(100ms);
        const auto questions = who.overheard<discover>(mote_id{2}, broadcast_mote);
        REQUIRE_FALSE(questions.empty());
        for (const std::uint16_t period : std::initializer_list<std::uint16_t>{65000, 50000})
          who.say(2, mote_id{name}, mote_id{2},
                  answer{questions.back().nonce,
                         group,
                         true,
                         false,
                         1,
                         period,
                         100,
                         {},
                         std::nullopt,
                         to_bytes(std::string_view("kitchen"))});
      }
      REQUIRE(w.run_until([&] { return !w.signals<getGroups_result>(2).empty(); }, 10s));
      const auto from = w.now();
      w.with(2, [&](peer& each, instant t, outputs& out) {
        each.smepp_joinGroup(group, key_of(9), t, out);
      });
      CHECK(w.run_until([&] { return !w.signals<joinGroup_result>(2).empty(); }, 30s));
      CHECK(w.now() - from < 30s);
      REQUIRE(is_in(w, 2, group));
      CHECK(group_of(w, 2, group).description == kitchen(2s));
    }
}

TEST_CASE("a forged refusal ends no join", "[smepp][SMP-09]") {
  for (const auto why : {failure::wrong_master_key, failure::group_full, failure::not_admitted}) {
    world w({.peers = 2});
    w.record_air(true);
    const auto group = create(w, 1, kitchen());
    static_cast<void>(w.find_groups(2, {}));
    intruder who(w);
    w.with(2, [&](peer& each, instant t, outputs& out) {
      each.smepp_joinGroup(group, key_of(9), t, out);
    });
    for (int i = 0; i < 20 && !is_in(w, 2, group); ++i) {
      w.run_for(1ms);
      const auto asked = who.overheard<join>(mote_id{2}, mote_id{1});
      if (!asked.empty())
        who.say(2, mote_id{1}, mote_id{2}, join_refuse{group, asked.back().nonce, why, {}});
    }
    w.run_for(70s);
    REQUIRE(is_in(w, 2, group));
  }
}

// ---- in another's name

TEST_CASE("who has left does not read on in a member's name", "[smepp][SMP-12][SMP-13]") {
  for (const bool is_open : {false, true})
    for (const bool as_member : {true, false}) {
      world w({.peers = 4});
      auto x = kitchen();
      if (is_open)
        x = {.name = "kitchen"};
      const auto group = w.build_group(x);
      REQUIRE(w.agree(group, all_of(w)));
      w.run_for(2min);
      const auto before = group_of(w, 2, group).ring.best().id;
      w.forget_signals();
      randomness secrets{random_stream(56)};
      const auto identity = agreement::make(secrets);
      const auto result =
          enter_as(w, 2, mote_id{3}, x, group, as_member, identity, identity.share());
      CHECK(result.was_admitted); // it has the credential,
      for (const std::size_t i : {1, 2}) {
        w.run_for(5s);
        INFO(i);
        CHECK(w.signals<peerJoined>(i).size() >= 1); // and those behind whom it is not see it
      }
      w.run_for(2min);
      CHECK(is_better(group_of(w, 2, group).ring.best().id, before));
      CHECK(w.agree(group, all_of(w)));
      // Member 3 has said that it is itself, and the keys that the other one got are old.
      CHECK(group_of(w, 1, group).ring.best().id.generation >= before.generation + 2);
    }
}

TEST_CASE("a member's identity shown by another opens nothing", "[smepp][SMP-12][SMP-13]") {
  world w({.peers = 3});
  w.record_air(true);
  const auto group = w.build_group(kitchen());
  intruder who(w);
  const auto shown = who.overheard<join_proof>(mote_id{3}, mote_id{2});
  REQUIRE_FALSE(shown.empty());
  w.run_for(2min);
  const auto before = group_of(w, 2, group).ring.best().id;
  randomness secrets{random_stream(57)};
  const auto other = agreement::make(secrets);
  const auto result =
      enter_as(w, 2, mote_id{3}, kitchen(), group, true, other, shown.back().identity);
  CHECK(result.was_admitted);
  CHECK_FALSE(result.has_keys);
  CHECK(group_of(w, 2, group).ring.best().id == before);
}

TEST_CASE("a member that catches up is no reason for new keys", "[smepp][SMP-13][SMP-22]") {
  world w({.peers = 3});
  const auto group = w.build_group(kitchen());
  w.run_for(2min);
  w.power_off(3);
  w.run_for(10s);
  w.forget_signals();
  const auto before = group_of(w, 1, group).ring.best().id;
  w.power_on(3);
  w.run_for(2min);
  CHECK(w.agree(group, all_of(w)));
  CHECK(group_of(w, 1, group).ring.best().id == before);
  CHECK(w.signals<peerJoined>(1).empty());
}

// ---- windows

TEST_CASE("one frame silences nobody", "[smepp][SMP-03][SMP-13]") {
  for (const bool answers : {false, true}) { // does it answer in the member's name, too?
    world w({.peers = 3});
    const auto group = w.build_group(kitchen());
    w.subscribe(1, group, "light");
    w.run_for(10s);
    const auto keys = group_of(w, 2, group).ring.accepted();
    const auto session = keys.front().id;
    const auto forged = unsubscribe{{mote_id{50}, 1}, {}};
    intruder far(w, 0xffff'ff00);
    w.record_air(true);
    far.say(2, mote_id{3}, broadcast_mote, forged, group, session, keys);
    if (answers) {
      w.run_for(3ms);
      for (int i = 0; i < 20; ++i) {
        w.run_for(1ms);
        for (const auto& x : w.air()) {
          security own({.self = mote_id{3}}, 0);
          own.set_network_keys(w.network, w.now());
          own.set_group(group, keys);
          const auto opened = own.open(x.from, x.to, x.octets, w.now());
          const auto* const frame = std::get_if<opened_frame>(&opened);
          if (frame == nullptr || x.what != "challenge" || x.to != mote_id{3})
            continue;
          const auto said = decode(frame->content);
          far.say(2, mote_id{3}, mote_id{2}, proof{std::get<challenge>(*said).nonce}, group,
                  session, keys);
        }
      }
    }
    w.run_for(5s);
    if (answers) // members may lie; what they can do ends with the keys that they have
      w.with(1, [&](peer& each, instant t, outputs& out) {
        return each.refresh_session_keys(group, t, out);
      });
    w.run_for(2min);
    w.forget_signals();
    for (int i = 0; i < 10; ++i) {
      w.raise(3, group, "light");
      w.run_for(2s);
    }
    CHECK(w.signals<receive_result>(1).size() >= (answers ? 9 : 10));
  }
}

// ---- without any key

TEST_CASE("frames that were overheard and changed keep no radio on", "[smepp][SMP-03][SMP-23]") {
  for (const duration period : {1s, 2s, 10s, 60s}) {
    double shares[2] = {};
    for (const bool attacked : {false, true}) {
      world w({.peers = 3});
      const auto group = w.build_group(kitchen(period));
      w.run_for(10min + 5 * period);
      w.power_off(3); // a neighbour that has gone, whose name is used
      auto forged = bytes(secured_overhead + 20, 7);
      security own({.self = mote_id{3}}, 900);
      own.set_network_keys(w.network, instant{});
      own.set_group(group, group_of(w, 2, group).ring.accepted());
      const auto real =
          *own.seal(broadcast_mote, group, group_of(w, 2, group).ring.best().id, bytes(20, 0));
      forged = real;
      forged[1] = static_cast<std::uint8_t>((real[1] & 0xf0) | ((real[1] + 1) & 0x0f));
      const auto on_before = w.radio_time(2);
      const auto from = w.now();
      while (w.now() - from < 2h) {
        if (attacked && w.at(2).is_radio_on())
          w.inject(2, mote_id{3}, broadcast_mote, forged);
        w.run_for(period / 20);
      }
      shares[attacked ? 1 : 0] = seconds(w.radio_time(2) - on_before) / seconds(w.now() - from);
    }
    CAPTURE(seconds(period), shares[0], shares[1]);
    CHECK(shares[1] < shares[0] + 0.005);
  }
}

TEST_CASE("false rumours do not keep a member from true ones", "[smepp][SMP-03][SMP-13]") {
  for (const duration period : {1s, 2s, 10s}) {
    world w({.peers = 3});
    const auto group = w.build_group(kitchen(period));
    REQUIRE(w.agree(group, all_of(w)));
    w.run_for(10min);
    w.cut([](std::size_t a, std::size_t b) { return a == 3 || b == 3; });
    for (int i = 0; i < 3; ++i) {
      w.with(1, [&](peer& each, instant t, outputs& out) {
        return each.refresh_session_keys(group, t, out);
      });
      w.run_for(3min + 10 * period);
    }
    security own({.self = mote_id{9}}, 900);
    own.set_network_keys(w.network, instant{});
    own.set_group(group, group_of(w, 3, group).ring.accepted());
    auto forged =
        *own.seal(broadcast_mote, group, group_of(w, 3, group).ring.best().id, bytes(20, 0));
    forged[1] = static_cast<std::uint8_t>((forged[1] & 0xf0) | ((forged[1] + 1) & 0x0f));
    std::uint16_t name = 9;
    const auto flood = [&](duration length) {
      const auto from = w.now();
      while (w.now() - from < length) {
        if (w.at(3).is_radio_on())
          for (int i = 0; i < 3; ++i)
            w.inject(3, mote_id{static_cast<std::uint16_t>(9 + ++name % 90)}, broadcast_mote,
                     forged);
        w.run_for(50ms);
        if (w.agree(group, all_of(w)))
          return;
      }
    };
    flood(1min);
    w.cut({});
    const auto from = w.now();
    flood(30min);
    CAPTURE(seconds(period), seconds(w.now() - from));
    CHECK(w.agree(group, all_of(w)));
    CHECK(w.now() - from < 5min + 20 * period);
  }
}

TEST_CASE("recorded joins keep nobody out", "[smepp][SMP-03][SMP-09]") {
  int joined = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    world w({.peers = 3, .seed = seed});
    w.record_air(true);
    const auto group = create(w, 2, kitchen());
    REQUIRE_FALSE(w.join(1, group, key_of(9), {}));
    w.join(3, group, key_of(8), {}); // in vain, but it was recorded
    std::vector<heard_frame> recorded;
    for (const auto& x : w.air())
      if (x.what == "join" || x.what == "join_proof")
        recorded.push_back(x);
    REQUIRE(recorded.size() >= 4);
    w.run_for(2min);
    const auto replay = [&](duration length) {
      const auto from = w.now();
      while (w.now() - from < length && !is_in(w, 3, group)) {
        for (const auto& x : recorded)
          w.inject(2, x.from, x.to, x.octets);
        w.run_for(250ms);
      }
    };
    replay(1min);
    const auto before = w.at(2).groups().counters().agreements;
    w.with(3, [&](peer& each, instant t, outputs& out) { each.smepp_getGroups({}, t, out); });
    replay(4s);
    w.with(3, [&](peer& each, instant t, outputs& out) {
      each.smepp_joinGroup(group, key_of(9), t, out);
    });
    replay(20s);
    joined += is_in(w, 3, group) ? 1 : 0;
    CHECK(w.at(2).groups().counters().agreements - before <= 3); // of the one that was let in
  }
  CHECK(joined == 10);
}

TEST_CASE("recorded joins keep no member from new keys", "[smepp][SMP-03][SMP-12]") {
  world w({.peers = 4});
  w.record_air(true);
  const auto group = w.build_group(kitchen(2s));
  REQUIRE(w.agree(group, all_of(w)));
  std::vector<heard_frame> recorded;
  for (const auto& x : w.air())
    if (x.what == "join" || x.what == "join_proof")
      recorded.push_back(x);
  w.run_for(3min);
  w.leave(4, group);
  const auto from = w.now();
  while (w.now() - from < 5min) {
    for (const auto& x : recorded)
      w.inject(x.to.value, x.from, x.to, x.octets);
    w.run_for(250ms);
  }
  CHECK(w.agree(group, {1, 2, 3}));
  CHECK(group_of(w, 1, group).members.present() == 3);
}

TEST_CASE("a recorded question is hardly ever answered", "[smepp][SMP-03][SMP-06]") {
  world w({.peers = 2});
  w.record_air(true);
  create(w, 1, kitchen());
  static_cast<void>(w.find_groups(2, {}));
  const auto question = *std::ranges::find(w.air(), "discover", &heard_frame::what);
  w.run_for(2min);
  const auto before = sent(w, 1, "answer");
  for (int i = 0; i < 600; ++i) {
    w.inject(1, question.from, question.to, question.octets);
    w.run_for(1s);
  }
  CHECK(sent(w, 1, "answer") - before <= 10);
}

TEST_CASE("who has no counter left refuses, and goes on", "[smepp][SMP-03][SMP-22]") {
  world w({.peers = 2});
  kept used_up;
  used_up.counter_reserved = used_up.counter_end = 5000;
  peer x({.self = mote_id{1}}, random_stream(1), w.now(), used_up);
  outputs out;
  x.smepp_newPeer(w.network.confidentiality, w.network.integrity, w.now(), out);
  const auto group = std::get<group_id>(x.smepp_createGroup(kitchen(), w.now(), out));
  security other({.self = mote_id{2}}, 0);
  other.set_network_keys(w.network, w.now());
  for (const message& each : {message(discover{1, {}, {}, {}, ""}), message(join{group, 7})}) {
    const auto frame = *other.seal(mote_id{1}, network_level, {}, encode(each));
    x.on_frame(mote_id{2}, mote_id{1}, frame, w.now(), w.now(), out);
    x.on_time(w.now() + 1s, out);
  }
  x.smepp_getGroups({}, w.now() + 2s, out);
  x.on_time(w.now() + 3s, out);
  std::size_t results = 0;
  for (const auto& each : out) {
    CHECK_FALSE(std::holds_alternative<send_frame>(each));
    const auto* const told = std::get_if<signal>(&each);
    results += told != nullptr && std::holds_alternative<getGroups_result>(*told) ? 1U : 0U;
  }
  CHECK(results == 1);
  CHECK(x.keys().counters().used_up > 0);
}

// ---- who said it

TEST_CASE("a proven event is taken once, and no false one in its place",
          "[smepp][SMP-03][SMP-13]") {
  world w({.peers = 3}, [](peer_config& x) { x.events.authenticates_sender = true; });
  const key root = key_of(77);
  for (const auto& [a, b] : {std::pair(1, 2), std::pair(1, 3), std::pair(2, 3)}) {
    const mote_id first{static_cast<std::uint16_t>(a)};
    const mote_id second{static_cast<std::uint16_t>(b)};
    w.at(first.value).set_pairwise_key(second, pairwise_key(root, first, second));
    w.at(second.value).set_pairwise_key(first, pairwise_key(root, first, second));
  }
  const auto group = w.build_group(kitchen());
  w.subscribe(1, group, "alarm");
  w.run_for(10s);
  w.record_air(true);
  w.raise(3, group, "alarm", {1});
  w.run_for(1s);
  REQUIRE(w.signals<receive_result>(1).size() == 1);
  const auto keys = group_of(w, 2, group).ring.accepted();
  smepp::event seen{};
  for (const auto& x : w.air()) {
    security own({.self = x.to}, 0);
    own.set_network_keys(w.network, w.now());
    own.set_group(group, keys);
    const auto opened = own.open(x.from, x.to, x.octets, w.now());
    if (const auto* const frame = std::get_if<opened_frame>(&opened); frame && x.what == "event")
      seen = std::get<smepp::event>(*decode(frame->content));
  }
  REQUIRE(seen.proof);
  for (std::uint8_t i = 0; i < 40; ++i) {
    w.raise(3, group, "alarm", {i});
    w.run_for(1s);
  }
  REQUIRE(w.signals<receive_result>(1).size() == 41);
  intruder relay(w, 30'000); // member 2 itself
  relay.say(1, mote_id{2}, mote_id{1}, seen, group, keys.front().id, keys);
  CHECK(w.signals<receive_result>(1).size() == 41);

  SECTION("a false one with the next number, at the subscriber and on the way") {
    auto lie = seen;
    for (std::uint16_t i = 0; i < 3; ++i) {
      lie.sequence = static_cast<std::uint16_t>(seen.sequence + 41 + i);
      lie.value = {99};
      for (const std::size_t at : {1, 2})
        relay.say(at, mote_id{static_cast<std::uint16_t>(3 - at)},
                  mote_id{static_cast<std::uint16_t>(at)}, lie, group, keys.front().id, keys);
      w.run_for(1s);
    }
    w.with(1, [&](peer& each, instant t, outputs& out) { // ends what it did to windows
      return each.refresh_session_keys(group, t, out);
    });
    w.run_for(30s);
    w.raise(3, group, "alarm", {1});
    w.run_for(2s);
    CHECK(w.signals<receive_result>(1).size() == 42);
  }
  SECTION("in the subscriber's own name") {
    auto lie = seen;
    lie.producer = mote_id{1};
    relay.say(1, mote_id{2}, mote_id{1}, lie, group, keys.front().id, keys);
    CHECK(w.signals<receive_result>(1).size() == 41);
  }
  SECTION("for a subscription of a former life") {
    w.with(1, [&](peer& each, instant t, outputs& out) {
      return each.smepp_unsubscribe("alarm", group, t, out);
    });
    w.run_for(10s);
    w.subscribe(1, group, "alarm");
    w.run_for(10s);
    auto again = seen;
    again.id = w.at(1).events().all().at(0).id;
    relay.say(1, mote_id{2}, mote_id{1}, again, group, keys.front().id, keys);
    CHECK(w.signals<receive_result>(1).size() == 41);
  }
}
