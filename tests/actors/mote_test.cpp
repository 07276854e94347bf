#include "actors/frames.hpp"
#include "actors/island/mote.hpp"
#include "actors/island_partner.hpp"
#include "actors/kitchen.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/supervision.hpp"
#include "core/codec.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/segments.hpp"
#include "testkit/fake.hpp"
#include "transport/segment.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::stove;
using test::the_sink;

namespace {

constexpr mote_id neighbour{3};
constexpr radio::radio_index stove_radio{3};

namespace r = communication::remote;

/// What a program beside the mote has been told, of that kind.
template <class Event>
std::vector<Event> told(const fake<program_client_actor>& program) {
  std::vector<Event> found;
  for (const auto& message : program.all<program_events>()) {
    for (const auto& x : message.batch.all) {
      if (const auto* event = std::get_if<Event>(&x))
        found.push_back(*event);
    }
  }
  return found;
}

struct mote_fixture {
  fixture world;
  fake<air_actor> air{world};
  fake<ecology_actor> ecology{world};
  fake<program_client_actor> app{world}; ///< a program beside the mote
  mote_actor mote;
  test::island_partner<mote_actor> island{
      world, air, mote, stove.mote, {.width = 2, .height = 2, .island = stove.island}};

  explicit mote_fixture(std::vector<config::mote_app> apps = {},
                        std::vector<device::waypoint> path = {}) {
    mote_arguments x;
    x.address = stove;
    x.name = "kitchen/stove";
    x.node.id = stove.mote;
    x.node.type = 101;
    x.node.transducers = {{device::quantity::temperature, device::constant_model{21.5}, 0, 0.1}};
    x.node.actuators = {{"switch", device::actuator_kind::relay, 1}};
    x.apps = std::move(apps);
    x.path = std::move(path);
    x.seed = 4;
    x.radio = stove_radio;
    x.air = air.handle();
    x.ecology = ecology.handle();
    mote = world.spawn_at("mote/kitchen/stove", mote_behavior,
                          std::make_shared<const mote_arguments>(x), mote::nonvolatile{});
    attach(1, app);
  }

  void attach(std::uint32_t number, const fake<program_client_actor>& program) {
    world.send(mote, attach_program{number, program});
  }
  void command(r::command x, std::uint32_t of = 1) {
    world.send(mote, program_commands{of, {0, {std::move(x)}}});
  }

  [[nodiscard]] bool is_member() {
    for (const auto& x : island.cores.up) {
      const auto event = network::decode_sink_event(x.payload);
      const auto* joined = event ? std::get_if<network::mote_joined>(&*event) : nullptr;
      if (joined != nullptr && joined->mote == stove.mote)
        return true;
    }
    return false;
  }

  /// Everybody is a member, and neighbours know each other.
  void join() {
    REQUIRE(island.run_until([this] { return is_member(); }, 1min));
    island.run_for(30s);
    island.sent.clear();
    island.cores.up.clear();
  }

  /// A frame of the neighbour with this segment.
  void hear_local(const transport::segment& x, std::uint8_t of_island = 5) {
    const auto packet =
        encode(network::island_packet{stove.island, stove.mote, x.am_type, encode(x)});
    bytes octets{network::am::packet, 0}; // the only piece
    octets.insert(octets.end(), packet.begin(), packet.end());
    world.send(mote,
               test::radio_frame(neighbour, stove.mote, network::am::local, octets, of_island));
  }

  /// Segments that the mote has sent up to its gateway.
  std::vector<transport::segment> sent_up() const {
    std::vector<transport::segment> found;
    for (const auto& x : island.cores.up) {
      if (x.am_type == network::am::to_gateway && x.source == stove.mote)
        found.push_back(*transport::decode_segment(network::decode_island_packet(x.payload)->body));
    }
    return found;
  }

  /// The gateway acknowledges what the mote has sent up.
  void accept(const transport::segment& x) {
    const auto answer = encode(test::acknowledgement(no_mote, x));
    island.cores.down(network::am::from_gateway,
                      encode(network::island_packet{stove.island, stove.mote, 10, answer}));
    island.run_for(200ms);
  }

  void send(std::uint32_t number, mote_address to, bool reliable) {
    command(r::send_message{number, to, payload(bytes{1, 2}), reliable, 10});
    island.run_for(200ms);
  }
};

} // namespace

TEST_CASE("a mote holds no state of what few motes have, nor tables' sizes of its own",
          "[actors][mote]") {
  // With the state of SMEPP Light, or a copy of all sizes, there would be a tenth more at least.
  CHECK(sizeof(mote_state) <= 7'500);
  CHECK(sizeof(mote_arguments) <= 640);
}

TEST_CASE("a mote asks its sink to take it in once it knows a way, and confirms the answer",
          "[actors][mote][DIS-08][MCK-14][ACT-01]") {
  mote_fixture x;
  CHECK(x.air.all<attach_radio>().at(0).radio == stove_radio);
  REQUIRE(x.island.run_until([&x] { return x.is_member(); }, 1min));
  std::size_t requests = 0;
  std::size_t confirms = 0;
  for (const auto& sent : x.island.sent) {
    CHECK(sent.radio == stove_radio);
    CHECK(sent.destination == the_sink);
    CHECK(sent.ack);
    if (const auto request = test::management_in<mote::join_request>(sent)) {
      CHECK(request->incarnation == 0);
      ++requests;
    }
    confirms += test::management_in<mote::join_confirm>(sent) ? 1 : 0;
  }
  CHECK(requests == 1);
  CHECK(confirms == 1);
}

TEST_CASE("a mote that nobody answers goes on asking", "[actors][mote][DIS-08]") {
  mote_fixture x;
  x.island.only_beacons = true;
  x.island.run_for(10min);
  const auto requests = std::ranges::count_if(x.island.sent, [](const auto& sent) {
    return test::management_in<mote::join_request>(sent).has_value();
  });
  CHECK(requests > 20);
  CHECK_FALSE(x.is_member());
}

TEST_CASE("a mote that hears no one has nobody to ask, but tells that it is there",
          "[actors][mote][DIS-08][NET-11]") {
  mote_fixture x;
  x.world.run_for(1min);
  CHECK(x.air.count<radio_send>() == 1); // the air has not said yet what has become of it
  CHECK(x.air.all<radio_send>()[0].am_type == network::am::beacon);
}

TEST_CASE("a send before the join is refused", "[actors][mote][MCK-16]") {
  mote_fixture x;
  x.send(5, {own_island, neighbour}, true);
  REQUIRE(told<r::send_ended>(x.app).size() == 1);
  CHECK(told<r::send_ended>(x.app)[0].number == 5);
  CHECK_FALSE(told<r::send_ended>(x.app)[0].acked);
  CHECK(x.air.count<radio_send>() == 0);
}

TEST_CASE("a message to a mote of the island goes out as one frame to that mote",
          "[actors][mote][MCK-09]") {
  mote_fixture x;
  x.join();
  x.send(5, {own_island, neighbour}, false);
  std::vector<radio_send> local;
  for (const auto& sent : x.island.sent) {
    if (sent.am_type == network::am::local)
      local.push_back(sent);
  }
  REQUIRE(local.size() == 1);
  CHECK(local[0].destination == neighbour);
  CHECK(local[0].ack);
  REQUIRE(x.island.cores.received.size() == 1);
  const auto& [who, message] = x.island.cores.received[0];
  CHECK(who == neighbour);
  CHECK(message.source == stove);
  CHECK(message.am_type == 10);
  CHECK(message.payload == bytes{1, 2});
}

TEST_CASE("two reliable sends end when and as each of them is acknowledged",
          "[actors][mote][MCK-10][MCK-12]") {
  mote_fixture x;
  x.join();
  x.send(5, {own_island, no_mote}, true);
  x.send(6, {own_island, no_mote}, true);
  CHECK(told<r::send_ended>(x.app).empty());
  REQUIRE(x.sent_up().size() == 1);
  CHECK(x.sent_up()[0].what == transport::segment::kind::hello);
  x.accept(x.sent_up()[0]);
  REQUIRE(x.sent_up().size() == 2);
  x.accept(x.sent_up()[1]);
  REQUIRE(told<r::send_ended>(x.app).size() == 1);
  CHECK(told<r::send_ended>(x.app)[0].number == 5);
  CHECK(told<r::send_ended>(x.app)[0].acked);

  x.island.run_for(1min);
  REQUIRE(told<r::send_ended>(x.app).size() == 2);
  CHECK(told<r::send_ended>(x.app)[1].number == 6);
  CHECK(!told<r::send_ended>(x.app)[1].acked);
  x.world.send(x.mote, status_request{});
  const auto status = x.ecology.all<message_status>().at(0).messages;
  CHECK(status.reliable_sent == 2);
  CHECK(status.reliable_acked == 1);
  CHECK(status.reliable_failed == 1);
  CHECK(status.reliable_open == 0);
}

TEST_CASE("an AM type belongs to the program that claimed it first", "[actors][mote][AM-05]") {
  mote_fixture x({config::listener_app{11}, config::listener_app{11}});
  fake<program_client_actor> late(x.world);
  x.attach(2, late);
  x.command(r::provide_type{10});
  x.command(r::provide_type{10});
  CHECK(told<r::type_refused>(x.app).empty());
  x.command(r::provide_type{10}, 2);
  CHECK(told<r::type_refused>(late).size() == 1);
  x.join();
  CHECK(x.world.logged("claim_refused am_type=11") == 1);
  x.hear_local(test::plain(neighbour, 10, bytes{3}));
  CHECK(told<r::message_received>(late).empty());
  REQUIRE(told<r::message_received>(x.app).size() == 1);
  const auto got = told<r::message_received>(x.app)[0];
  CHECK(got.source == mote_address{stove.island, neighbour});
  CHECK(got.am_type == 10);
  CHECK(got.octets == payload(bytes{3}));
}

TEST_CASE("a mote takes no frames of another island", "[actors][mote][RTG-06][GEN-11]") {
  mote_fixture x;
  x.command(r::provide_type{10});
  x.join();
  x.hear_local(test::plain(neighbour, 10, bytes{3}), 6);
  CHECK(told<r::message_received>(x.app).empty());
  x.hear_local(test::plain(neighbour, 10, bytes{3}));
  CHECK(told<r::message_received>(x.app).size() == 1);
}

TEST_CASE("two programs hear their own AM types only, whatever burst the other gets",
          "[actors][mote][NFR-04]") {
  mote_fixture x;
  fake<program_client_actor> other(x.world);
  x.attach(2, other);
  x.command(r::provide_type{10});
  x.command(r::provide_type{11}, 2);
  x.join();
  for (std::uint16_t i = 0; i < 1000; ++i)
    x.hear_local(test::plain(neighbour, 10, bytes{1}));
  x.hear_local(test::plain(neighbour, 11, bytes{2}));
  x.hear_local(test::plain(neighbour, 12, bytes{3})); // nobody's
  CHECK(told<r::message_received>(x.app).size() == 1000);
  REQUIRE(told<r::message_received>(other).size() == 1);
  CHECK(told<r::message_received>(other)[0].octets == payload(bytes{2}));
  for (const auto& got : told<r::message_received>(x.app))
    REQUIRE(got.am_type == 10);
}

TEST_CASE("a mote reads its transducers and sets its actuators for its programs",
          "[actors][mote][PAR-05]") {
  mote_fixture x;
  x.command(r::read_transducers{{device::quantity::temperature}});
  CHECK(told<r::transducers_read>(x.app).at(0).counts == std::vector<std::int16_t>{215});
  x.command(r::read_transducers{{device::quantity::temperature, device::quantity::light}});
  CHECK(told<r::transducers_read>(x.app).at(1).counts.empty()); // it has no eye

  x.command(r::set_actuator{"switch", 0});
  x.command(r::set_actuator{"switch", 7});
  x.command(r::set_actuator{"wings", 1});
  const auto answers = told<r::actuator_changed>(x.app);
  REQUIRE(answers.size() == 3);
  CHECK((answers[0].name == "switch" && answers[0].state == 0 && answers[0].obeyed));
  CHECK((answers[1].name == "switch" && answers[1].state == 0 && !answers[1].obeyed));
  CHECK((answers[2].name == "wings" && !answers[2].obeyed));
  REQUIRE(x.ecology.count<notable_event>() == 1);
  CHECK(x.ecology.all<notable_event>()[0].what == "switch off");
}

TEST_CASE("what samplers, messengers and listeners do is told under their own names",
          "[actors][mote]") {
  mote_fixture x({config::listener_app{10}, config::messenger_app{{}, "nobody", 10s}});
  x.join();
  x.hear_local(test::plain(neighbour, 10, to_bytes(std::string_view("dinner"))));
  REQUIRE(x.ecology.count<notable_event>() == 1);
  CHECK(x.ecology.all<notable_event>()[0].who == "mote_app/kitchen/stove/listener-10");
  CHECK(x.ecology.all<notable_event>()[0].what == "received \"dinner\" from mote 5/3");
  CHECK(x.world.logged("mote_app/kitchen/stove/messenger-10 event=undelivered number=1 "
                       "refused=true") == 1);
}

TEST_CASE("a mote sends what is requested of it from outside, and reports the outcome",
          "[actors][mote][MCK-10]") {
  mote_fixture x;
  const auto outcomes = [&x] {
    std::vector<std::string> found;
    for (const auto& each : x.ecology.all<notable_event>())
      if (each.who == "mote_app/kitchen/stove/requested")
        found.push_back(each.what);
    return found;
  };
  const auto request = [&x](std::uint32_t number, bool reliable) {
    x.world.send(
        x.mote, send_as_program{number, {own_island, no_mote}, payload(bytes{1, 2}), reliable, 10});
    x.island.run_for(200ms);
  };
  request(1, true);
  CHECK(outcomes() == std::vector<std::string>{"message 1 refused"});
  x.join();
  request(2, true);
  request(3, false);
  REQUIRE(x.sent_up().size() == 2);
  CHECK(x.sent_up()[1].payload == bytes{1, 2});
  x.accept(x.sent_up()[0]); // the hello
  REQUIRE(x.sent_up().size() == 3);
  x.accept(x.sent_up()[2]);
  CHECK(outcomes() == std::vector<std::string>{"message 1 refused", "message 2 acknowledged"});
  request(4, true);
  x.island.run_for(1min);
  CHECK(outcomes().back() == "message 4 not acknowledged");
  CHECK(told<r::send_ended>(x.app).empty()); // other programs know nothing of it

  x.world.send(x.mote, battery_flat{});
  request(5, false);
  CHECK(x.ecology.all<notable_event>().back().what == "message 5 refused");
}

TEST_CASE("a mote whose battery is flat tells it once and is silent from then on",
          "[actors][mote][ACT-04]") {
  const bool by_fault = GENERATE(true, false);
  mote_fixture x({config::sampler_app{{device::quantity::temperature}, 1s}});
  x.join();
  x.island.run_for(10s);
  CHECK(x.sent_up().size() >= 9);
  x.air.forget();
  if (by_fault)
    x.world.send(x.mote, end_battery{});
  else
    x.world.send(x.mote, battery_flat{});
  if (by_fault) {
    CHECK(x.ecology.count<mote_flat>() == 0); // it tells its sink first
    x.world.run_for(1s);
    REQUIRE(x.air.count<radio_power>() == 1);
    CHECK(x.air.all<radio_power>()[0].state == radio::power::flat);
    CHECK(x.air.all<radio_power>()[0].radio == stove_radio);
    x.world.send(x.mote, battery_flat{}); // the air may say so too
  }
  REQUIRE(x.ecology.count<mote_flat>() == 1);
  CHECK(x.ecology.all<mote_flat>()[0].mote == stove);
  CHECK(x.ecology.all<notable_event>().back().what == "battery flat");
  CHECK(x.app.count<program_detached>() == 1);

  x.air.forget();
  x.app.forget();
  x.world.run_for(5min);
  x.send(5, {own_island, no_mote}, true);
  x.command(r::read_transducers{{device::quantity::temperature}});
  x.command(r::set_actuator{"switch", 0});
  x.hear_local(test::hello(neighbour, 1, 10));
  x.world.send(x.mote, crash_now{});
  x.world.run_for(5min);
  CHECK(x.air.size() == 0);
  CHECK(x.app.size() == 0);
  CHECK(x.world.ends().empty());
}

TEST_CASE("what a mote has counted does not go with its crash, and what was open has failed",
          "[actors][mote][ACT-03]") {
  mote_fixture x;
  x.join();
  x.send(5, {own_island, no_mote}, true);
  x.send(6, {own_island, no_mote}, false);
  x.world.send(x.mote, crash_now{});
  REQUIRE(x.ecology.count<message_status>() == 1);
  const auto last = x.ecology.all<message_status>()[0];
  CHECK(last.who.island == stove.island);
  CHECK(last.messages.reliable_sent == 1);
  CHECK(last.messages.reliable_failed == 1);
  CHECK(last.messages.reliable_open == 0);
  CHECK(last.messages.unreliable_sent == 1);
}

TEST_CASE("a handler that throws ends its mote and the mote's apps, and nobody else",
          "[actors][mote][ACT-03][GEN-02]") {
  mote_fixture x({config::listener_app{10}});
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

TEST_CASE("a mote with waypoints tells the air where it is, every second while it moves",
          "[actors][mote][NET-15]") {
  mote_fixture x({}, {{0s, {0, 0, 0}}, {2s, {10, 0, 0}}, {5s, {10, 0, 0}}, {6s, {10, 4, 0}}});
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

TEST_CASE("an app may carry its mote away from its waypoints", "[actors][mote][NET-15]") {
  mote_fixture x({}, {{0s, {0, 0, 0}}, {10s, {10, 0, 0}}});
  x.world.run_for(1500ms);
  x.world.send(x.mote, move_mote{{7, 7, 7}});
  x.world.run_for(20s);
  const auto moves = x.air.all<move_radio>();
  REQUIRE(moves.size() == 3);
  CHECK(moves[1].place == position{1, 0, 0});
  CHECK(moves[2].place == position{7, 7, 7});
}

TEST_CASE("a mote carries out the commands of a program in another actor, until that ends",
          "[actors][mote][PAR-05][MCK-04][MCK-07][AM-05]") {
  mote_fixture x;
  x.join();
  auto& first = x.app;
  fake<program_client_actor> second(x.world);
  x.attach(2, second);
  REQUIRE(first.count<program_attached>() == 1);
  CHECK(first.all<program_attached>()[0].limits.transducer_mask == 1);
  REQUIRE(told<r::joined>(first).size() == 1);
  CHECK(told<r::joined>(first)[0].self == stove);

  x.world.send(
      x.mote,
      program_commands{
          1, {2, {r::open_sensor{4, 0, false, 0}, r::read_stream{4, 12}, r::provide_type{10}}}});
  REQUIRE(told<r::record_read>(first).size() == 1);
  const auto record = stream::decode_sensor_record(told<r::record_read>(first)[0].record.view());
  REQUIRE(record);
  CHECK(record->value == 215);
  CHECK(first.all<program_events>().back().batch.taken == 3);
  x.world.send(x.mote, program_commands{2, {2, {r::provide_type{10}}}});
  CHECK(told<r::type_refused>(second).size() == 1);
  x.hear_local(test::plain(neighbour, 10, bytes{3}));
  REQUIRE(told<r::message_received>(first).size() == 1);
  CHECK(told<r::message_received>(first)[0].octets == payload(bytes{3}));

  post_exit(first.handle(), caf::exit_reason::kill);
  x.world.run_for(1ms);
  x.world.send(
      x.mote,
      program_commands{
          2, {3, {r::provide_type{10}, r::open_sensor{1, 0, false, 0}, r::read_stream{1, 12}}}});
  CHECK(told<r::type_refused>(second).size() == 1); // both are free again
  REQUIRE(told<r::record_read>(second).size() == 1);
  CHECK(told<r::record_read>(second)[0].success);
  x.world.send(x.mote, program_commands{1, {2, {r::open_local{5}}}}); // of the one that ended
  x.world.send(x.mote, end_battery{});
  x.world.run_for(1s);
  CHECK(second.count<program_detached>() == 1);
  x.world.send(x.mote, attach_program{1, second});
  CHECK(second.count<program_attached>() == 1);
}
