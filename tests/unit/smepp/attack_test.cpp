// What an attacker can do, and what not: without keys, with old ones, and from inside.
#include <algorithm>
#include <set>

#include "core/codec.hpp"
#include "support/catch.hpp"
#include "unit/smepp/world.hpp"

using namespace rubicon;
using namespace rubicon::smepp;
using namespace rubicon::smepp::test;

namespace {

group_description closed_kitchen() {
  return {.name = "kitchen", .master = key_of(9), .is_closed = true};
}

std::uint64_t refused(world& w, std::size_t i, const std::string& why) {
  const auto& all = w.at(i).keys().counters().refused;
  return all.contains(why) ? all.at(why) : 0;
}

std::uint64_t opened(world& w, std::size_t i) {
  return w.at(i).keys().counters().opened;
}

bool contains(const bytes& where, byte_view what) {
  return !std::ranges::search(where, what).empty();
}

/// A mote's keys, as somebody who has taken it apart knows them.
security stolen(world& w, std::size_t from, group_id group, mote_id as, std::uint64_t counter) {
  security x({.self = as}, counter);
  x.set_network_keys(w.network, instant{});
  x.set_group(group, w.at(from).groups().find(group)->ring.accepted());
  return x;
}

std::uint64_t counter_of(const bytes& frame) {
  byte_reader reader(frame);
  reader.skip(4);
  return reader.big<std::uint64_t>();
}

} // namespace

TEST_CASE("who has no keys receives only ciphertext", "[smepp][SMP-03][SMP-13]") {
  world w({.peers = 3});
  w.record_air(true);
  const auto group = w.build_group(closed_kitchen());
  w.subscribe(1, group, "temperature in the kitchen");
  w.run_for(5s);
  const auto secret = to_bytes(std::string_view("21.5 degrees, somebody is at home"));
  w.raise(3, group, "temperature in the kitchen", secret);
  w.run_for(5s);
  REQUIRE(w.signals<receive_result>(1).size() == 1);
  REQUIRE(w.air().size() > 50);

  std::vector<bytes> secrets{secret, to_bytes(std::string_view("kitchen")),
                             to_bytes(w.network.confidentiality.reveal()),
                             to_bytes(w.network.integrity.reveal()), to_bytes(key_of(9).reveal())};
  for (std::size_t i = 1; i <= 3; ++i)
    for (const auto& x : w.at(i).groups().find(group)->ring.accepted()) {
      secrets.push_back(to_bytes(x.keys.confidentiality.reveal()));
      secrets.push_back(to_bytes(x.keys.integrity.reveal()));
    }
  std::set<std::pair<mote_id, std::uint64_t>> nonces;
  security outsider({.self = mote_id{9}}, 0);
  outsider.set_network_keys({key_of(66), key_of(67)}, instant{});
  for (const auto& x : w.air()) {
    for (const auto& each : secrets)
      CHECK_FALSE(contains(x.octets, each));
    nonces.emplace(x.from, counter_of(x.octets));
    CHECK(std::holds_alternative<refused_frame>(outsider.open(x.from, x.to, x.octets, w.now())));
  }
  std::set<bytes> frames; // the radio repeats what is not acknowledged
  for (const auto& x : w.air())
    frames.insert(x.octets);
  CHECK(nonces.size() == frames.size());
}

TEST_CASE("frames out of nothing are dropped, counted and cheap", "[smepp][SMP-03]") {
  world w({.peers = 2});
  const auto group = w.build_group(closed_kitchen());
  w.run_for(1min);
  const auto before = opened(w, 1);
  const auto sent_before = w.at(1).counters().frames_sent;
  const auto macs_before = w.at(1).keys().counters().macs;
  random_stream rng(1);
  constexpr int floods = 20'000;
  for (int i = 0; i < floods; ++i) {
    bytes frame(rng.below(network::frame_payload_max + 20));
    for (auto& each : frame)
      each = static_cast<std::uint8_t>(rng.next());
    if (frame.size() > 8 && rng.chance(0.7)) { // a good header
      byte_writer header;
      header.octet(1).octet(static_cast<std::uint8_t>(rng.next())).big(group.value);
      std::ranges::copy(header.view(), frame.begin());
    }
    w.inject(1, mote_id{static_cast<std::uint16_t>(rng.below(5))},
             rng.chance(0.5) ? broadcast_mote : mote_id{1}, frame);
  }
  CHECK(opened(w, 1) == before);
  CHECK(w.at(1).keys().counters().macs - macs_before <= security::macs_max * floods);
  for (const auto* const why : {"malformed", "unknown_suite", "unknown_group", "wrong_key"})
    CHECK(refused(w, 1, why) > 10);
  w.run_for(1min);
  CHECK(w.at(1).counters().frames_sent - sent_before < 20); // it answers nothing of that
  CHECK(w.agree(group, {1, 2}));
}

TEST_CASE("a recording is worth nothing, at once and after a reboot", "[smepp][SMP-03]") {
  world w({.peers = 3});
  w.record_air(true);
  const auto group = w.build_group(closed_kitchen());
  w.subscribe(1, group, "light");
  w.run_for(5s);
  for (std::uint8_t i = 0; i < 20; ++i) {
    w.raise(3, group, "light", {i});
    w.run_for(1s);
  }
  const auto recorded = w.air();
  REQUIRE(w.signals<receive_result>(1).size() == 20);
  w.forget_signals();
  const auto replay = [&] {
    for (std::size_t i = 1; i <= 3; ++i)
      for (const auto& x : recorded)
        if (x.from.value != i && (x.to == broadcast_mote || x.to.value == i) &&
            x.what != "discover")
          w.inject(i, x.from, x.to, x.octets);
    w.run_for(10s);
  };
  replay();
  const auto quiet = [&] {
    for (std::size_t i = 1; i <= 3; ++i) {
      CHECK(w.signals<receive_result>(i).empty());
      CHECK(w.signals<peerJoined>(i).empty());
      CHECK(w.signals<subscribed>(i).empty());
      CHECK(w.at(i).smepp_getPeers(group).size() == 3);
    }
  };
  quiet();
  CHECK(refused(w, 1, "replayed") > 20);
  const auto generation = w.at(1).groups().find(group)->ring.best().id;

  w.power_off(1);
  w.power_on(1);
  for (const auto& x : recorded) // before anybody has spoken to it
    if (x.from.value == 2 && (x.to == broadcast_mote || x.to.value == 1))
      w.inject(1, x.from, x.to, x.octets);
  CHECK(w.signals<receive_result>(1).empty());
  CHECK(w.signals<subscribed>(1).empty());
  CHECK(refused(w, 1, "unproven") > 0);
  w.run_for(1min);
  CHECK(w.agree(group, {1, 2, 3}));
  w.forget_signals();
  replay();
  quiet();
  CHECK(w.at(1).groups().find(group)->ring.best().id == generation);
}

TEST_CASE("a frame that is changed in transit is not taken", "[smepp][SMP-03]") {
  world w({.peers = 2});
  w.record_air(true);
  const auto group = w.build_group(closed_kitchen());
  w.subscribe(1, group, "light");
  w.run_for(5s);
  w.cut([](std::size_t, std::size_t) { return true; });
  w.raise(2, group, "light", {7});
  w.run_for(100ms);
  const auto frame = w.air().back();
  REQUIRE(frame.what == "event");
  random_stream rng(2);
  for (int i = 0; i < 1000; ++i) {
    auto changed = frame.octets;
    changed[rng.below(changed.size())] ^= static_cast<std::uint8_t>(1 + rng.below(255));
    w.inject(1, frame.from, frame.to, changed);
  }
  w.inject(1, frame.from, broadcast_mote, frame.octets);
  w.inject(1, mote_id{3}, frame.to, frame.octets);
  CHECK(w.signals<receive_result>(1).empty());
  CHECK(refused(w, 1, "tampered") > 500);
  w.inject(1, frame.from, frame.to, frame.octets);
  CHECK(w.signals<receive_result>(1).size() == 1);
}

TEST_CASE("old session keys are worth nothing after the grace period", "[smepp][SMP-12][SMP-13]") {
  world w({.peers = 3});
  w.record_air(true);
  const auto group = w.build_group(closed_kitchen());
  w.run_for(2min);
  auto gone = stolen(w, 3, group, mote_id{3}, 1'000'000);
  const auto old = w.at(3).groups().find(group)->ring.best().id;
  const auto reads = [&](const heard_frame& x) {
    const auto content = gone.open(x.from, x.to, x.octets, w.now());
    return std::holds_alternative<opened_frame>(content) &&
           std::get<opened_frame>(content).group == group;
  };
  w.leave(3, group);
  w.run_for(10s); // the change, and its activation
  w.forget_air();
  w.subscribe(1, group, "secret plans");
  w.run_for(10s);
  w.raise(2, group, "secret plans", {1});
  w.run_for(2min);
  REQUIRE(w.signals<receive_result>(1).size() == 1);
  REQUIRE(w.air().size() > 10);
  for (const auto& x : w.air()) { // who has left cannot read the future,
    CHECK_FALSE(reads(x));
    CHECK(x.what != "key_refresh"); // also if it still has the master key
  }
  const auto frame =
      gone.seal(broadcast_mote, group, old, encode(member_left{{{mote_id{1}, 0}, 99, true}}));
  REQUIRE(frame);
  const auto before = refused(w, 2, "wrong_key");
  w.inject(2, mote_id{3}, broadcast_mote, *frame);
  CHECK(refused(w, 2, "wrong_key") == before + 1);
  CHECK(w.at(2).smepp_getPeers(group).size() == 2);
}

TEST_CASE("who has left learns no keys from who joins right after", "[smepp][SMP-12][SMP-13]") {
  world w({.peers = 4});
  auto x = closed_kitchen();
  x.management = {1s, 100ms};
  const auto group = std::get<group_id>(w.with(
      1, [&](peer& each, instant t, outputs& out) { return each.smepp_createGroup(x, t, out); }));
  for (const std::size_t i : {2, 3})
    REQUIRE_FALSE(w.join(i, group, key_of(9), {}));
  w.run_for(5min);
  auto gone = stolen(w, 3, group, mote_id{3}, 0);
  w.record_air(true);
  w.leave(3, group);
  const auto& ring = w.at(2).groups().find(group)->ring;
  const auto before = ring.best().id;
  CHECK(w.run_until([&] { return ring.best().id != before; }, 30s, 100ms));
  CHECK(ring.sending(w.local(2)) == before);
  w.cut([](std::size_t a, std::size_t b) { return a == 3 || b == 3; });
  // The new keys are not in use yet, and newer ones are made.
  w.with(2, [&](peer& each, instant t, outputs& out) {
    return each.refresh_session_keys(group, t, out);
  });
  w.run_for(3min);
  CHECK(w.agree(group, {1, 2}));
  std::size_t refreshes = 0;
  for (const auto& each : w.air()) {
    refreshes += each.what == "key_refresh" ? 1U : 0U;
    if (each.what == "key_refresh") // it cannot even see them
      CHECK(std::holds_alternative<refused_frame>(
          gone.open(each.from, each.to, each.octets, w.now())));
  }
  CHECK(refreshes > 0);
}

TEST_CASE("who joins cannot read the past", "[smepp][SMP-13]") {
  world w({.peers = 3});
  w.record_air(true);
  auto x = closed_kitchen();
  const auto group = std::get<group_id>(w.with(
      1, [&](peer& each, instant t, outputs& out) { return each.smepp_createGroup(x, t, out); }));
  REQUIRE_FALSE(w.join(2, group, key_of(9), {}));
  w.run_for(5min);
  w.subscribe(1, group, "light");
  w.run_for(5s);
  w.raise(2, group, "light");
  w.run_for(2min);
  const auto past = w.air();
  REQUIRE_FALSE(w.join(3, group, key_of(9), {}));
  auto joiner = stolen(w, 3, group, mote_id{3}, 0);
  std::size_t of_group = 0;
  for (const auto& each : past) {
    if ((each.octets[2] << 8 | each.octets[3]) != group.value)
      continue;
    ++of_group;
    CHECK(std::holds_alternative<refused_frame>(
        joiner.open(each.from, each.to, each.octets, w.now())));
  }
  CHECK(of_group > 10);
}

TEST_CASE("a rumour of new keys costs a handshake now and then", "[smepp][SMP-03]") {
  world w({.peers = 2});
  auto x = closed_kitchen();
  x.management = {2s, 100ms};
  const auto group = w.build_group(x);
  w.run_for(5min);
  const auto sent = [&] {
    const auto& all = w.at(1).counters().sent;
    return all.contains("join") ? all.at("join") : 0;
  };
  const auto before = sent();
  const auto on_before = w.radio_time(1);
  auto forged = bytes(secured_overhead + 20, 7);
  const auto& session = w.at(1).groups().find(group)->ring.best().id;
  auto own = stolen(w, 1, group, mote_id{3}, 0);
  const auto real = *own.seal(broadcast_mote, group, session, bytes(20, 0));
  std::ranges::copy(byte_view(real).first(secured_header_size), forged.begin());
  forged[1] = static_cast<std::uint8_t>((real[1] & 0xf0) | ((real[1] + 1) & 0x0f));
  for (int i = 0; i < 3600; ++i) { // in the name of a neighbour, and of others
    const mote_id name{static_cast<std::uint16_t>(i % 2 == 0 ? 2 : 3 + i % 100)};
    w.inject(1, name, broadcast_mote, forged);
    w.run_for(1s);
  }
  CHECK(sent() - before > 0);
  CHECK(sent() - before <= 3 * 20); // an hour of it
  CHECK(seconds(w.radio_time(1) - on_before) / 3600 < 0.15);
  CHECK(w.agree(group, {1, 2}));
}

TEST_CASE("a forged join costs more than it is answered with", "[smepp][SMP-03][SMP-09]") {
  world w({.peers = 2});
  const auto group = w.build_group(closed_kitchen());
  w.run_for(1min);
  // Somebody of the network who has not the group's key asks under many names.
  security insider({.self = mote_id{50}}, 0);
  insider.set_network_keys(w.network, instant{});
  const auto before = w.at(1).counters().frames_sent;
  for (std::uint16_t i = 0; i < 2000; ++i) {
    const mote_id name{static_cast<std::uint16_t>(100 + i % 50)};
    security forger({.self = name}, 10'000U * i);
    forger.set_network_keys(w.network, instant{});
    w.inject(1, name, mote_id{1},
             *forger.seal(mote_id{1}, network_level, {}, encode(join{group, i})));
    w.run_for(10ms);
  }
  w.run_for(10s);
  CHECK(w.at(1).counters().frames_sent - before < 260); // ten names, 30 s
  CHECK(w.at(1).groups().counters().dropped.at("too_many_joins") > 1700);
  CHECK(w.at(1).smepp_getPeers(group).size() == 2);
  CHECK(w.agree(group, {1, 2}));
}

TEST_CASE("a group's keys prove membership, a pairwise key the sender", "[smepp][SMP-03][SMP-13]") {
  for (const bool authenticate : {false, true}) {
    const key root = key_of(77); // known to who deploys the motes alone
    world w({.peers = 3}, [&](peer_config& x) {
      if (authenticate)
        prove_senders(x, 3, root);
    });
    const auto group = w.build_group(closed_kitchen());
    w.subscribe(1, group, "door is open");
    w.run_for(5s);
    w.raise(3, group, "door is open", {0});
    w.run_for(1s);
    auto got = w.signals<receive_result>(1);
    REQUIRE(got.size() == 1);
    CHECK(got[0].is_sender_proven == authenticate);

    // Member 2, a relay, says that 3 has said something. It has the group's keys, the master key,
    // and a pairwise key of its own.
    auto traitor = stolen(w, 2, group, mote_id{2}, 20'000);
    const auto subscribed = w.at(1).events().all().at(0);
    smepp::event lie{subscribed.id, mote_id{3}, 4711, 1, std::nullopt, {1}};
    pairwise_keys own(1);
    own.set(mote_id{1}, pairwise_key(root, mote_id{1}, mote_id{2}));
    if (authenticate)
      lie.proof = own.prove(lie, group, subscribed.made_at, 1);
    w.inject(1, mote_id{2}, mote_id{1},
             *traitor.seal(mote_id{1}, group, w.at(2).groups().find(group)->ring.best().id,
                           encode(lie)));
    got = w.signals<receive_result>(1);
    if (authenticate) {
      CHECK(got.size() == 1);
      CHECK(w.at(1).events().counters().dropped.at("sender_unproven") == 1);
    } else {
      REQUIRE(got.size() == 2); // believed: this is what a group's key is worth
      CHECK(got[1].sender == mote_id{3});
      CHECK_FALSE(got[1].is_sender_proven);
    }
  }
}

TEST_CASE("a pairwise key is what its root is worth", "[smepp][SMP-13]") {
  const auto shared = key_of(9); // a master key: every member can compute all pairs
  CHECK(pairwise_key(shared, mote_id{1}, mote_id{3}) ==
        pairwise_key(shared, mote_id{3}, mote_id{1}));
  CHECK_FALSE(pairwise_key(shared, mote_id{1}, mote_id{3}) ==
              pairwise_key(shared, mote_id{1}, mote_id{2}));
  pairwise_keys table(2);
  CHECK(table.set(mote_id{1}, shared));
  CHECK(table.set(mote_id{2}, shared));
  CHECK_FALSE(table.set(mote_id{3}, shared)); // no room
  CHECK(table.set(mote_id{2}, key_of(1)));
  smepp::event x{{mote_id{1}, 1}, mote_id{2}, 3, 0, std::nullopt, {1, 2}};
  CHECK_FALSE(table.is_proven(x, group_id{1}, {}));
  pairwise_keys producer(1);
  producer.set(mote_id{1}, key_of(1));
  x.proof = producer.prove(x, group_id{1}, {}, 7);
  x.hops = 5; // relays may
  CHECK(table.is_proven(x, group_id{1}, {}));
  CHECK_FALSE(table.is_proven(x, group_id{2}, {}));
  CHECK_FALSE(table.is_proven(x, group_id{1}, group_time{1us})); // of a subscription before
  CHECK(table.take(x));
  CHECK_FALSE(table.take(x));
  x.value = {1, 3}; // and this they may not
  CHECK_FALSE(table.is_proven(x, group_id{1}, {}));
}

TEST_CASE("frames of any content do not upset a peer", "[smepp][SMP-03]") {
  // With good keys, so that all handlers are reached: an insider that fuzzes.
  world w({.peers = 2});
  const auto group = w.build_group(closed_kitchen());
  w.subscribe(1, group, "light", 1);
  w.run_for(1min);
  random_stream rng(4);
  auto insider = stolen(w, 2, group, mote_id{2}, 20'000);
  const auto session = w.at(2).groups().find(group)->ring.best().id;
  w.record_air(true);
  for (int i = 0; i < 20'000; ++i) {
    bytes content(1 + rng.below(message_max));
    for (auto& each : content)
      each = static_cast<std::uint8_t>(rng.chance(0.3) ? rng.below(4) : rng.next());
    const bool is_network = rng.chance(0.5);
    content[0] = static_cast<std::uint8_t>((is_network ? 0 : 0x10) + rng.below(12));
    if (is_network && content.size() > 2 && rng.chance(0.8)) {
      content[1] = static_cast<std::uint8_t>(group.value >> 8);
      content[2] = static_cast<std::uint8_t>(group.value);
    }
    const auto to = rng.chance(0.5) ? broadcast_mote : mote_id{1};
    const auto frame = insider.seal(to, is_network ? network_level : group,
                                    is_network ? session_id{} : session, content);
    REQUIRE(frame);
    w.inject(1, mote_id{2}, to, *frame);
    if (i % 100 == 0)
      w.run_for(rng.between(1ms, 200ms));
  }
  CHECK(w.at(1).counters().dropped.at("malformed") > 1000);
  CHECK(w.at(1).waiting() <= peer_config{}.outbox_max);
  CHECK(w.at(1).events().all().size() <= event_config{}.subscriptions_max);
}
