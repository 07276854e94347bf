#include "actors/frames.hpp"
#include "actors/mote.hpp"
#include "core/codec.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/fakes.hpp"
#include "transport/segment.hpp"

using namespace rubicon;
using test::fake;
using test::virtual_world;

namespace {

constexpr mote_address stove{island_id{5}, mote_id{7}};
constexpr mote_id sink{1};
constexpr mote_id neighbour{9};
constexpr radio::radio_index stove_radio{3};

struct rig {
  virtual_world world;
  fake<air_actor> air{world};
  fake<ecology_actor> ecology{world};
  fake<mote_app_actor> app{world};
  mote_actor mote;

  explicit rig(std::vector<config::mote_app> apps = {}, std::vector<mote::way_point> path = {}) {
    world.follow("mote_app/");
    mote_arguments x;
    x.address = stove;
    x.name = "kitchen/stove";
    x.node.id = stove.mote;
    x.node.type = 101;
    x.node.transducers = {{mote::quantity::temperature, mote::constant_model{21.5}, 0, 0.1}};
    x.node.actuators = {{"switch", mote::actuator_kind::relay, 1}};
    x.apps = std::move(apps);
    x.path = std::move(path);
    x.seed = 4;
    x.radio = stove_radio;
    x.air = air.handle();
    x.ecology = ecology.handle();
    mote = world.spawn_at("mote/kitchen/stove", mote_behavior,
                          std::make_shared<const mote_arguments>(x), 0U);
  }

  void hear(mote_id source, std::uint8_t am_type, const bytes& octets) {
    world.send(mote, test::radio_frame(source, stove.mote, am_type, octets));
  }

  /// Lets the mote ask and answers as its sink.
  void join() {
    world.run_for(1s);
    const auto request = test::management_in<mote::join_request>(air.all<radio_send>().at(0));
    hear(
        sink, network::am::component_management,
        encode(mote::management(mote::join_reply{request->sequence, stove.island, stove.mote, 0})));
  }

  void hear_local(const transport::segment& x) {
    byte_writer out;
    out.big(std::uint16_t{x.am_type}).append(encode(x));
    hear(neighbour, network::am::local, out.finish());
  }

  /// Segments that the mote has sent up to its sink.
  std::vector<transport::segment> sent_up() const {
    std::vector<transport::segment> found;
    for (const auto& x : air.all<radio_send>()) {
      if (x.am_type == network::am::to_gateway)
        found.push_back(
            *transport::decode_segment(network::decode_island_packet(x.octets.view())->body));
    }
    return found;
  }

  void send(std::uint64_t token, mote_address to, bool reliable) {
    world.send(mote, send_message{app, token, to, 10, bytes{1, 2}, reliable});
  }
};

} // namespace

TEST_CASE("a mote asks everybody to take it in, and confirms the answer",
          "[actors][mote][DIS-08][MCK-14]") {
  rig x;
  CHECK(x.air.all<attach_radio>().at(0).radio == stove_radio);
  x.world.run_for(1s);
  REQUIRE(x.air.count<radio_send>() == 1);
  const auto sent = x.air.all<radio_send>()[0];
  CHECK(sent.radio == stove_radio);
  CHECK(sent.destination == broadcast_mote);
  CHECK(!sent.ack);
  const auto request = test::management_in<mote::join_request>(sent);
  REQUIRE(request);
  CHECK(request->incarnation == 0);

  x.hear(
      sink, network::am::component_management,
      encode(mote::management(mote::join_reply{request->sequence, stove.island, stove.mote, 0})));
  REQUIRE(x.air.count<radio_send>() == 2);
  const auto confirm = x.air.all<radio_send>()[1];
  CHECK(confirm.destination == sink);
  CHECK(confirm.ack);
  CHECK(test::management_in<mote::join_confirm>(confirm));
}

TEST_CASE("a mote that nobody answers goes on asking", "[actors][mote][DIS-08]") {
  rig x;
  x.world.run_for(10min);
  CHECK(x.air.count<radio_send>() > 20);
}

TEST_CASE("a send before the join is refused", "[actors][mote][MCK-16]") {
  rig x;
  x.send(5, {own_island, neighbour}, false);
  REQUIRE(x.app.count<send_ended>() == 1);
  CHECK(x.app.all<send_ended>()[0].token == 5);
  CHECK(x.app.all<send_ended>()[0].refused);
  CHECK(x.air.count<radio_send>() == 0);
}

TEST_CASE("a message to a mote of the island goes out as one frame to that mote",
          "[actors][mote][MCK-09]") {
  rig x;
  x.join();
  x.air.forget();
  x.send(5, {own_island, neighbour}, false);
  const auto ended = x.app.all<send_ended>();
  REQUIRE(ended.size() == 1);
  CHECK((ended[0].token == 5 && !ended[0].refused && !ended[0].acked));
  REQUIRE(x.air.count<radio_send>() == 1);
  const auto sent = x.air.all<radio_send>()[0];
  CHECK(sent.destination == neighbour);
  CHECK(sent.am_type == network::am::local);
  CHECK(sent.ack);
  const auto segment = transport::decode_segment(sent.octets.view().subspan(2));
  REQUIRE(segment);
  CHECK(segment->source == stove.mote);
  CHECK(segment->am_type == 10);
  CHECK(segment->payload == bytes{1, 2});
}

TEST_CASE("two reliable sends end when and as each of them is acknowledged",
          "[actors][mote][MCK-10][MCK-12]") {
  rig x;
  x.join();
  x.send(5, {own_island, no_mote}, true);
  x.send(6, {own_island, no_mote}, true);
  CHECK(x.app.count<send_ended>() == 0);
  const auto sent = x.sent_up();
  REQUIRE(sent.size() == 2);
  transport::segment ack;
  ack.source = no_mote;
  ack.sequence = sent[1].sequence;
  ack.am_type = 10;
  ack.acknowledgement = true;
  x.hear(sink, network::am::from_gateway,
         encode(network::island_packet{stove.island, stove.mote, 10, encode(ack)}));
  REQUIRE(x.app.count<send_ended>() == 1);
  CHECK(x.app.all<send_ended>()[0].token == 6);
  CHECK(x.app.all<send_ended>()[0].acked);

  x.world.run_for(1min);
  REQUIRE(x.app.count<send_ended>() == 2);
  CHECK(x.app.all<send_ended>()[1].token == 5);
  CHECK(!x.app.all<send_ended>()[1].acked);
  CHECK(!x.app.all<send_ended>()[1].refused);
  x.world.send(x.mote, status_request{});
  const auto status = x.ecology.all<message_status>().at(0).messages;
  CHECK(status.reliable_sent == 2);
  CHECK(status.reliable_acked == 1);
  CHECK(status.reliable_failed == 1);
  CHECK(status.reliable_open == 0);
}

TEST_CASE("an AM type belongs to the app that claimed it first", "[actors][mote][AM-05]") {
  rig x;
  fake<mote_app_actor> late(x.world);
  x.world.send(x.mote, claim_am_type{x.app, 10});
  x.world.send(x.mote, claim_am_type{x.app, 10});
  CHECK(x.world.logged("claim_refused") == 0);
  x.world.send(x.mote, claim_am_type{late, 10});
  CHECK(x.world.logged("claim_refused am_type=10") == 1);
  x.join();
  x.hear_local({neighbour, 1, 10, false, false, bytes{3}});
  CHECK(late.count<message_received>() == 0);
  REQUIRE(x.app.count<message_received>() == 1);
  const auto got = x.app.all<message_received>()[0];
  CHECK(got.source == mote_address{stove.island, neighbour});
  CHECK(got.am_type == 10);
  CHECK(got.octets == payload(bytes{3}));
}

TEST_CASE("two apps hear their own AM types only, whatever burst the other gets",
          "[actors][mote][NFR-04]") {
  rig x;
  fake<mote_app_actor> other(x.world);
  x.world.send(x.mote, claim_am_type{x.app, 10});
  x.world.send(x.mote, claim_am_type{other, 11});
  x.join();
  for (std::uint16_t i = 0; i < 1000; ++i)
    x.hear_local({neighbour, i, 10, false, false, bytes{1}});
  x.hear_local({neighbour, 1000, 11, false, false, bytes{2}});
  x.hear_local({neighbour, 1001, 12, false, false, bytes{3}}); // nobody's
  CHECK(x.app.count<message_received>() == 1000);
  REQUIRE(other.count<message_received>() == 1);
  CHECK(other.all<message_received>()[0].octets == payload(bytes{2}));
  for (const auto& got : x.app.all<message_received>())
    REQUIRE(got.am_type == 10);
}

TEST_CASE("a mote reads its transducers and sets its actuators for its apps", "[actors][mote]") {
  rig x;
  x.world.send(x.mote, read_transducers{x.app, {mote::quantity::temperature}});
  CHECK(x.app.all<transducers_read>().at(0).counts == std::vector<std::int16_t>{215});

  x.world.send(x.mote, set_actuator{x.app, "switch", 0});
  x.world.send(x.mote, set_actuator{x.app, "switch", 7});
  x.world.send(x.mote, set_actuator{x.app, "wings", 1});
  const auto answers = x.app.all<actuator_changed>();
  REQUIRE(answers.size() == 3);
  CHECK((answers[0].name == "switch" && answers[0].state == 0 && answers[0].obeyed));
  CHECK((answers[1].name == "switch" && answers[1].state == 0 && !answers[1].obeyed));
  CHECK((answers[2].name == "wings" && !answers[2].obeyed));
  REQUIRE(x.ecology.count<story>() == 1);
  CHECK(x.ecology.all<story>()[0].what == "switch off");
}

TEST_CASE("a mote tells its apps that it has joined", "[actors][mote][MCK-15]") {
  rig x({config::listener_app{10}});
  x.join();
  CHECK(
      x.world.followed() ==
      std::vector<std::string>{"mote_app/kitchen/stove/listener-10 (membership_changed(true, 5))"});
}

TEST_CASE("a mote whose battery is flat tells it once and is silent from then on",
          "[actors][mote][ACT-04]") {
  const bool by_fault = GENERATE(true, false);
  rig x({config::sampler_app{{mote::quantity::temperature}, 1s}});
  x.join();
  x.world.run_for(10s);
  CHECK(x.sent_up().size() >= 9);
  x.air.forget();
  if (by_fault)
    x.world.send(x.mote, end_battery{});
  else
    x.world.send(x.mote, battery_flat{});
  if (by_fault) {
    REQUIRE(x.air.count<radio_power>() == 1);
    CHECK(x.air.all<radio_power>()[0].state == radio::power::flat);
    CHECK(x.air.all<radio_power>()[0].radio == stove_radio);
    x.world.send(x.mote, battery_flat{}); // the air may say so too
  }
  REQUIRE(x.ecology.count<mote_flat>() == 1);
  CHECK(x.ecology.all<mote_flat>()[0].mote == stove);
  CHECK(x.ecology.all<story>().back().what == "battery flat");
  CHECK(x.world.followed().back() ==
        "mote_app/kitchen/stove/sampler-1 (membership_changed(false, 0))");

  x.air.forget();
  x.app.forget();
  x.world.run_for(5min);
  x.send(5, {own_island, no_mote}, true);
  x.world.send(x.mote, read_transducers{x.app, {mote::quantity::temperature}});
  x.world.send(x.mote, set_actuator{x.app, "switch", 0});
  x.hear(sink, network::am::component_management, encode(mote::management(mote::rejoin_prompt{})));
  x.world.send(x.mote, crash_now{});
  x.world.run_for(5min);
  CHECK(x.air.size() == 0);
  CHECK(x.app.size() == 0);
  CHECK(x.world.ends().empty());
}

TEST_CASE("what a mote has counted does not go with its crash, and what was open has failed",
          "[actors][mote][ACT-03]") {
  rig x;
  x.join();
  x.send(5, {own_island, no_mote}, true);
  x.send(6, {own_island, no_mote}, false);
  x.world.send(x.mote, crash_now{});
  REQUIRE(x.ecology.count<message_status>() == 1);
  const auto last = x.ecology.all<message_status>()[0];
  CHECK(last.island == stove.island);
  CHECK(last.messages.reliable_sent == 1);
  CHECK(last.messages.reliable_failed == 1);
  CHECK(last.messages.reliable_open == 0);
  CHECK(last.messages.unreliable_sent == 1);
}

TEST_CASE("a handler that throws ends its mote and the mote's apps, and nobody else",
          "[actors][mote][ACT-03][GEN-02]") {
  rig x({config::listener_app{10}});
  x.join();
  x.world.send(x.mote, crash_now{});
  REQUIRE(x.world.ends().size() == 1);
  CHECK(x.world.ends()[0].path == "mote/kitchen/stove");
  CHECK(x.world.ends()[0].reason.find("crash from the fault plan") != std::string::npos);
  x.world.run_for(1min); // what had been set comes, to nobody
  const auto before = x.world.world().trace().events();
  x.air.forget();
  x.world.run_for(1h);
  CHECK(x.world.world().trace().events() == before); // no timer of the dead goes on
  CHECK(x.air.size() == 0);
}

TEST_CASE("a mote with way-points tells the air where it is, every second while it moves",
          "[actors][mote][NET-15]") {
  rig x({}, {{0s, {0, 0, 0}}, {2s, {10, 0, 0}}, {5s, {10, 0, 0}}, {6s, {10, 4, 0}}});
  x.world.run_for(20s);
  std::vector<position> places;
  for (const auto& move : x.air.all<move_radio>()) {
    CHECK(move.radio == stove_radio);
    places.push_back(move.place);
  }
  CHECK(places == std::vector<position>{{0, 0, 0}, {5, 0, 0}, {10, 0, 0}, {10, 0, 0}, {10, 4, 0}});
  const auto times = x.air.times<move_radio>();
  CHECK(times.back() == instant(6s));
}

TEST_CASE("an app may carry its mote away from its way-points", "[actors][mote][NET-15]") {
  rig x({}, {{0s, {0, 0, 0}}, {10s, {10, 0, 0}}});
  x.world.run_for(1500ms);
  x.world.send(x.mote, move_mote{{7, 7, 7}});
  x.world.run_for(20s);
  const auto moves = x.air.all<move_radio>();
  REQUIRE(moves.size() == 3);
  CHECK(moves[1].place == position{1, 0, 0});
  CHECK(moves[2].place == position{7, 7, 7});
}
