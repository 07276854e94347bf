#include "core/tuples/device_keys.hpp"
#include "gateway/gateway.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "network/wire.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"
#include "support/recorder.hpp"
#include "support/segments.hpp"
#include "transport/fragments.hpp"
#include "transport/segment.hpp"
#include "unit/gateway/fixture.hpp"

using namespace rubicon;
using gateway::answer_sink;
using gateway::erase;
using gateway::gateway_config;
using gateway::member_changed;
using gateway::publish;
using gateway::to_gateway;
using gateway::to_sink;
using kind = transport::segment::kind;
using test::acknowledgement;
using test::deliver;
using test::fan;
using test::hello;
using test::join;
using test::kitchen;
using test::pick;
using test::plain;
using test::published;
using test::reliable;
using test::the_sink;

namespace {

gateway::gateway make_without_sink() {
  gateway_config config;
  config.island = kitchen;
  gateway::gateway x(config, random_stream(1));
  static_cast<void>(x.start({}));
  return x;
}

gateway::gateway make_gateway() {
  auto x = make_without_sink();
  static_cast<void>(deliver(x, network::sink_started{}));
  return x;
}

bytes up(mote_address to, const transport::segment& segment) {
  return encode(network::island_packet{to.island, to.mote, segment.am_type, encode(segment)});
}

transport::segment segment_down(const gateway::outputs& out) {
  const auto packets = pick<to_sink>(out);
  REQUIRE(packets.size() == 1);
  REQUIRE(packets[0].am_type == network::am::from_gateway);
  const auto packet = network::decode_island_packet(packets[0].payload);
  REQUIRE(packet);
  return *transport::decode_segment(packet->body);
}

/// A mote says hello, so that it may send reliable segments from counter 1 on.
void greet(gateway::gateway& x, mote_id mote, std::uint8_t am_type) {
  static_cast<void>(x.on_packet(mote, network::am::to_gateway,
                                up({kitchen, no_mote}, hello(mote, 0, am_type)), {}));
}

/// A mote accepts what the gateway has sent it.
gateway::outputs accept(gateway::gateway& x, mote_id mote, const transport::segment& sent) {
  return x.on_packet(mote, network::am::to_gateway,
                     up({kitchen, no_mote}, acknowledgement(mote, sent)), instant{50ms});
}

} // namespace

TEST_CASE("a gateway publishes its devices as D1.1 5.4 says", "[gateway][GW-03][GW-04][GW-09]") {
  auto x = make_gateway();
  CHECK(published(x.start({}), "devices") == "{}");
  join(x, mote_id{11});
  const auto out = deliver(x, network::mote_joined{fan, 0, 42, bytes{0xaa, 0xbb}});
  CHECK(published(out, "devices") == "{7,11}");
  CHECK(published(out, "devices.7.type") == "0000002a");
  CHECK(published(out, "devices.7.descriptor") == "aabb");
  REQUIRE(pick<member_changed>(out).size() == 1);
  CHECK(pick<member_changed>(out)[0].listed);
}

TEST_CASE("a leaving mote takes its tuples with it", "[gateway][DIS-06]") {
  auto x = make_gateway();
  join(x, fan);
  static_cast<void>(x.on_packet(fan, network::am::to_gateway,
                                up({kitchen, no_mote}, plain(fan, 2, bytes{1})), {}));
  static_cast<void>(x.on_input(fan, 2, bytes{1}, {}));
  const auto out = deliver(x, network::mote_left{fan, network::leave_cause::silence});
  CHECK(published(out, "devices") == "{}");
  std::vector<std::string> erased;
  for (const auto& y : pick<erase>(out))
    erased.push_back(y.key);
  CHECK(published(out, "devices.7.status") == "left silence 0.000000");
  CHECK(erased == std::vector<std::string>{"devices.7.type", "devices.7.descriptor",
                                           "devices.7.output.2", "devices.7.input.2.status"});
  CHECK(pick<member_changed>(out)[0].cause == network::leave_cause::silence);
  CHECK(deliver(x, network::mote_left{fan, network::leave_cause::silence}).empty());
}

TEST_CASE("what a mote sends to its gateway becomes an output tuple, each message once",
          "[gateway][GW-06][GW-08][RTG-03]") {
  auto x = make_gateway();
  join(x, fan);
  greet(x, fan, 2);
  const auto message = up({kitchen, no_mote}, reliable(fan, 1, 2, bytes{0x01, 0x56}));
  const auto out = x.on_packet(fan, network::am::to_gateway, message, {});
  CHECK(published(out, "devices.7.output.2") == "0156");
  CHECK(segment_down(out).what == kind::acknowledgement);
  const auto again = x.on_packet(fan, network::am::to_gateway, message, {});
  CHECK(pick<publish>(again).empty());
  CHECK(segment_down(again).what == kind::acknowledgement);
  CHECK(x.counters().outputs_published == 1);
}

TEST_CASE("a message of a mote whose join was lost is not acknowledged; the sink is asked",
          "[gateway][GW-15]") {
  auto x = make_gateway();
  const auto message = up({kitchen, no_mote}, reliable(fan, 1, 2, bytes{1}));
  const auto out = x.on_packet(fan, network::am::to_gateway, message, {});
  CHECK(pick<publish>(out).empty());
  REQUIRE(pick<to_sink>(out).size() == 1);
  CHECK(pick<to_sink>(out)[0].am_type == network::am::sink_event);
  CHECK(to_hex(pick<to_sink>(out)[0].payload) == "040007");
  join(x, fan);
  greet(x, fan, 2);
  CHECK(published(x.on_packet(fan, network::am::to_gateway, message, {}), "devices.7.output.2") ==
        "01");
}

TEST_CASE("an input is sent reliably and its status told", "[gateway][GW-05][GW-12][IF-07]") {
  auto x = make_gateway();
  join(x, fan);
  const auto out = x.on_input(fan, 2, bytes{1}, {});
  CHECK(published(out, "devices.7.input.2.status") == "1 pending");
  const auto question = segment_down(out);
  CHECK(question.what == kind::hello);
  const auto command = segment_down(accept(x, fan, question));
  CHECK(command.source == no_mote);
  CHECK(command.am_type == 2);
  CHECK(command.what == kind::reliable);
  CHECK(command.payload == bytes{1});

  SECTION("acknowledged") {
    const auto done = accept(x, fan, command);
    CHECK(published(done, "devices.7.input.2.status") == "1 acknowledged");
    CHECK(x.pc().outstanding() == 0);
  }
  SECTION("never acknowledged") {
    std::string last;
    while (x.pc().outstanding() > 0) {
      const auto later = x.on_time(*x.deadline());
      if (!pick<publish>(later).empty())
        last = published(later, "devices.7.input.2.status");
    }
    CHECK(last == "1 failed");
  }
  SECTION("equal writes are sent each") {
    const auto second = x.on_input(fan, 2, bytes{1}, {});
    CHECK(published(second, "devices.7.input.2.status") == "2 pending");
    const auto next = segment_down(accept(x, fan, command));
    CHECK(next.what == kind::reliable);
    CHECK(next.counter != command.counter);
  }
}

TEST_CASE("an input for a mote that is not there, or for no AM type, fails visibly",
          "[gateway][GW-12]") {
  auto x = make_gateway();
  const auto refused = x.on_input(fan, 2, bytes{1}, {});
  CHECK(to_string(pick<publish>(refused).at(0).value) == "1 pending");
  CHECK(published(refused, "devices.7.input.2.status") == "1 unreachable");
  join(x, fan);
  const auto out = x.on_input(fan, 300, bytes{1}, {});
  CHECK(published(out, "devices.7.input.300.status") == "1 failed");
  CHECK(pick<to_sink>(out).empty());
}

TEST_CASE("messages between islands change only their header, and stay as reliable as they were",
          "[gateway][RTG-02][WIR-02][ACK-09]") {
  const bool is_reliable = GENERATE(true, false);
  auto x = make_gateway();
  join(x, fan);
  const auto segment =
      is_reliable ? reliable(fan, 9, 10, bytes{'h', 'i'}) : plain(fan, 10, bytes{'h', 'i'});
  const auto out =
      x.on_packet(fan, network::am::to_gateway, up({island_id{2}, mote_id{5}}, segment), {});
  REQUIRE(pick<to_gateway>(out).size() == 1);
  const auto across = pick<to_gateway>(out)[0];
  CHECK(across.peer == peer_id{2});
  CHECK(across.reliable == is_reliable);
  CHECK(to_hex(across.octets) == "0005000a" + to_hex(encode(segment)));

  auto other = make_gateway();
  join(other, mote_id{5});
  const auto down =
      other.on_message(peer_id{2}, communication::island_message_port, across.octets, {});
  REQUIRE(pick<to_sink>(down).size() == 1);
  CHECK(to_hex(pick<to_sink>(down)[0].payload) == "000000020005000a" + to_hex(encode(segment)));
  CHECK(pick<to_sink>(down)[0].mote == mote_id{5});
}

TEST_CASE("messages of other islands for absent motes or nobody are dropped and counted",
          "[gateway][RTG-05]") {
  auto x = make_gateway();
  CHECK(x.on_message(peer_id{2}, communication::island_message_port, *from_hex("0005000a"), {})
            .empty());
  CHECK(x.counters().undeliverable == 1);
  CHECK(x.on_message(peer_id{2}, communication::island_message_port, bytes{0}, {}).empty());
  CHECK(x.on_message(peer_id{-1}, communication::island_message_port, *from_hex("0005000a"), {})
            .empty());
  CHECK(x.counters().malformed == 2);
  CHECK(pick<to_sink>(
            x.on_message(peer_id{2}, communication::island_message_port, *from_hex("ffff000a"), {}))
            .size() == 1);
}

TEST_CASE("an output of another island's mote is not that of ours with its number",
          "[gateway][GW-04][RTG-05]") {
  auto x = make_gateway();
  join(x, fan);
  const auto output = encode(network::gateway_packet{no_mote, 2, encode(plain(fan, 2, bytes{1}))});
  CHECK(x.on_message(peer_id{2}, communication::island_message_port, output, {}).empty());
  CHECK(x.counters().undeliverable == 1);
  CHECK(x.counters().outputs_published == 0);
}

TEST_CASE("programs of a gateway hear of motes that join, once in each life",
          "[gateway][MCK-15][DIS-03]") {
  auto x = make_gateway();
  test::recorder program;
  program.layer = x.attach(program);
  const auto joins = [&](mote_id mote, std::uint32_t incarnation, bytes descriptor) {
    static_cast<void>(
        deliver(x, network::mote_joined{mote, incarnation, 301, std::move(descriptor)}));
    return program.newcomers.size();
  };
  CHECK(joins(fan, 0, bytes{0xaa, 0xbb}) == 1);
  CHECK(program.newcomers[0] == std::pair(fan.value, bytes{0xaa, 0xbb}));
  CHECK(joins(fan, 0, bytes{0xaa, 0xbb}) == 1); // the sink has been asked
  CHECK(joins(mote_id{8}, 0, bytes{0xcc}) == 2);
  CHECK(joins(fan, 1, bytes{0xaa}) == 3); // it has been started again
  static_cast<void>(deliver(x, network::mote_left{fan, network::leave_cause::notice}));
  CHECK(joins(fan, 1, bytes{0xaa}) == 4);
}

TEST_CASE("what a gateway's program provides it gets, and the tuples the rest",
          "[gateway][GW-06][AM-05]") {
  auto x = make_gateway();
  test::recorder program;
  program.layer = x.attach(program);
  REQUIRE(program.layer->provide(10) == communication::SUCCESS);
  join(x, fan);
  const auto hear = [&](std::uint8_t type) {
    return pick<publish>(x.on_packet(fan, network::am::to_gateway,
                                     up({kitchen, no_mote}, plain(fan, type, bytes{1})), {}))
        .size();
  };
  CHECK(hear(10) == 0);
  REQUIRE(program.messages.size() == 1);
  CHECK(program.messages[0].source == mote_address{kitchen, fan});
  CHECK(hear(11) == 1);
  CHECK(program.messages.size() == 1);
}

TEST_CASE("a roster brings a gateway's list back to the truth", "[gateway][GW-15]") {
  auto x = make_gateway();
  join(x, fan);
  join(x, mote_id{8});
  join(x, mote_id{9}, 1);
  const auto asked = [](const gateway::outputs& out) {
    std::vector<mote_id> motes;
    for (const auto& y : pick<to_sink>(out))
      motes.push_back(y.mote);
    return motes;
  };
  CHECK(asked(deliver(x, network::roster{1, 0, 2, {{fan, 0}, {mote_id{9}, 2}}})) ==
        std::vector{mote_id{9}}); // rebooted unseen
  CHECK(asked(deliver(x, network::roster{1, 1, 2, {{mote_id{10}, 0}}})) ==
        std::vector{mote_id{10}, mote_id{8}}); // missing here, missing there
  CHECK(asked(deliver(x, network::roster{2, 0, 1, {{fan, 0}, {mote_id{8}, 0}, {mote_id{9}, 1}}}))
            .empty());
  // The rest of this one does not come; its page is none of the next one's.
  CHECK(asked(deliver(x, network::roster{3, 0, 2, {{fan, 0}}})).empty());
  CHECK(asked(deliver(x, network::roster{4, 0, 2, {{fan, 0}, {mote_id{8}, 0}}})).empty());
  CHECK(asked(deliver(x, network::roster{4, 1, 2, {{mote_id{9}, 1}}})).empty());
}

TEST_CASE("what a gateway cannot read it drops and counts", "[gateway]") {
  auto x = make_gateway();
  CHECK(x.on_packet(fan, network::am::to_gateway, bytes{0}, {}).empty());
  CHECK(x.on_packet(the_sink, network::am::sink_event, bytes{9}, {}).empty());
  CHECK(x.counters().malformed == 2);
  CHECK(x.on_packet(the_sink, 0x77, {}, {}).empty());
  CHECK(deliver(x, network::describe{fan}).empty());
  CHECK(x.counters().unknown_type == 2);
}

TEST_CASE("no more inputs wait than there is room for", "[gateway]") {
  gateway_config config;
  config.island = kitchen;
  config.inputs_outstanding_max = 2;
  gateway::gateway x(config, random_stream(1));
  static_cast<void>(x.start({}));
  join(x, fan);
  static_cast<void>(x.on_input(fan, 2, bytes{1}, {}));
  static_cast<void>(x.on_input(fan, 2, bytes{0}, {}));
  CHECK(published(x.on_input(fan, 2, bytes{1}, {}), "devices.7.input.2.status") == "3 failed");
}

TEST_CASE("no more channels are remembered than there is room for", "[gateway]") {
  gateway_config config;
  config.island = kitchen;
  config.input_channels_max = 2;
  gateway::gateway x(config, random_stream(1));
  CHECK_FALSE(x.on_input(fan, 2, bytes{1}, {}).empty());
  CHECK_FALSE(x.on_input(fan, 3, bytes{1}, {}).empty());
  CHECK(x.on_input(fan, 4, bytes{1}, {}).empty());
  CHECK_FALSE(x.on_input(fan, 3, bytes{1}, {}).empty());
  CHECK(x.counters().inputs == 3);
  CHECK(x.counters().inputs_refused == 1);
}

TEST_CASE("packets longer than a serial packet go up and down in fragments",
          "[gateway][NET-14][WIR-04]") {
  auto x = make_gateway();
  join(x, fan);
  const bytes reading(256, 0x5a);
  const auto octets = up({kitchen, no_mote}, plain(fan, 2, reading));
  const auto fragments = transport::cut(octets, network::frame_payload_max, 9);
  REQUIRE(fragments->size() == 3);
  CHECK(x.on_packet(fan, network::am::packet, fragments->at(2), {}).empty());
  CHECK(x.on_packet(mote_id{8}, network::am::packet, fragments->at(1), {})
            .empty()); // of another mote
  CHECK(x.on_packet(fan, network::am::packet, fragments->at(0), {}).empty());
  const auto out = x.on_packet(fan, network::am::packet, fragments->at(1), {});
  CHECK(published(out, "devices.7.output.2") == to_hex(reading));

  const auto message = encode(network::gateway_packet{fan, 10, encode(plain(fan, 10, reading))});
  const auto down =
      pick<to_sink>(x.on_message(peer_id{2}, communication::island_message_port, message, {}));
  REQUIRE(down.size() == 3);
  transport::assembly sink;
  std::optional<bytes> whole;
  for (const auto& fragment : down) {
    CHECK(fragment.am_type == network::am::packet);
    CHECK(fragment.payload.size() <= network::frame_payload_max);
    CHECK_FALSE(whole);
    whole = sink.on_fragment(the_sink, fragment.payload, {});
  }
  REQUIRE(whole);
  const auto packet = network::decode_island_packet(*whole);
  CHECK(packet->island == island_id{2});
  CHECK(transport::decode_segment(packet->body)->payload == reading);
}

TEST_CASE("a silent line makes motes stale, not gone; what is heard again is not",
          "[gateway][GW-15]") {
  auto x = make_without_sink();
  const auto hear = [&](mote_id source, instant now) {
    return x.on_packet(source, network::am::to_gateway,
                       up({kitchen, no_mote}, plain(source, 2, {})), now);
  };
  const auto first = deliver(x, network::mote_joined{fan, 0, 301, {}});
  CHECK(published(first, "devices.line") == "up 0.000000");
  CHECK(published(first, "devices.7.status") == "listed 0.000000");
  join(x, mote_id{11});
  CHECK(published(hear(fan, instant{3s}), "devices.line") == "nothing");
  CHECK(published(x.on_time(instant{27s}), "devices.line") == "nothing");

  const auto silent = x.on_time(instant{28s});
  CHECK(published(silent, "devices.line") == "silent 3.000000");
  CHECK(published(silent, "devices.7.status") == "stale 28.000000");
  CHECK(published(silent, "devices.11.status") == "stale 28.000000");
  CHECK(pick<member_changed>(silent).empty());
  CHECK(published(silent, "devices") == "nothing");

  const auto back = hear(fan, instant{40s});
  CHECK(published(back, "devices.line") == "up 40.000000");
  CHECK(published(back, "devices.7.status") == "listed 40.000000");
  CHECK(published(back, "devices.11.status") == "nothing");
  REQUIRE(pick<gateway::line_changed>(back).size() == 1);
  CHECK(pick<gateway::line_changed>(back)[0].silence == 37s);
  const auto roster = x.on_packet(
      the_sink, network::am::sink_event,
      encode(network::sink_event(network::roster{1, 0, 1, {{fan, 0}, {mote_id{11}, 0}}})),
      instant{41s});
  CHECK(published(roster, "devices.11.status") == "listed 41.000000");
  CHECK(pick<to_sink>(roster).empty());
}

TEST_CASE("a sink that was started again gets time to find its motes", "[gateway][GW-15]") {
  auto x = make_gateway();
  join(x, fan);
  join(x, mote_id{11});
  const auto started = deliver(x, network::sink_started{});
  CHECK(published(started, "devices.7.status") == "stale 0.000000");
  const auto empty = [&](std::uint16_t number, instant now) {
    return x.on_packet(the_sink, network::am::sink_event,
                       encode(network::sink_event(network::roster{number, 0, 1, {}})), now);
  };
  CHECK(pick<to_sink>(empty(1, instant{10s})).empty());
  const auto again = deliver(x, network::mote_joined{fan, 0, 301, {}});
  CHECK(published(again, "devices.7.status") == "listed 0.000000");
  CHECK(pick<to_sink>(empty(2, instant{59s})).size() == 1); // the fan has been back and is missing
  CHECK(pick<to_sink>(empty(3, instant{60s})).size() == 2);
}

TEST_CASE("motes hear which of their outputs somebody subscribes to", "[gateway][GW-10][IF-04]") {
  auto x = make_gateway();
  join(x, fan);
  const std::vector<std::string> keys{"devices.*.type", "devices.7.output.2"};
  x.on_subscribers(keys, {});
  const auto question = segment_down(x.on_time(instant{100ms}));
  CHECK(question.what == kind::hello);
  const auto request = segment_down(accept(x, fan, question));
  CHECK(request.am_type == network::am::outputs_wanted);
  CHECK(request.what == kind::reliable);
  CHECK(to_hex(request.payload) == "000200000000");
  static_cast<void>(accept(x, fan, request));
  CHECK(x.counters().requests == 1);

  x.on_period(fan, 2, "250", instant{1s});
  CHECK(to_hex(segment_down(x.on_time(instant{1100ms})).payload) == "0002000000fa");
  x.on_period(fan, 2, "fast", instant{2s});
  x.on_period(mote_id{9}, 2, "250", instant{2s});
  CHECK(x.counters().bad_periods == 1);
  CHECK(x.counters().undeliverable == 1);
}

TEST_CASE("a mote that has left is asked for no outputs", "[gateway][GW-10]") {
  auto x = make_gateway();
  join(x, fan);
  x.on_subscribers(std::vector<std::string>{"devices.7.output.2"}, {});
  static_cast<void>(deliver(x, network::mote_left{fan, network::leave_cause::notice}));
  CHECK(pick<to_sink>(x.on_time(instant{100ms})).empty());
  CHECK(x.counters().requests == 0);
}

TEST_CASE("a sink that asks hears the time of the peers", "[gateway][CLK-08]") {
  const auto ask = [](gateway::gateway& x, instant now) {
    return pick<answer_sink>(x.on_packet(the_sink, network::am::sink_event,
                                         encode(network::sink_event(network::time_request{7})),
                                         now));
  };
  auto x = make_gateway();
  CHECK(ask(x, instant(1s)).empty()); // its kernel has not set it
  static_cast<void>(x.on_clock(1000s, instant(1s)));
  const auto out = ask(x, instant(5s + 1us));
  REQUIRE(out.size() == 1);
  CHECK(out[0].answer == network::sink_event(network::time_answer{7, 1005s + 1us}));
  static_cast<void>(x.on_clock(1003s, instant(5s)));
  CHECK(ask(x, instant(6s)).at(0).answer == network::sink_event(network::time_answer{7, 1009s}));

  CHECK(deliver(x, network::time_answer{7, 1s}).empty());
  CHECK(x.counters().unknown_type == 1);

  gateway_config config;
  config.island = kitchen;
  config.incarnation = 1;
  gateway::gateway again(config, random_stream(1));
  static_cast<void>(again.start(instant(60s)));
  static_cast<void>(
      again.on_clock(1000s, instant(60s))); // the clock of a kernel that knows no other yet
  CHECK(ask(again, instant(69s)).empty());
  CHECK(ask(again, instant(70s)).size() == 1);
}

TEST_CASE("a gateway lists no more motes than a sink has room for", "[gateway][GW-03]") {
  gateway_config config;
  config.island = kitchen;
  config.devices_max = 2;
  gateway::gateway x(config, random_stream(1));
  static_cast<void>(x.start({}));
  for (const auto mote : {mote_id{2}, mote_id{3}, mote_id{4}, mote_id{2}})
    join(x, mote);
  CHECK(x.devices() == std::vector{mote_id{2}, mote_id{3}});
  CHECK(x.counters().devices_refused == 1);
}

TEST_CASE("of two descriptors of one life of a mote the sink says which is right", "[gateway]") {
  auto x = make_gateway();
  join(x, fan);
  const auto asks = [](const gateway::outputs& out) {
    return pick<to_sink>(out).size() == 1 && to_hex(pick<to_sink>(out)[0].payload) == "040007";
  };
  CHECK(asks(deliver(x, network::mote_joined{fan, 0, 301, bytes{0xbb}})));
  CHECK(asks(deliver(x, network::mote_joined{fan, 0, 301, bytes{0xaa}}))); // its answer
  CHECK_FALSE(asks(deliver(x, network::mote_joined{fan, 0, 301, bytes{0xaa}})));
}
