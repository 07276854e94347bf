// Samplers, actuators, messengers and listeners, each alone on the layer of a mote.
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/actuator.hpp"
#include "apps/listener.hpp"
#include "apps/messenger.hpp"
#include "apps/sampler.hpp"
#include "communication/layer.hpp"
#include "support/catch.hpp"
#include "support/segments.hpp"
#include "transport/segment.hpp"

using namespace rubicon;
using device::quantity;
using transport::segment;

namespace {

constexpr island_id kitchen{5};
constexpr mote_id stove{2};
constexpr mote_address gateway{kitchen, no_mote};

struct sent_segment {
  instant when;
  mote_address to;
  segment what;
};

class fixture {
public:
  explicit fixture(std::unique_ptr<apps::application> x) : app(std::move(x)) {
    app->start(core.attach(*app), now);
    settle();
  }

  void run_for(duration length) {
    const auto end = now + length;
    for (auto due = next(); due && *due <= end; due = next()) {
      now = std::max(now, *due);
      core.set_time(now);
      app->on_time(now);
      core.on_time(now);
      settle();
    }
    now = end;
  }

  void join() {
    core.on_joined(kitchen, now);
    settle();
  }
  void lose() {
    core.on_left(now);
    settle();
  }
  /// The gateway wants these.
  void ask(std::vector<communication::output_wanted> all) {
    app->outputsWanted(all);
    settle();
  }
  void hear(mote_address from, std::uint8_t am_type, bytes octets) {
    app->receiveFrom(from, octets, am_type);
    settle();
  }

  /// Carries out what the layer wants; its receiver takes each greeting.
  void settle() {
    for (auto todo = core.take_outputs(); !todo.empty(); todo = core.take_outputs())
      for (auto& x : todo)
        take(x);
  }

  std::set<duration> gaps() const {
    std::set<duration> all;
    for (std::size_t i = 1; i < readings.size(); ++i)
      all.insert(readings[i] - readings[i - 1]);
    return all;
  }

  std::size_t readings_in_a_minute() {
    readings.clear();
    run_for(1min);
    return readings.size();
  }

  instant now;
  std::unique_ptr<apps::application> app;
  std::vector<std::int16_t> counts{7};
  std::uint32_t time_ms = 0;
  std::vector<instant> readings;
  std::vector<quantity> kinds; ///< of the last
  std::vector<communication::actuator_wanted> moves;
  std::vector<sent_segment> sent; ///< but greetings
  std::size_t packets = 0;        ///< with greetings
  bool accepts = true;

private:
  [[nodiscard]] std::optional<instant> next() const {
    return earliest(app->deadline(), core.deadline());
  }

  void take(communication::layer_output& x) {
    if (const auto* wanted = std::get_if<communication::transducers_wanted>(&x)) {
      readings.push_back(now);
      kinds = wanted->kinds;
      core.devices().on_transducers(wanted->process, counts, time_ms, now);
    } else if (const auto* move = std::get_if<communication::actuator_wanted>(&x)) {
      moves.push_back(*move);
    } else if (const auto* packet = std::get_if<transport::to_network>(&x)) {
      const auto what = transport::decode_segment(packet->segment);
      ++packets;
      REQUIRE(what);
      if (what->what != segment::kind::hello)
        sent.push_back({now, packet->destination, *what});
      const bool is_asked =
          what->what == segment::kind::hello || what->what == segment::kind::reliable;
      if (is_asked && accepts)
        core.on_packet(packet->destination.island, packet->channel,
                       encode(test::acknowledgement(packet->destination.mote, *what)), now);
    }
  }

  communication::layer core{[] {
                              communication::layer_config x;
                              x.self = stove;
                              x.transducer_mask = 0xff;
                              return x;
                            }(),
                            random_stream(1)};
};

std::unique_ptr<apps::application> sampler(apps::sampler_config x, std::uint64_t seed = 1) {
  return std::make_unique<apps::sampler>(std::make_shared<const apps::sampler_config>(std::move(x)),
                                         random_stream(seed));
}

} // namespace

TEST_CASE("a sampler reads every period from a random phase on", "[apps]") {
  std::set<duration> phases;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    fixture x(sampler({{quantity::temperature, quantity::light}, 10s}, seed));
    CHECK(x.readings_in_a_minute() == 0); // not joined yet
    x.join();
    REQUIRE(x.readings_in_a_minute() == 6);
    phases.insert(x.readings[0] - instant(1min));
    CHECK(x.readings[0] < instant(70s));
    CHECK(x.gaps() == std::set<duration>{10s});
    CHECK(x.kinds == std::vector{quantity::temperature, quantity::light});
  }
  CHECK(phases.size() == 10);
}

TEST_CASE("a sampler's jitter delays readings and never adds up", "[apps]") {
  fixture x(sampler({{quantity::temperature}, 10s, 2s}));
  x.join();
  x.run_for(1000s);
  REQUIRE(x.readings.size() >= 99);
  std::set<duration> late;
  for (std::size_t i = 1; i < x.readings.size(); ++i)
    late.insert(x.readings[i] - x.readings[0] - static_cast<int>(i) * 10s);
  CHECK(*late.begin() >= 0s);
  CHECK(*late.rbegin() < 2s);
  CHECK(late.size() > 50);
}

TEST_CASE("a sampler sends its counts in network byte order to the gateway", "[apps]") {
  const bool reliable = GENERATE(false, true);
  apps::sampler_config config{{quantity::temperature}, 10s, 0s, 6, reliable};
  config.stamped = false;
  fixture x(sampler(config));
  x.counts = {0x0102, -2};
  x.join();
  x.run_for(20s);
  REQUIRE(x.sent.size() == 2);
  CHECK(x.sent[0].to == gateway);
  CHECK(x.sent[0].what.am_type == 6);
  CHECK(x.sent[0].what.payload == bytes{0x01, 0x02, 0xff, 0xfe});
  CHECK((x.sent[0].what.what == segment::kind::reliable) == reliable);
  CHECK(x.sent[0].when == x.readings[0]);
}

TEST_CASE("a sampler says when it has measured, unless it is not to", "[apps][IF-06]") {
  apps::sampler_config config{{quantity::temperature}, 10s};
  fixture x(sampler(config));
  x.counts = {0x0102};
  x.time_ms = 0x03040506;
  x.join();
  x.run_for(10s);
  REQUIRE(x.sent.size() == 1);
  CHECK(x.sent[0].what.payload == bytes{0x01, 0x02, 0x03, 0x04, 0x05, 0x06});

  config.stamped = false;
  fixture other(sampler(config));
  other.counts = {0x0102};
  other.join();
  other.run_for(10s);
  REQUIRE(other.sent.size() == 1);
  CHECK(other.sent[0].what.payload == bytes{0x01, 0x02});
}

TEST_CASE("a sampler averages the counts that it is to", "[apps][PXY-17]") {
  apps::sampler_config config{{quantity::temperature, quantity::light}, 10s};
  config.mean_of = {2, 1};
  config.stamped = false;
  fixture x(sampler(config));
  x.join();
  for (const auto count : std::vector<std::int16_t>{10, 20, -41}) {
    x.counts = {count, count};
    x.run_for(10s);
  }
  REQUIRE(x.sent.size() == 3);
  CHECK(x.sent[0].what.payload == bytes{0x00, 0x0a, 0x00, 0x0a});
  CHECK(x.sent[1].what.payload == bytes{0x00, 0x0f, 0x00, 0x14});
  CHECK(x.sent[2].what.payload == bytes{0xff, 0xf5, 0xff, 0xd7}); // -10.5 and -41
}

TEST_CASE(
    "a sampler with a dead band sends what has changed by so much, and is never quiet for long",
    "[apps]") {
  apps::sampler_config config{{quantity::temperature, quantity::light}, 10s};
  config.dead_band = {5, 0}; // light decides nothing
  config.stamped = false;
  config.silence_max = 1min;
  fixture x(sampler(config));
  x.join();
  const auto messages_after = [&x](std::int16_t temperature, std::int16_t light) {
    x.counts = {temperature, light};
    const auto before = x.sent.size();
    x.run_for(10s);
    return x.sent.size() - before;
  };
  CHECK(messages_after(200, 10) == 1); // the first
  CHECK(messages_after(204, 10) == 0);
  CHECK(messages_after(196, 999) == 0); // near what was sent, though not what was read before
  CHECK(messages_after(195, 10) == 1);
  CHECK(x.sent.back().what.payload == bytes{0x00, 0xc3, 0x00, 0x0a});
  CHECK(messages_after(200, 10) == 1);
  const auto sent_before = x.sent.size();
  x.run_for(10min);
  REQUIRE(x.sent.size() == sent_before + 10);
  for (auto i = sent_before; i < x.sent.size(); ++i)
    CHECK(x.sent[i].when - x.sent[i - 1].when == 1min);
  CHECK(x.readings.size() == 65);
}

TEST_CASE("a dead band that the period does not divide is quiet for less, not for longer",
          "[apps]") {
  apps::sampler_config config{{quantity::temperature}, 10s, 2s};
  config.dead_band = {5};
  config.silence_max = 35s;
  fixture x(sampler(config));
  x.counts = {200};
  x.join();
  x.run_for(10min);
  REQUIRE(x.sent.size() > 17);
  for (std::size_t i = 1; i < x.sent.size(); ++i)
    CHECK(x.sent[i].when - x.sent[i - 1].when <= 35s);
}

TEST_CASE("a sampler with a dead band tells its value to who has just asked for it",
          "[apps][IF-04]") {
  apps::sampler_config config{{quantity::temperature}, 10s};
  config.dead_band = {5};
  config.silence_max = 1h;
  fixture x(sampler(config));
  x.counts = {200};
  x.join();
  x.run_for(5min);
  CHECK(x.sent.size() == 1);
  x.ask({{1, 5000ms}});
  x.run_for(20s);
  CHECK(x.sent.size() == 2);
  x.lose();
  x.join();
  x.run_for(20s);
  CHECK(x.sent.size() == 3);
}

TEST_CASE("a sampler rests while its mote is in no island and starts afresh afterwards", "[apps]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    fixture x(sampler({{quantity::temperature}, 10s}, seed));
    x.join();
    x.run_for(30s);
    x.lose();
    CHECK(x.readings_in_a_minute() == 0);
    x.join();
    x.lose();
    x.join();
    CHECK(x.readings_in_a_minute() == 6);
    CHECK(x.gaps() == std::set<duration>{10s});
  }
}

TEST_CASE("a sampler sends only while somebody subscribes to its channel, if it is to",
          "[apps][GW-10]") {
  apps::sampler_config config{{quantity::temperature}, 10s};
  config.channel = 3;
  config.only_subscribed = true;
  fixture x(sampler(config));
  x.join();
  CHECK(x.readings_in_a_minute() == 0);
  x.ask({{4, 0ms}});
  CHECK(x.readings_in_a_minute() == 0);
  x.ask({{3, 0ms}, {4, 0ms}});
  CHECK(x.readings_in_a_minute() == 6);
  x.ask({{communication::any_channel, 0ms}});
  CHECK(x.readings_in_a_minute() == 6);
  x.ask({});
  CHECK(x.readings_in_a_minute() == 0);
  x.ask({{3, 0ms}});
  x.lose();
  CHECK(x.readings_in_a_minute() == 0);
  x.join(); // what was wanted still is
  CHECK(x.readings_in_a_minute() == 6);
}

TEST_CASE("a sampler takes the period that subscribers ask for, within its bound",
          "[apps][IF-04]") {
  apps::sampler_config config{{quantity::temperature}, 10s};
  config.every_min = 1s;
  fixture x(sampler(config));
  x.join();
  x.run_for(10s);
  const auto periods = [&x] {
    x.readings.clear();
    x.run_for(3min);
    return x.gaps();
  };
  CHECK(periods() == std::set<duration>{10s});
  x.ask({{1, 2500ms}});
  const auto asked = x.now;
  CHECK(periods() == std::set<duration>{2500ms});
  CHECK(x.readings.front() <= asked + 2500ms);
  x.ask({{1, 1min}});
  CHECK(periods() == std::set<duration>{1min});
  x.ask({{1, 10ms}});
  CHECK(periods() == std::set<duration>{1s});
  x.ask({});
  CHECK(periods() == std::set<duration>{10s});
}

TEST_CASE("an actuator obeys the first octet and answers with the state that came of it",
          "[apps][GW-12]") {
  fixture x(std::make_unique<apps::actuator>(apps::actuator_config{"switch", 2}, std::uint8_t{1}));
  x.join();
  REQUIRE(x.sent.size() == 1);
  CHECK(x.sent[0].what.payload == bytes{1}); // as it was at the start

  x.hear(gateway, 2, {});
  CHECK(x.moves.empty());
  x.hear(gateway, 2, {9, 1});
  REQUIRE(x.moves.size() == 1);
  CHECK(x.moves[0].name == "switch");
  CHECK(x.moves[0].state == 9);
  CHECK(x.sent.size() == 1); // the mote has not said yet what came of it

  x.app->actuatorChanged("switch", 0, false);
  x.settle();
  REQUIRE(x.sent.size() == 2);
  CHECK(x.sent[1].to == gateway);
  CHECK(x.sent[1].what.am_type == 2);
  CHECK(x.sent[1].what.payload == bytes{0});
  CHECK(x.sent[1].what.what == segment::kind::reliable);
  x.join();
  CHECK(x.sent.back().what.payload == bytes{0});
}

TEST_CASE("an actuator sends its newest state until its gateway has it", "[apps][GW-12]") {
  fixture x(std::make_unique<apps::actuator>(apps::actuator_config{"switch", 2}, std::uint8_t{1}));
  x.join();
  x.accepts = false;
  x.app->actuatorChanged("switch", 0, true);
  x.settle();
  x.run_for(20s);
  x.app->actuatorChanged("switch", 7, true); // what was there before is of no interest now
  x.settle();
  x.run_for(10min);
  const auto packets = x.packets;
  x.run_for(30min);
  CHECK(x.packets - packets >= 30 / 2);     // one or more an attempt,
  CHECK(x.packets - packets <= 5 * 30 + 5); // of which there is one a minute
  x.sent.clear();
  x.accepts = true;
  x.run_for(90s);
  REQUIRE(x.sent.size() == 1);
  CHECK(x.sent[0].what.payload == bytes{7});
  x.run_for(1h);
  CHECK(x.sent.size() == 1); // the gateway has it
}

TEST_CASE("an actuator in no island sends its state when it has joined", "[apps][GW-12]") {
  fixture x(std::make_unique<apps::actuator>(apps::actuator_config{"switch", 2}, std::uint8_t{1}));
  x.join();
  x.accepts = false;
  x.app->actuatorChanged("switch", 0, true);
  x.settle();
  x.run_for(20s);
  x.lose();
  x.sent.clear();
  x.run_for(10min);
  CHECK(x.sent.empty());
  x.accepts = true;
  x.join();
  REQUIRE(x.sent.size() == 1);
  CHECK(x.sent[0].what.payload == bytes{0});
}

TEST_CASE("an actuator tells its state as often as somebody wants", "[apps][IF-03][IF-04]") {
  fixture x(std::make_unique<apps::actuator>(apps::actuator_config{"switch", 2}, std::uint8_t{1}));
  x.ask({{2, 1s}});
  x.run_for(10s);
  CHECK(x.sent.empty()); // in no island
  x.join();
  x.run_for(10s);
  REQUIRE(x.sent.size() == 1 + 10);
  for (std::size_t i = 1; i < x.sent.size(); ++i) {
    CHECK(x.sent[i].what.am_type == 2);
    CHECK(x.sent[i].what.payload == bytes{1});
  }
  x.ask({{2, 1ms}}); // no more often than ten times a second
  const auto before = x.sent.size();
  x.run_for(10s);
  CHECK(x.sent.size() <= before + 100);
  CHECK(x.sent.size() > before + 90);
  x.ask({{1, 1s}});
  const auto after = x.sent.size();
  x.run_for(10s);
  CHECK(x.sent.size() == after);
}

TEST_CASE("a messenger sends its text every period while its mote is in an island", "[apps]") {
  const mote_address pager{island_id{2}, mote_id{7}};
  fixture x(
      std::make_unique<apps::messenger>(apps::messenger_config{pager, "dinner", 30s, 10, true}));
  x.run_for(1min);
  CHECK(x.sent.empty());
  x.join();
  x.run_for(70s);
  REQUIRE(x.sent.size() == 2);
  CHECK(x.sent[0].when == instant(90s));
  CHECK(x.sent[1].when == instant(120s));
  CHECK(x.sent[0].to == pager);
  CHECK(x.sent[0].what.am_type == 10);
  CHECK(to_string(x.sent[0].what.payload) == "dinner");
  CHECK(x.sent[0].what.what == segment::kind::reliable);

  x.lose();
  x.join(); // at 130 s; what was due at 150 s is of the life before
  x.run_for(35s);
  REQUIRE(x.sent.size() == 3);
  CHECK(x.sent.back().when == instant(160s));
  x.lose();
  x.run_for(5min);
  CHECK(x.sent.size() == 3);
  CHECK(x.app->take_warnings().empty());
}

TEST_CASE("a messenger warns of what was not delivered", "[apps]") {
  using words = std::vector<std::string>;
  fixture x(std::make_unique<apps::messenger>(
      apps::messenger_config{{island_id{2}, mote_id{7}}, "dinner", 30s, 10, true}));
  x.join();
  x.accepts = false;
  x.run_for(31s);
  CHECK(x.app->take_warnings().empty()); // it may still come
  x.lose();
  CHECK(x.app->take_warnings() == words{"event=undelivered number=1 refused=false"});
  fixture nobody(std::make_unique<apps::messenger>(apps::messenger_config{}));
  nobody.join();
  nobody.run_for(30s);
  CHECK(nobody.app->take_warnings() == words{"event=undelivered number=1 refused=true"});
}

TEST_CASE("a listener claims its type and tells the first message it hears", "[apps][AM-05]") {
  fixture x(std::make_unique<apps::listener>(apps::listener_config{10}));
  CHECK(x.app->take_warnings().empty());
  const mote_address button{island_id{1}, mote_id{8}};
  for (const std::string text : {"dinner", "dessert"})
    x.hear(button, 10, to_bytes(std::string_view(text)));
  CHECK(x.app->take_notices() == std::vector<std::string>{"received \"dinner\" from mote 1/8"});
  x.join();
}

TEST_CASE("a sampler has another period from now on", "[apps][ACT-10]") {
  apps::sampler_config config;
  config.transducers = {quantity::temperature};
  config.every = 10s;
  fixture x(sampler(config));
  auto& app = dynamic_cast<apps::sampler&>(*x.app);
  app.change({{"every", duration(20s)}}); // before it joins
  x.join();
  CHECK(x.readings_in_a_minute() == 3);
  app.change({{"every", duration(5s)}});
  CHECK(x.app->deadline() == instant{}); // it wants its turn
  x.run_for(5s);                         // a phase is drawn anew
  CHECK(x.readings_in_a_minute() == 12);
  CHECK(x.gaps() == std::set<duration>{5s});
  app.change({{"every", duration(5s)}}); // no news
  CHECK(x.app->deadline() != instant{});
  x.lose();
  app.change({{"every", duration(1s)}});
  CHECK(x.readings_in_a_minute() == 0);
  x.join();
  CHECK(x.readings_in_a_minute() >= 59);
}

TEST_CASE("who asks for a period goes before the sampler's own", "[apps][ACT-10][IF-04]") {
  apps::sampler_config config;
  config.transducers = {quantity::temperature};
  config.every = 10s;
  fixture x(sampler(config));
  auto& app = dynamic_cast<apps::sampler&>(*x.app);
  x.join();
  x.ask({{1, 2s}});
  app.change({{"every", duration(30s)}});
  x.run_for(2s);
  CHECK(x.readings_in_a_minute() == 30);
  x.ask({});
  x.run_for(30s);
  CHECK(x.readings_in_a_minute() == 2);
}

TEST_CASE("a messenger has another period from now on", "[apps][ACT-10]") {
  apps::messenger_config config;
  config.to = {kitchen, mote_id{9}};
  config.text = "hello";
  config.every = 30s;
  fixture x(std::make_unique<apps::messenger>(config));
  auto& app = dynamic_cast<apps::messenger&>(*x.app);
  app.change({{"every", duration(20s)}});
  x.join();
  x.run_for(1min);
  CHECK(x.sent.size() == 3);
  app.change({{"every", duration(5s)}});
  x.run_for(20s);
  CHECK(x.sent.size() == 7);
  x.lose();
  app.change({{"every", duration(1s)}});
  x.run_for(1min);
  CHECK(x.sent.size() == 7);
}

TEST_CASE("a messenger stops after so many messages, also if its mote joins again", "[apps]") {
  apps::messenger_config config;
  config.to = {kitchen, mote_id{9}};
  config.text = "hello";
  config.every = 10s;
  config.count = 2;
  fixture x(std::make_unique<apps::messenger>(config));
  x.join();
  x.run_for(10s);
  CHECK(x.sent.size() == 1);
  x.run_for(1min);
  CHECK(x.sent.size() == 2);
  x.lose();
  x.join();
  x.run_for(1min);
  CHECK(x.sent.size() == 2);
}

TEST_CASE("a messenger sends another text from now on", "[apps][ACT-10]") {
  apps::messenger_config config;
  config.to = {kitchen, mote_id{9}};
  config.text = "hello";
  config.every = 10s;
  fixture x(std::make_unique<apps::messenger>(config));
  x.join();
  x.run_for(15s);
  dynamic_cast<apps::messenger&>(*x.app).change({{"text", "good night"}, {"reliable", false}});
  x.run_for(10s); // its period goes on
  REQUIRE(x.sent.size() == 2);
  CHECK(to_string(x.sent[0].what.payload) == "hello");
  CHECK(to_string(x.sent[1].what.payload) == "good night");
  CHECK(x.sent[1].what.what == segment::kind::plain);
}
