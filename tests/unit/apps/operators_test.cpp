// Programs over streams: average, switch, recorder; alone and one after the other (STR-22).
#include <algorithm>
#include <string>

#include "apps/average.hpp"
#include "apps/recorder.hpp"
#include "apps/streams/stream_reader.hpp"
#include "apps/streams/stream_switch.hpp"
#include "apps/streams/stream_writer.hpp"
#include "apps/tables.hpp"
#include "support/catch.hpp"
#include "support/programs.hpp"

using namespace rubicon;
using test::island_fixture;
using test::lone_layer;

namespace {

constexpr std::uint8_t command_type = 64;

mote_address at(std::uint16_t mote) {
  return {island_id{1}, mote_id{mote}};
}

double figure(const apps::application& x, std::string_view name) {
  for (const auto& each : x.figures()) {
    if (each.name == name)
      return each.value;
  }
  FAIL("no such figure");
  return 0;
}

/// Writes one value again and again.
class fixed_writer final : public apps::application {
public:
  fixed_writer(mote_address to, std::uint16_t name, std::int16_t first, std::uint32_t time_ms = 0)
      : value(first), to_(to), name_(name), time_ms_(time_ms) {}

  void openRemoteDone(int stream, std::uint16_t, communication::status success) override {
    is_opening_ = false;
    if (success == communication::SUCCESS)
      stream_ = stream;
  }
  void on_time(instant now) override {
    if (is_stopped_ || is_opening_ || now < next_ || !layer().address())
      return;
    next_ = now + 500ms;
    if (stream_ < 0) {
      is_opening_ = layer().open_write_end(to_, name_, 500, 0, 12) == communication::SUCCESS;
      return;
    }
    ++time_ms_;
    layer().write(stream_, encode(stream::sensor_record{*layer().address(), time_ms_, value}));
  }
  void stop() {
    layer().close(stream_);
    stream_ = -1;
    is_stopped_ = true;
  }

  std::int16_t value;

private:
  void on_start(instant) override {}

  mote_address to_;
  std::uint16_t name_;
  int stream_ = -1;
  bool is_opening_ = false;
  bool is_stopped_ = false;
  std::uint32_t time_ms_;
  instant next_;
};

/// An island of a sink and motes 2 to 6, all near each other, and the programs on them.
class hosts {
public:
  hosts() = default;
  explicit hosts(const device::transducer_config& transducer)
      : world({.width = 2, .height = 3, .transducers = {transducer}}) {}

  void start(std::uint16_t mote, apps::application& x) {
    x.start(world.at(mote_id{mote}).attach(x), world.own_time(mote_id{mote}));
    hosted_.emplace_back(mote, &x);
  }

  void run_for(duration length) {
    for (const auto end = world.now() + length; world.now() < end;) {
      world.run_for(20ms);
      for (auto& [mote, program] : hosted_)
        on(mote, [&, who = mote_id{mote}, x = program] { x->on_time(world.own_time(who)); });
    }
  }

  template <class Commands>
  void on(std::uint16_t mote, Commands commands) {
    act(world, mote_id{mote}, [&] {
      commands();
      return 0;
    });
  }

  island_fixture world{{.width = 2, .height = 3}};

private:
  std::vector<std::pair<std::uint16_t, apps::application*>> hosted_;
};

/// The value in the last of some lines; -1 without any.
int last_value(const std::string& lines) {
  return lines.empty() ? -1 : std::stoi(lines.substr(lines.rfind(',') + 1));
}

} // namespace

TEST_CASE("the average of three streams is a stream, at another mote or at its own",
          "[apps][STR-22][MCK-01]") {
  const auto reader_at = GENERATE(std::uint16_t{6}, std::uint16_t{5});
  hosts x;
  fixed_writer first(at(5), 1, 10);
  fixed_writer second(at(5), 2, 20);
  fixed_writer third(at(5), 3, 34);
  apps::average middle({{1, 2, 3}, 500ms, {{at(reader_at), 8}}});
  apps::recorder reader({{8}, 500ms, "x.csv"});
  x.start(2, first);
  x.start(3, second);
  x.start(4, third);
  x.start(5, middle);
  x.start(reader_at, reader);
  x.run_for(3min);
  const auto lines = reader.take_lines();
  CHECK(last_value(lines) == 21); // 21 1/3
  CHECK(std::ranges::count(lines, '\n') > 100);
  const auto last = lines.substr(lines.rfind('\n', lines.size() - 2) + 1);
  CHECK(last.find(",1,5,8,21\n") != std::string::npos);

  third.value = 36;
  x.run_for(5s);
  CHECK(last_value(reader.take_lines()) == 22);
  x.on(4, [&] { third.stop(); }); // a stream that has ended does not count
  x.run_for(20s);
  CHECK(last_value(reader.take_lines()) == 15);
  CHECK(figure(middle, "records written") > 300);
}

TEST_CASE("an average rounds to the nearest, halves up", "[apps][STR-22]") {
  const auto [a, b, wanted] = GENERATE(table<int, int, int>({{1, 2, 2},
                                                             {-1, -2, -1},
                                                             {-3, -2, -2},
                                                             {-4, -4, -4},
                                                             {32767, 32767, 32767},
                                                             {-32768, -32768, -32768},
                                                             {-1, 1, 0}}));
  hosts x;
  fixed_writer first(at(5), 1, static_cast<std::int16_t>(a));
  fixed_writer second(at(5), 2, static_cast<std::int16_t>(b));
  apps::average middle({{1, 2}, 500ms, {{at(5), 8}}});
  apps::recorder reader({{8}, 500ms, "x.csv"});
  x.start(2, first);
  x.start(3, second);
  x.start(5, middle);
  x.start(5, reader);
  x.run_for(3min);
  CHECK(last_value(reader.take_lines()) == wanted);
}

TEST_CASE("an average is as old as its newest value, also when milliseconds run over",
          "[apps][STR-22]") {
  hosts x;
  fixed_writer before(at(5), 1, 1, 4'294'000'000U);
  fixed_writer after(at(5), 2, 3);
  const bool is_first = GENERATE(true, false);
  apps::average middle(
      {{static_cast<std::uint16_t>(is_first ? 1 : 2), static_cast<std::uint16_t>(is_first ? 2 : 1)},
       500ms,
       {{at(5), 8}}});
  apps::recorder reader({{8}, 500ms, "x.csv"});
  x.start(2, before);
  x.start(3, after);
  x.start(5, middle);
  x.start(5, reader);
  x.run_for(3min);
  const auto lines = reader.take_lines();
  CHECK(last_value(lines) == 2);
  CHECK(lines.substr(lines.rfind('\n', lines.size() - 2) + 1).starts_with("4294967."));
}

TEST_CASE("a switch commands between two thresholds, and until it is obeyed",
          "[apps][DIS-02][MCK-09][MCK-10]") {
  const bool on_when_low = GENERATE(true, false);
  const int sign = on_when_low ? 1 : -1;
  const auto level = [&](int value) { return static_cast<std::int16_t>(sign * value); };
  hosts x;
  fixed_writer light(at(3), 1, level(300));
  apps::stream_switch program({1, 500ms, sign * 200.0, sign * 260.0, at(4), command_type});
  test::recorder lamp;
  x.start(2, light);
  x.start(3, program);
  lamp.layer = x.world.at(mote_id{4}).attach(lamp);
  REQUIRE(lamp.layer->provide(command_type) == communication::SUCCESS);
  const auto commands = [&] {
    std::string all;
    for (const auto& message : lamp.messages)
      all += message.octets == bytes{1} ? '1' : '0';
    return all;
  };
  x.run_for(3min);
  CHECK(commands() == "0"); // it is sent once where it begins
  light.value = level(230);
  x.run_for(5s);
  CHECK(commands() == "0");
  light.value = level(200);
  x.run_for(5s);
  CHECK(commands() == "01");
  light.value = level(259);
  x.run_for(5s);
  CHECK(commands() == "01");
  x.on(4, [&] { lamp.layer->hold(command_type); });
  light.value = level(260);
  x.run_for(10s);
  CHECK(commands() == "01");
  x.on(4, [&] { lamp.layer->release(command_type); });
  x.run_for(90s);
  CHECK(commands() == "010");
  CHECK(figure(program, "changes") == 3);
  CHECK(figure(program, "commands acknowledged") == 3);

  x.world.kill(mote_id{4});
  light.value = level(100);
  x.run_for(2min);
  CHECK(figure(program, "commands failed") > 0);
  CHECK(figure(program, "commands acknowledged") == 3);
  lamp.messages.clear();
  x.world.start(mote_id{4});
  lamp.layer = x.world.at(mote_id{4}).attach(lamp);
  REQUIRE(lamp.layer->provide(command_type) == communication::SUCCESS);
  x.run_for(3min);
  CHECK(commands() == "1");
}

TEST_CASE("the time of a recorder's lines goes on for longer than 32 bits of milliseconds",
          "[apps][STR-07]") {
  lone_layer x;
  apps::recorder reader({{5}, 0ms, "out.csv"});
  reader.start(x.core.attach(reader), x.now);
  join(x);
  REQUIRE(x.api().open_write_end({own_island, own_mote}, 5, 0, 0) == communication::SUCCESS);
  static_cast<void>(x.core.take_outputs());
  const auto line_at = [&](std::int64_t ms) {
    x.api().write(x.program.openings.at(0).descriptor,
                  encode(stream::sensor_record{at(9), static_cast<std::uint32_t>(ms), 1}));
    static_cast<void>(x.core.take_outputs());
    return reader.take_lines();
  };
  constexpr std::int64_t wrap = 1LL << 32;
  SECTION("beside those before") {
    CHECK(line_at(wrap - 2) == "4294967.294,1,9,5,1\n");
    CHECK(line_at(wrap + 3) == "4294967.299,1,9,5,1\n");
    CHECK(line_at(wrap - 1) == "4294967.295,1,9,5,1\n"); // was delayed
  }
  SECTION("by the time that the PC knows") {
    x.core.set_network_ahead(std::chrono::milliseconds(500 * wrap));
    CHECK(line_at(500 * wrap - 1) == "2147483647.999,1,9,5,1\n");
    CHECK(line_at(500 * wrap + 1) == "2147483648.001,1,9,5,1\n");
  }
}

TEST_CASE("a recorder writes lines, and no more than there is room for", "[apps][STR-07]") {
  lone_layer x;
  apps::recorder reader({{4, 5}, 0ms, "out.csv"});
  reader.start(x.core.attach(reader), x.now);
  CHECK(reader.file() == "out.csv");
  CHECK(reader.file_heading() == "time_s,island,mote,stream,value\n");
  join(x);
  REQUIRE(x.api().open_write_end({own_island, own_mote}, 5, 0, 0) == communication::SUCCESS);
  static_cast<void>(x.core.take_outputs());
  REQUIRE(x.program.openings.size() == 1);
  const auto writes = [&](const bytes& octets) {
    CHECK(x.api().write(x.program.openings[0].descriptor, octets) > 0);
    static_cast<void>(x.core.take_outputs());
  };
  writes(encode(stream::sensor_record{at(9), 1'234'005, -7}));
  writes(bytes{1, 2, 3}); // no sensor record
  writes(encode(stream::sensor_record{at(9), 7, 8}));
  CHECK(reader.take_lines() == "1234.005,1,9,5,-7\n0.007,1,9,5,8\n");
  CHECK(reader.take_lines().empty());
  for (std::size_t i = 0; i < apps::recorder::lines_max + 3; ++i)
    writes(encode(stream::sensor_record{at(9), 1, 1}));
  const auto lines = reader.take_lines();
  CHECK(std::ranges::count(lines, '\n') == static_cast<std::ptrdiff_t>(apps::recorder::lines_max));
  CHECK(figure(reader, "records dropped") == 3);
  writes(encode(stream::sensor_record{at(9), 1, 1}));
  CHECK(reader.take_lines() == "0.001,1,9,5,1\n");
}

TEST_CASE("tables are as large as the programs need, and never smaller than by default",
          "[apps][SMP-30]") {
  const communication::layer_config usual;
  auto tables = usual;
  apps::make_room(tables, {apps::stream_switch_config{}});
  CHECK(tables.streams.streams_max == usual.streams.streams_max);
  CHECK(tables.synaptic.channels_max == usual.synaptic.channels_max);
  CHECK(tables.tunnels.tunnels_max == usual.tunnels.tunnels_max);

  apps::reservoir_config units;
  units.transducers = {device::quantity::light};
  units.from = {{at(2), 3}, {at(3), 12}, {at(4), 1}};
  units.to = {{at(2), 3}};
  apps::average_config middle{{1, 2, 3, 4}, 1s, {{at(5), 8}}};
  apps::make_room(tables, {units, middle, apps::stream_writer_config{}});
  CHECK(tables.streams.streams_max == 8);
  CHECK(tables.synaptic.channels_max == 3);
  CHECK(tables.synaptic.size_max == 12);
  CHECK(tables.tunnels.tunnels_max == 12);
}

TEST_CASE("two writers of one transducer at one period both send", "[apps][STR-07][MCK-03]") {
  hosts x({.kind = device::quantity::light, .model = device::constant_model{5}});
  apps::stream_writer one({device::quantity::light, 500ms, at(5), 1});
  apps::stream_writer other({device::quantity::light, 500ms, at(6), 2});
  apps::stream_reader at_five({1, 500ms});
  apps::stream_reader at_six({2, 500ms});
  x.start(2, one);
  x.start(2, other);
  x.start(5, at_five);
  x.start(6, at_six);
  x.run_for(3min);
  CHECK(figure(at_five, "records") > 100);
  CHECK(figure(at_six, "records") > 100);
}

TEST_CASE("a writer that gets no sensor stream says so, and has it later",
          "[apps][MCK-03][STR-20]") {
  hosts x({.kind = device::quantity::light, .model = device::constant_model{5}});
  apps::stream_writer writer({device::quantity::light, 500ms, at(5), 1});
  apps::stream_reader reader({1, 500ms});
  test::recorder greedy;
  greedy.layer = x.world.at(mote_id{2}).attach(greedy);
  std::vector<int> taken;
  x.on(2, [&] {
    for (int i = 0; i < 4; ++i)
      taken.push_back(greedy.layer->open_local());
  });
  REQUIRE(taken.back() > 0); // one of five is left: the remote stream takes it, the sensor's fails
  x.start(2, writer);
  x.start(5, reader);
  x.run_for(90s);
  CHECK(figure(writer, "records written") == 0);
  CHECK(figure(writer, "opens failed") > 0);
  x.on(2, [&] { greedy.layer->close(taken.back()); });
  x.run_for(1min);
  CHECK(figure(writer, "records written") > 50);
  CHECK(figure(reader, "records") > 50);
}

TEST_CASE("what an island's motes carry follows from their programs", "[apps][SMP-30][STR-20]") {
  constexpr island_id here{1};
  CHECK(apps::vector_load(10) == apps::load{1, 46});
  CHECK(apps::vector_load(25) == apps::load{1, 106});
  CHECK(apps::vector_load(26) == apps::load{2, 116});
  CHECK(apps::vector_load(64) == apps::load{3, 274});

  apps::reservoir_config units;
  units.from = {{at(2), 12}, {{here, no_mote}, 64}};
  units.to = {{at(3), 64}, {{island_id{2}, mote_id{9}}, 10}};
  const auto own = apps::traffic_of(
      here, {units, apps::stream_writer_config{.to = at(5)},
             apps::stream_writer_config{.to = {island_id{30}, no_mote}, .stream = 2},
             apps::average_config{{7, 8}, 1s, {{at(4), 3}, {{here, no_mote}, 4}}}});
  CHECK(own.channels == 3); // units, writer, average
  CHECK(own.streams_in == 2);
  CHECK(own.synapses_in == 2);
  CHECK(own.vectors == apps::load{3, 274});
  CHECK(own.vectors_in == apps::load{1, 54});
  CHECK(own.longest == apps::load{3, 274});
  CHECK(own.up == apps::load{1, 62});
  CHECK(own.down == apps::load{6, 322});
}

TEST_CASE("a mote that a file asks little of has the usual tables", "[apps][SMP-30]") {
  const network::router_config usual;
  apps::reservoir_config two;
  two.to = {{at(3), 10}, {at(4), 10}};
  two.from = two.to;
  const auto own = apps::traffic_of(island_id{1}, {two});
  auto of_island = own;
  of_island += own;
  auto tables = usual;
  apps::make_room(tables, own, of_island);
  CHECK(tables.paths.entries_max == usual.paths.entries_max);
  CHECK(tables.paths.queue_max == usual.paths.queue_max);
  CHECK(tables.paths.octets_max == usual.paths.octets_max);
  CHECK(tables.packets.queue_max == usual.packets.queue_max);
  CHECK(tables.packets.octets_max == usual.packets.octets_max);
  CHECK(tables.questions_max == usual.questions_max);
}

TEST_CASE("tables of channels grow with what the island has, up to a bound for those of others",
          "[apps][SMP-30][STR-20]") {
  apps::traffic reader;
  reader.streams_in = 20;
  apps::traffic of_island = reader;
  of_island.channels = 20;
  network::router_config tables;
  apps::make_room(tables, reader, of_island);
  CHECK(tables.paths.entries_max == 30);
  of_island.channels = 500;
  apps::make_room(tables, reader, of_island);
  CHECK(tables.paths.entries_max == 20 + apps::passing_channels_max);

  apps::traffic sender; // of 32 vectors of 16 elements, while others send some of 64
  for (int i = 0; i < 32; ++i)
    sender.vectors += apps::vector_load(16);
  of_island.longest = apps::vector_load(64);
  apps::make_room(tables, sender, of_island);
  CHECK(tables.paths.queue_max == 4 * 3 + 32 - 2 * 3 + 32 / 4);
  CHECK(tables.paths.octets_max == 4 * 274 + 32 * 70 - 2 * 274 + 32 * 70 / 4);
}
