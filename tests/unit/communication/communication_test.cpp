// The Mockup interface on motes: membership and connectionless messages (D1.1 5.3.3, 5.3.4).
#include <algorithm>
#include <array>

#include "mote/join/descriptor.hpp"
#include "network/am.hpp"
#include "support/catch.hpp"
#include "support/mote_ids.hpp"
#include "support/programs.hpp"
#include "support/segments.hpp"

using namespace rubicon;
using communication::FAIL;
using communication::SUCCESS;
using test::act;
using test::count;
using test::id;
using test::island_fixture;
using test::lone_layer;
using test::recorder;
using test::user_am_type;

namespace {

/// Packets to itself arrive.
void loop_back(lone_layer& x) {
  for (auto sent = x.core.take_outputs(); !sent.empty(); sent = x.core.take_outputs()) {
    for (const auto& each : sent) {
      const auto& packet = std::get<transport::to_network>(each);
      REQUIRE(packet.destination == mote_address{island_id{3}, mote_id{7}});
      x.core.on_packet(island_id{3}, packet.channel, packet.segment, x.now);
    }
  }
}

} // namespace

TEST_CASE("before the join all that needs it fails, and what does not works",
          "[communication][MCK-16]") {
  lone_layer x;
  CHECK(!x.api().address());
  CHECK(x.api().joinIsland(bytes{1}) == FAIL); // not initialised either
  x.core.on_initialised(true, x.now);
  CHECK(x.api().send(3, 8, bytes{1}, false, user_am_type) == FAIL);
  CHECK(x.api().send(3, 8, bytes{1}, true, user_am_type) == FAIL);
  CHECK(x.api().open_remote(3, 8, 1, 0, 0) == FAIL);
  CHECK(x.api().create_syn_channel_out(8, 3, std::array<std::uint8_t, 10>{}) == FAIL);
  CHECK(x.api().create_syn_channel_in(8, 3, std::array<std::uint8_t, 10>{}) == FAIL);
  CHECK(x.core.counters().before_join == 5);
  CHECK(x.core.counters().refused == 6);
  CHECK(x.api().provide(user_am_type) == SUCCESS);
  const auto local = x.api().open_local();
  CHECK(local > 0);
  CHECK(x.api().write(local, bytes{5}) == 1);
  CHECK(x.core.take_outputs().empty());
  join(x);
  CHECK(x.api().address() == mote_address{island_id{3}, mote_id{7}});
  CHECK(x.api().send(3, 8, bytes{1}, false, user_am_type) == SUCCESS);
  CHECK(count<transport::to_network>(x.core.take_outputs()) == 1);
}

TEST_CASE("a join needs radio and line to be up", "[communication][MCK-13][MCK-14]") {
  lone_layer x;
  CHECK(x.api().initCommunications() == SUCCESS);
  CHECK(count<communication::init_wanted>(x.core.take_outputs()) == 1);
  x.core.on_initialised(false, x.now);
  CHECK(x.core.take_outputs().empty());
  CHECK(x.program.inits == std::vector{false});
  CHECK(x.api().joinIsland(bytes{1, 2}) == FAIL);
  x.core.on_initialised(true, x.now);
  CHECK(x.api().joinIsland(bytes{1, 2}) == SUCCESS);
  const auto wanted = x.core.take_outputs();
  REQUIRE(wanted.size() == 1);
  CHECK(std::get<communication::join_wanted>(wanted[0]).description == bytes{1, 2});
  CHECK(x.program.inits == std::vector{false, true});
  CHECK(x.program.joins.empty());
}

TEST_CASE("programs join their mote to the island", "[communication][MCK-13][MCK-14][MCK-15]") {
  recorder program;
  recorder neighbour;
  island_fixture x({.width = 3, .joins_alone = false});
  program.layer = x.at(id(3)).attach(program);
  neighbour.layer = x.at(id(2)).attach(neighbour);
  x.run_for(1min);
  CHECK(x.root().members() == 0);
  CHECK(act(x, id(3), [&] { return program.layer->initCommunications(); }) == SUCCESS);
  CHECK(program.inits == std::vector{true});
  CHECK(program.joins.empty());
  const auto description = encode(mote::descriptor{.type = 301});
  CHECK(act(x, id(3), [&] { return program.layer->joinIsland(description); }) == SUCCESS);
  REQUIRE(x.run_until([&] { return !program.joins.empty(); }, 1min));
  const mote_address self{island_id{1}, id(3)};
  CHECK(program.joins == std::vector{std::pair(self, true)});
  CHECK(program.layer->address() == self);
  CHECK(x.root().members() == 1);
  CHECK(neighbour.joins.empty());
  CHECK(!neighbour.layer->address());
}

TEST_CASE("a message without a possible receiver fails at once",
          "[communication][MCK-09][ADR-03]") {
  lone_layer x;
  join(x);
  const bytes longest(256);
  CHECK(x.api().send(3, 8, longest, false, user_am_type) == SUCCESS);
  CHECK(x.api().send(3, 8, bytes(257), false, user_am_type) == FAIL);
  CHECK(x.api().send(3, 8, bytes(257), true, user_am_type) == FAIL);
  CHECK(x.api().send(0, 8, longest, false, user_am_type) == FAIL);
  CHECK(x.api().send(3, 0, longest, false, user_am_type) == FAIL);
  CHECK(x.api().send(3, broadcast_mote.value, longest, true, user_am_type) == FAIL);
  CHECK(x.core.counters().refused == 5);
  CHECK(x.core.counters().before_join == 0);
  CHECK(count<transport::to_network>(x.core.take_outputs()) == 1);
}

TEST_CASE("reliable sends beyond the table fail; each accepted one ends once",
          "[communication][MCK-09][AM-04]") {
  lone_layer x;
  join(x);
  for (int i = 0; i < 8; ++i)
    CHECK(x.api().send(3, static_cast<std::uint16_t>(10 + i), bytes{1}, true, user_am_type) ==
          SUCCESS);
  CHECK(x.api().send(3, 8, bytes{1}, true, user_am_type) == FAIL);
  CHECK(x.api().send(3, 8, bytes{1}, false, user_am_type) == SUCCESS); // needs no room
  for (; x.now < instant{} + 1min; x.now += 100ms) {
    x.core.on_time(x.now);
    static_cast<void>(x.core.take_outputs());
  }
  CHECK(x.program.acks == std::vector<bool>(8, false));
  CHECK(x.program.acks_of.size() == 8);
  CHECK(x.api().send(3, 8, bytes{1}, true, user_am_type) == SUCCESS);
}

TEST_CASE("what is in flight when the mote leaves has failed", "[communication][MCK-10][MCK-16]") {
  lone_layer x;
  join(x);
  for (int i = 0; i < 3; ++i)
    CHECK(x.api().send(3, 8, bytes{1}, true, user_am_type) == SUCCESS);
  x.core.on_left(x.now);
  static_cast<void>(x.core.take_outputs());
  CHECK(x.program.acks == std::vector<bool>(3, false));
  REQUIRE(x.program.joins.size() == 2);
  CHECK_FALSE(x.program.joins[1].second);
  CHECK(x.api().send(3, 8, bytes{1}, true, user_am_type) == FAIL);
}

TEST_CASE("acknowledgements come in the order of the sends, with numbers as they end",
          "[communication][MCK-10]") {
  recorder program;
  recorder receiver;
  island_fixture x({.width = 3});
  settle(x, 2);
  program.layer = x.at(id(2)).attach(program);
  receiver.layer = x.at(id(3)).attach(receiver);
  REQUIRE(receiver.layer->provide(user_am_type) == SUCCESS);
  const auto send = [&](mote_id to) {
    return act(x, id(2), [&] {
      return program.layer->send_numbered({own_island, to}, bytes{1}, true, user_am_type);
    });
  };
  const auto lost = send(id(99));
  const auto found = send(id(3));
  const auto again = send(id(3));
  REQUIRE(lost);
  REQUIRE(found);
  REQUIRE(again);
  x.run_for(5s);
  CHECK(receiver.messages.size() == 2);
  CHECK(program.acks_of == std::vector{std::pair(*found, true), std::pair(*again, true)});
  CHECK(program.acks.empty());
  x.run_for(20s);
  CHECK(program.acks == std::vector{false, true, true});
  CHECK(program.acks_of ==
        std::vector{std::pair(*found, true), std::pair(*again, true), std::pair(*lost, false)});
}

TEST_CASE("an AM type is one program's, or the layer's own", "[communication][AM-05][GEN-10]") {
  lone_layer x;
  recorder other;
  other.layer = x.core.attach(other);
  CHECK(x.api().provide(user_am_type) == SUCCESS);
  CHECK(x.api().provide(user_am_type) == SUCCESS); // again
  CHECK(other.layer->provide(user_am_type) == FAIL);
  CHECK(other.layer->provide(user_am_type + 1) == SUCCESS);
  for (int i = network::am::component_management; i <= network::am::outputs_wanted; ++i)
    CHECK(other.layer->provide(static_cast<std::uint8_t>(i)) == FAIL);
}

TEST_CASE("programs are notified of what the gateway requests of their mote, and by no other",
          "[communication][GW-10][IF-04]") {
  lone_layer x;
  join(x);
  const std::vector<communication::output_wanted> wanted{{1, 250ms},
                                                         {communication::any_channel, 0ms}};
  const auto ask = [&](int island, mote_id source, const bytes& octets) {
    constexpr auto request = network::am::outputs_wanted;
    x.core.on_packet(island_id(static_cast<std::uint32_t>(island)), request,
                     encode(test::plain(source, request, octets)), x.now);
    static_cast<void>(x.core.take_outputs());
  };
  ask(3, id(8), encode(wanted)); // a mote
  ask(4, no_mote, encode(wanted));
  CHECK(x.program.wanted.empty());
  CHECK(x.core.counters().unowned == 2);
  ask(3, no_mote, bytes{1, 2, 3});
  CHECK(x.core.counters().malformed == 1);
  ask(3, no_mote, encode(wanted));
  recorder late;
  late.layer = x.core.attach(late);
  static_cast<void>(x.core.take_outputs());
  using requests = std::vector<std::vector<communication::output_wanted>>;
  CHECK(x.program.wanted == requests{wanted});
  CHECK(late.wanted == requests{wanted});
  ask(3, no_mote, {});
  CHECK(late.wanted == requests{wanted, {}});

  CHECK(communication::wanted_on(wanted, 1).value() == wanted[0]);
  CHECK(communication::wanted_on(wanted, 2).value() == wanted[1]);
  CHECK(!communication::wanted_on({}, 1));
}

TEST_CASE("programs of a mote hear their own messages, whatever the others do",
          "[communication][NFR-04][AM-01]") {
  recorder busy;
  recorder calm;
  recorder sender;
  island_fixture x({.width = 3});
  settle(x, 2);
  busy.layer = x.at(id(3)).attach(busy);
  calm.layer = x.at(id(3)).attach(calm);
  sender.layer = x.at(id(2)).attach(sender);
  REQUIRE(busy.layer->provide(user_am_type) == SUCCESS);
  REQUIRE(calm.layer->provide(user_am_type + 1) == SUCCESS);
  const auto send = [&](std::uint8_t type) {
    return act(x, id(2), [&] { return sender.layer->send(255, 3, bytes{type}, false, type); });
  };
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 3; ++j)
      CHECK(send(user_am_type) == SUCCESS);
    if (i % 4 == 0)
      CHECK(send(user_am_type + 1) == SUCCESS);
    CHECK(send(user_am_type + 2) == SUCCESS); // no program's
    x.run_for(1s);
  }
  CHECK(busy.messages.size() == 60);
  CHECK(calm.messages.size() == 5);
  CHECK(std::ranges::all_of(calm.messages,
                            [](const auto& each) { return each.am_type == user_am_type + 1; }));
  CHECK(x.at(id(3)).above().counters().unowned == 20);
}

TEST_CASE("held messages wait at their sender, others of the same mote do not",
          "[communication][MCK-18][NFR-04]") {
  recorder receiver;
  recorder slow_sender;
  recorder sender;
  island_fixture x({.width = 3});
  settle(x, 2);
  receiver.layer = x.at(id(3)).attach(receiver);
  slow_sender.layer = x.at(id(2)).attach(slow_sender);
  REQUIRE(receiver.layer->provide(user_am_type) == SUCCESS);
  REQUIRE(receiver.layer->provide(user_am_type + 1) == SUCCESS);
  receiver.layer->hold(user_am_type);
  for (int i = 0; i < 3; ++i)
    CHECK(act(x, id(2), [&] {
            return slow_sender.layer->send(255, 3, bytes{1}, true, user_am_type);
          }) == SUCCESS);
  CHECK(act(x, id(2), [&] {
          return slow_sender.layer->send(255, 3, bytes{1}, false, user_am_type + 1);
        }) == SUCCESS);
  x.run_for(1min);
  CHECK(receiver.messages.size() == 1);
  CHECK(slow_sender.acks.empty());
  receiver.layer->release(user_am_type);
  x.run_for(5s);
  CHECK(receiver.messages.size() == 4);
  CHECK(slow_sender.acks == std::vector<bool>(3, true));
}

TEST_CASE("only its owner holds an AM type", "[communication][MCK-18][NFR-04]") {
  lone_layer x;
  recorder other;
  other.layer = x.core.attach(other);
  join(x);
  REQUIRE(x.api().provide(user_am_type) == SUCCESS);
  other.layer->hold(user_am_type);
  CHECK(x.api().send(255, own_mote.value, bytes{1}, true, user_am_type) == SUCCESS);
  loop_back(x);
  CHECK(x.program.messages.size() == 1);
  x.api().hold(user_am_type);
  other.layer->release(user_am_type);
  CHECK(x.api().send(255, own_mote.value, bytes{1}, true, user_am_type) == SUCCESS);
  loop_back(x);
  CHECK(x.program.messages.size() == 1);
  CHECK(x.core.ports().messages.core().counters().throttled == 1);
}

TEST_CASE("a program hears octets for addresses, and 0 for what is longer",
          "[communication][MCK-11][MCK-15]") {
  struct listener final : communication::communication_events {
    void receive(communication::island_octet island, std::uint16_t mote, byte_view, std::uint8_t,
                 communication::status) override {
      sources.emplace_back(island, mote);
    }
    void moteJoined(std::uint16_t mote, byte_view description) override {
      newcomers.emplace_back(mote, to_bytes(description));
    }
    std::vector<std::pair<communication::island_octet, std::uint16_t>> sources;
    std::vector<std::pair<std::uint16_t, bytes>> newcomers;
  };
  lone_layer x;
  listener program;
  auto api = x.core.attach(program);
  join(x);
  REQUIRE(api.provide(user_am_type) == SUCCESS);
  for (const auto island : {4U, 300U})
    x.core.on_packet(island_id{island}, user_am_type,
                     encode(test::plain(no_mote, user_am_type, bytes{1})), x.now);
  x.core.on_mote_joined(mote_id{9}, bytes{1, 2}, x.now);
  static_cast<void>(x.core.take_outputs());
  REQUIRE(program.sources.size() == 2);
  CHECK(program.sources[0] ==
        std::pair<communication::island_octet, std::uint16_t>(4, no_mote.value));
  CHECK(program.sources[1] ==
        std::pair<communication::island_octet, std::uint16_t>(0, no_mote.value));
  REQUIRE(program.newcomers.size() == 1);
  CHECK(program.newcomers[0] == std::pair<std::uint16_t, bytes>(9, {1, 2}));
}

TEST_CASE("a mote reaches itself without radio", "[communication][ADR-06][SYN-14][STR-11]") {
  recorder program;
  island_fixture x({.width = 2});
  settle(x, 1);
  program.layer = x.at(id(2)).attach(program);
  REQUIRE(program.layer->provide(user_am_type) == SUCCESS);
  const auto frames = x.frames;
  CHECK(act(x, id(2), [&] {
          return program.layer->send(255, own_mote.value, bytes{1}, true, user_am_type);
        }) == SUCCESS);
  CHECK(act(x, id(2), [&] {
          return program.layer->create_syn_channel_out(own_mote.value, 1,
                                                       std::array<std::uint8_t, 10>{});
        }) == SUCCESS);
  CHECK(act(x, id(2), [&] {
          return program.layer->create_syn_channel_in(own_mote.value, 1,
                                                      std::array<std::uint8_t, 10>{});
        }) == SUCCESS);
  CHECK(x.frames == frames);
  REQUIRE(program.messages.size() == 1);
  CHECK(program.messages[0].source == mote_address{island_id{1}, id(2)});
  CHECK(program.acks == std::vector{true});
  REQUIRE(program.outs.size() == 1);
  REQUIRE(program.ins.size() == 1);
  CHECK(program.outs[0].second);
  CHECK(program.ins[0].second);
}

TEST_CASE("commands return at once, and events that a program does not handle do nothing",
          "[communication][AM-02][STR-02]") {
  struct deaf final : communication::communication_events {};
  lone_layer x;
  deaf program;
  auto api = x.core.attach(program);
  join(x);
  x.core.vectors().on_tick(1, x.now);
  CHECK(api.provide(user_am_type) == SUCCESS);
  CHECK(api.send(255, 65534, bytes{1}, true, user_am_type) == SUCCESS);
  CHECK(x.core.ports().messages.core().counters().received == 0); // the command has only begun it
  loop_back(x);
  CHECK(x.core.ports().messages.core().counters().received == 1);
  CHECK(x.core.ports().messages.core().counters().reliable_acked == 1);
}
