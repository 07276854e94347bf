// The Mockup interface on motes: streams, synaptic channels, clock (D1.1 5.3.1, 5.3.2).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "network/am.hpp"
#include "stream/sensor_record.hpp"
#include "support/catch.hpp"
#include "support/mote_ids.hpp"
#include "support/programs.hpp"

using namespace rubicon;
using communication::FAIL;
using communication::SUCCESS;
using test::act;
using test::count;
using test::id;
using test::island_fixture;
using test::lone_layer;
using test::recorder;

TEST_CASE("a local stream joins two programs; bad calls fail",
          "[communication][MCK-04][MCK-05][MCK-06]"
          "[MCK-07][MCK-08][STR-03][STR-10]") {
  lone_layer x;
  const auto local = x.api().open_local();
  REQUIRE(local > 0);
  for (std::uint8_t i = 1; i <= 7; ++i)
    CHECK(x.api().write(local, bytes(4, i)) == 4);
  CHECK(x.api().read(local, 0) == FAIL);
  for (int i = 0; i < 6; ++i) {
    CHECK(x.api().read(local, 3) == SUCCESS);
    static_cast<void>(x.core.take_outputs());
  }
  CHECK(x.api().read(local, 3) == FAIL); // one is pending
  REQUIRE(x.program.readings.size() == 5);
  for (std::uint8_t i = 0; i < 5; ++i)
    CHECK(x.program.readings[i].record == bytes(3, static_cast<std::uint8_t>(i + 3)));
  CHECK(x.api().close(local) == SUCCESS);
  static_cast<void>(x.core.take_outputs());
  REQUIRE(x.program.readings.size() == 6);
  CHECK_FALSE(x.program.readings[5].success);
  CHECK(x.api().close(local) == FAIL);
  for (const int bad : {local, 0, -1, 32768, 65536 + local}) {
    CHECK(x.api().close(bad) == FAIL);
    CHECK(x.api().read(bad, 1) == FAIL);
    CHECK(x.api().write(bad, bytes{1}) == -1);
    CHECK(x.api().dispose_syn_channel(bad) == FAIL);
    CHECK(x.api().start_syn_channel(bad) == FAIL);
    CHECK(x.api().stop_syn_channel(bad) == FAIL);
    CHECK(x.api().write_output(bad, 0, 1) == FAIL);
    CHECK(std::isnan(x.api().read_input(bad, 0)));
  }
}

TEST_CASE("tables are bounded, and free again after a close",
          "[communication][MCK-01][MCK-04][SYN-01]"
          "[SYN-03][SYN-05][STR-20]") {
  lone_layer x;
  join(x);
  std::vector<int> streams;
  for (int i = 0; i < 5; ++i)
    streams.push_back(x.api().open_local());
  CHECK(std::set(streams.begin(), streams.end()).size() == 5);
  CHECK(x.api().open_local() == -1);
  CHECK(x.api().open_remote(3, 8, 1, 0, 0) == FAIL);
  CHECK(x.api().close(streams[3]) == SUCCESS);
  CHECK(x.api().open_remote(3, 8, 1, 0, 0) == SUCCESS);

  const synaptic::parameters params;
  std::vector<int> outs;
  for (std::uint16_t i = 0; i < 2; ++i)
    outs.push_back(x.api().create_syn_channel_out({own_island, id(10 + i)}, 3, params));
  CHECK(std::set(outs.begin(), outs.end()).size() == 2);
  CHECK(x.api().create_syn_channel_out({own_island, id(20)}, 3, params) == -1);
  CHECK(x.api().create_syn_channel_in({own_island, id(20)}, 3, params) > 0); // in each direction
  CHECK(x.api().dispose_syn_channel(outs[1]) == SUCCESS);
  CHECK(x.api().dispose_syn_channel(outs[1]) == FAIL);
  CHECK(x.api().create_syn_channel_out({own_island, id(20)}, 0, params) == -1);
  CHECK(x.api().create_syn_channel_out({own_island, id(20)}, 11, params) == -1);
  CHECK(x.api().create_syn_channel_out({own_island, broadcast_mote}, 3, params) == -1);
  CHECK(x.api().create_syn_channel_out({own_island, id(20)}, 10, params) > 0);
}

TEST_CASE("a remote stream is not opened towards nowhere or twice",
          "[communication][MCK-01][MCK-02]") {
  lone_layer x;
  join(x);
  CHECK(x.api().open_remote(0, 8, 1, 0, 0) == FAIL);
  CHECK(x.api().open_remote(3, broadcast_mote.value, 1, 0, 0) == FAIL);
  CHECK(x.api().open_remote(3, 8, 1, 86'400'001, 0) == FAIL);
  CHECK(x.api().open_remote(3, 8, 1, 0, 0, 0) == FAIL);
  CHECK(x.api().open_remote(3, 8, 1, 0, 0, 106) == FAIL);
  CHECK(x.core.take_outputs().empty());
  CHECK(x.api().open_remote(3, 8, 1, 500, 0, 105) == SUCCESS);
  const auto wanted = x.core.take_outputs();
  REQUIRE(wanted.size() == 1);
  const auto& channel = std::get<communication::channel_wanted>(wanted[0]);
  CHECK(channel.destination == mote_id{8});
  CHECK(channel.interval == 500ms);
  CHECK(x.api().open_remote(3, 8, 1, 500, 0) == FAIL);
  CHECK(x.api().open_remote(3, 8, 2, 500, 0) == SUCCESS);
  x.core.channels().on_connect_failed(channel.request, x.now);
  static_cast<void>(x.core.take_outputs());
  REQUIRE(x.program.openings.size() == 1);
  CHECK(x.program.openings[0].name == 1);
  CHECK_FALSE(x.program.openings[0].success);
  CHECK(x.api().open_remote(3, 8, 1, 500, 0) == SUCCESS);
}

TEST_CASE("accepted channels that carry nothing are bounded", "[communication][STR-19]") {
  lone_layer x;
  join(x);
  for (std::uint32_t i = 1; i <= 6; ++i)
    x.core.channels().on_accepted(stream::channel_handle(i), {island_id{3}, mote_id{8}}, x.now);
  const auto given_up = x.core.take_outputs();
  REQUIRE(given_up.size() == 2);
  CHECK(std::get<communication::channel_unwanted>(given_up[0]).channel ==
        stream::channel_handle(1));
  CHECK(x.core.counters().unclaimed == 2);
  x.core.channels().on_octets(stream::channel_handle(1), bytes{1, 2}, x.now); // late
  CHECK(x.core.take_outputs().empty());
}

TEST_CASE("a sensor stream needs its transducer", "[communication][MCK-03][STR-06][STR-07][STR-08]"
                                                  "[STR-09]") {
  recorder program;
  device::transducer_config light;
  light.kind = device::quantity::light;
  light.model = device::constant_model{12.5};
  island_fixture x({.width = 2, .transducers = {light}});
  settle(x, 1);
  program.layer = x.at(id(2)).attach(program);
  auto& api = *program.layer;
  const auto open = [&](device::quantity what, std::uint32_t rate, stream::sampling kind) {
    return act(x, id(2),
               [&] { return api.open_sensor(static_cast<std::uint8_t>(what), rate, kind); });
  };
  CHECK(open(device::quantity::sound, 100, stream::sampling::periodic) == -1);
  CHECK(open(device::quantity{32}, 100, stream::sampling::periodic) == -1);
  CHECK(open(device::quantity::light, 0, stream::sampling::periodic) == -1);
  CHECK(open(device::quantity::light, 86'400'001, stream::sampling::periodic) == -1);
  const auto on_demand = open(device::quantity::light, 0, stream::sampling::on_demand);
  REQUIRE(on_demand > 0);
  CHECK(act(x, id(2), [&] { return api.write(on_demand, bytes{1}); }) == -1);
  CHECK(program.readings.empty());
  CHECK(act(x, id(2), [&] { return api.read(on_demand, 256); }) == SUCCESS);
  REQUIRE(program.readings.size() == 1);
  const auto record = stream::decode_sensor_record(program.readings[0].record);
  REQUIRE(record);
  CHECK(record->source == mote_address{island_id{1}, id(2)});
  CHECK(record->value == 125);

  program.readings.clear();
  program.reads_all = true;
  const auto periodic = open(device::quantity::light, 100, stream::sampling::periodic);
  REQUIRE(periodic > 0);
  CHECK(act(x, id(2), [&] { return api.read(periodic, 256); }) == SUCCESS);
  x.run_for(10'050ms);
  REQUIRE(program.readings.size() == 100);
  const auto first = stream::decode_sensor_record(program.readings[0].record);
  for (std::size_t i = 1; i < 100; ++i) {
    const auto next = stream::decode_sensor_record(program.readings[i].record);
    const auto wanted = first->time_ms + 100 * i;
    CHECK(next->time_ms <= wanted + 2); // corrections of the island's time
    CHECK(next->time_ms + 2 >= wanted);
  }
}

TEST_CASE("records taken before the join leave with the island that the mote has joined",
          "[communication][STR-07][MCK-03]") {
  auto config = lone_layer::config();
  config.transducer_mask = 1U << static_cast<unsigned>(device::quantity::light);
  recorder program;
  communication::layer core(config, random_stream(1));
  program.layer = core.attach(program);
  auto& api = *program.layer;
  const instant now;
  core.on_initialised(true, now);
  const auto stream = api.open_sensor(static_cast<std::uint8_t>(device::quantity::light), 100,
                                      stream::sampling::periodic);
  REQUIRE(stream > 0);
  const auto sample = [&](island_id island, std::int16_t value) {
    const auto at = *core.deadline();
    core.on_time(at);
    const auto wanted = core.take_outputs();
    REQUIRE(count<communication::sample_wanted>(wanted) == 1);
    core.devices().on_sample(std::get<communication::sample_wanted>(wanted[0]).stream,
                             {{island, mote_id{7}}, 1000, value}, at);
  };
  const auto read = [&](std::size_t octets) {
    REQUIRE(api.read(stream, octets) == SUCCESS);
    static_cast<void>(core.take_outputs());
    return program.readings.back().record;
  };
  for (std::int16_t i = 1; i <= 3; ++i)
    sample(island_id{}, i);
  CHECK(stream::decode_sensor_record(read(256))->source == mote_address{island_id{}, mote_id{7}});
  core.on_joined(island_id{3}, now);
  sample(island_id{3}, 4);
  const auto second = stream::decode_sensor_record(read(256));
  REQUIRE(second);
  CHECK(*second == stream::sensor_record{{island_id{3}, mote_id{7}}, 1000, 2});
  CHECK(read(5) == bytes{0, 0, 0, 3, 0}); // as much as was asked for
  CHECK(stream::decode_sensor_record(read(256))->value == 4);

  const auto local = api.open_local(); // what programs write is theirs
  CHECK(api.write(local, bytes(12, 0)) == 12);
  REQUIRE(api.read(local, 12) == SUCCESS);
  static_cast<void>(core.take_outputs());
  CHECK(program.readings.back().record == bytes(12, 0));
}

TEST_CASE("a stream may begin and end at the same mote", "[communication][MCK-01][STR-11]") {
  lone_layer x;
  const mote_address self{own_island, own_mote};
  CHECK(x.api().open_write_end(self, 5, 0, 0) == FAIL); // not joined
  join(x);
  CHECK(x.api().open_write_end({island_id{}, id(7)}, 5, 0, 0) == FAIL);
  CHECK(x.api().open_write_end(self, 5, 86'400'001, 0) == FAIL);
  REQUIRE(x.api().open_write_end(self, 5, 0, 0) == SUCCESS);
  REQUIRE(x.api().open_remote(255, own_mote.value, 5, 0, 0) == SUCCESS);
  static_cast<void>(x.core.take_outputs());
  REQUIRE(x.program.openings.size() == 2);
  CHECK(x.api().write(x.program.openings[0].descriptor, bytes{1, 2}) == 2);
  CHECK(x.api().read(x.program.openings[1].descriptor, 8) == SUCCESS);
  CHECK(x.core.take_outputs().empty());
  REQUIRE(x.program.readings.size() == 1);
  CHECK(x.program.readings[0].record == bytes{1, 2});
}

TEST_CASE("all motes of an island see the same tick at the same time",
          "[communication][SYN-11][CLK-02]") {
  std::array<recorder, 5> programs;
  island_fixture x({.width = 6, .delivery = 0.95});
  settle(x, 5);
  using seen = std::map<std::uint32_t, std::vector<instant>>;
  seen ticks;
  for (int i = 0; i < 5; ++i) {
    auto& each = programs[static_cast<std::size_t>(i)];
    each.layer = x.at(id(i + 2)).attach(each);
    each.on_tick = [&](std::uint32_t tick) { ticks[tick].push_back(x.now()); };
  }
  x.run_for(60s);
  CHECK(ticks.size() >= 120);
  CHECK(ticks.size() <= 122);
  auto last = ticks.begin()->first - 1;
  int whole = 0;
  for (const auto& [tick, times] : ticks) {
    CHECK(tick == last + 1);
    last = tick;
    whole += times.size() == 5 ? 1 : 0;
    const auto [low, high] = std::ranges::minmax(times);
    CHECK(high - low < 5ms);
  }
  CHECK(whole >= 119); // at either end not all may have ticked yet
}

TEST_CASE("while vectors are sent, everybody else's frames keep out of their slots",
          "[communication][SYN-16]") {
  std::array<recorder, 2> programs;
  island_fixture x({.width = 5});
  settle(x, 4);
  const auto everybody_knows = [&x](bool used) {
    bool all = (x.root().packets().router().clock().slots_used() == 1) == used;
    for (int i = 2; i <= 5; ++i)
      all = all && (x.at(id(i)).packets().router().clock().slots_used() == 1) == used;
    return all;
  };
  CHECK(everybody_knows(false));
  const synaptic::parameters params;
  for (auto i : {0, 1}) // from mote 4 to mote 5: sink, 2 and 3 have no part in it
    programs[static_cast<std::size_t>(i)].layer =
        x.at(id(i + 4)).attach(programs[static_cast<std::size_t>(i)]);
  const auto out = act(x, id(4), [&] {
    return programs[0].layer->create_syn_channel_out({own_island, id(5)}, 3, params);
  });
  const auto in = act(x, id(5), [&] {
    return programs[1].layer->create_syn_channel_in({own_island, id(4)}, 3, params);
  });
  REQUIRE(in > 0);
  REQUIRE(x.run_until([&] { return !programs[0].outs.empty(); }, 1min));
  REQUIRE(act(x, id(4), [&] { return programs[0].layer->start_syn_channel(out); }) == SUCCESS);
  REQUIRE(x.run_until([&] { return everybody_knows(true); }, 10s));

  int vectors = 0;
  int others = 0;
  x.on_air = [&](mote_id from, const network::frame_out& frame) {
    (frame.in_slot ? vectors : others) += 1;
    const auto& clock = x.root().packets().router().clock();
    const auto into = clock.at(x.own_time(island_fixture::sink_id)).time_since_epoch() %
                      std::chrono::milliseconds(500);
    CAPTURE(from.value, into.count());
    CHECK((into >= std::chrono::milliseconds(57)) != frame.in_slot); // a seventh is theirs
    CHECK(into < std::chrono::milliseconds(481));                    // clocks differ a little
  };
  const auto missed = programs[1].missed;
  x.run_for(3min);
  CHECK(std::abs(vectors - 360) <= 1);
  CHECK(others > 50);
  CHECK(programs[1].missed == missed);
  x.on_air = {};

  REQUIRE(act(x, id(4), [&] { return programs[0].layer->stop_syn_channel(out); }) == SUCCESS);
  CHECK(x.run_until([&] { return everybody_knows(false); }, 3min));
  CHECK(x.root().members() == 4);
}

TEST_CASE("a mote's slot holds all its vectors of a tick, one after the other",
          "[communication][SYN-16]") {
  std::array<recorder, 3> programs;
  island_fixture x({.width = 5});
  settle(x, 4);
  for (auto i : {0, 1, 2}) // from mote 4 to both of its neighbours
    programs[static_cast<std::size_t>(i)].layer =
        x.at(id(i + 3)).attach(programs[static_cast<std::size_t>(i)]);
  std::array<int, 2> outs{};
  for (auto i : {0, 1}) {
    const auto reader = 3 + 2 * i;
    outs[static_cast<std::size_t>(i)] = act(x, id(4), [&] {
      return programs[1].layer->create_syn_channel_out({own_island, id(reader)}, 3, {});
    });
    static_cast<void>(act(x, id(reader), [&] {
      return programs[2 * static_cast<std::size_t>(i)].layer->create_syn_channel_in(
          {own_island, id(4)}, 3, {});
    }));
  }
  REQUIRE(x.run_until([&] { return programs[1].outs.size() == 2; }, 1min));
  for (const auto out : outs)
    REQUIRE(act(x, id(4), [&] { return programs[1].layer->start_syn_channel(out); }) == SUCCESS);
  x.run_for(10s);
  CHECK(x.root().packets().router().clock().slots_used() == 1);

  int in_slot = 0;
  int later = 0;
  x.on_air = [&](mote_id from, const network::frame_out& frame) {
    if (from == id(4) && frame.am_type == network::am::channel)
      ++(frame.in_slot ? in_slot : later);
  };
  for (auto* const reader : {&programs[0], &programs[2]})
    reader->missed = 0;
  x.run_for(1min);
  CHECK(std::abs(in_slot - 240) <= 2);
  CHECK(later == 0);
  CHECK(programs[0].missed == 0);
  CHECK(programs[2].missed == 0);
}

TEST_CASE("a mote joins while vectors are sent", "[communication][DIS-08][SYN-16]") {
  std::array<recorder, 2> programs;
  island_fixture x({.width = 4});
  settle(x, 3);
  const synaptic::parameters params;
  for (auto i : {0, 1})
    programs[static_cast<std::size_t>(i)].layer =
        x.at(id(i + 2)).attach(programs[static_cast<std::size_t>(i)]);
  const auto out = act(x, id(2), [&] {
    return programs[0].layer->create_syn_channel_out({own_island, id(3)}, 3, params);
  });
  static_cast<void>(act(x, id(3), [&] {
    return programs[1].layer->create_syn_channel_in({own_island, id(2)}, 3, params);
  }));
  REQUIRE(x.run_until([&] { return !programs[0].outs.empty(); }, 1min));
  REQUIRE(act(x, id(2), [&] { return programs[0].layer->start_syn_channel(out); }) == SUCCESS);
  x.run_for(10s);
  CHECK(x.root().packets().router().clock().slots_used() == 1);
  x.kill(id(4));
  x.run_for(30s);
  CHECK(x.root().members() == 2);
  x.start(id(4));
  CHECK(x.run_until([&] { return x.root().members() == 3; }, 30s));
  x.run_for(1min);
  CHECK(x.root().members() == 3);
}

TEST_CASE("a latency that the route cannot promise is not granted",
          "[communication][MCK-01][SYN-13][IF-05]") {
  struct row {
    std::uint8_t level;
    bool granted;
  };
  const auto [level, granted] = GENERATE(row{0, true}, row{1, false}, row{6, false}, row{7, true});
  const bool is_synaptic = GENERATE(false, true);
  CAPTURE(level, is_synaptic);
  const auto qos = static_cast<std::uint8_t>(level << 4U);
  lone_layer x;
  join(x);
  if (is_synaptic)
    CHECK(x.api().create_syn_channel_out({own_island, id(8)}, 3, {.qos = qos}) > 0);
  else
    CHECK(x.api().open_remote(3, 8, 1, 500, qos) == SUCCESS);
  const auto wanted = x.core.take_outputs();
  REQUIRE(count<communication::channel_wanted>(wanted) == 1);
  const auto request = std::get<communication::channel_wanted>(wanted[0]).request;
  const stream::channel_handle channel(5);
  x.core.channels().set_latency_bound(channel, 4s); // class 6 is 3.2 s, class 7 is 6.4 s
  x.core.channels().on_connected(request, channel, x.now);
  const auto next = x.core.take_outputs();
  CHECK(count<communication::channel_unwanted>(next) == (granted ? 0 : 1));
  CHECK(count<communication::channel_packet>(next) == (granted ? 1 : 0)); // it goes on
  CHECK(x.core.counters().too_slow == (granted ? 0 : 1));
  const auto refused = is_synaptic ? x.program.outs.size() : x.program.openings.size();
  CHECK(refused == (granted ? 0 : 1));
}
