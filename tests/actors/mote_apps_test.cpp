#include "actors/apps/mote_apps.hpp"
#include "support/catch.hpp"
#include "support/fakes.hpp"

using namespace rubicon;
using mote::quantity;
using test::fake;
using test::virtual_world;

namespace {

constexpr mote_address gateway{own_island, no_mote};
constexpr membership_changed joined{true, island_id{5}};
constexpr membership_changed lost{};

/// An app on a fake mote.
struct rig {
  virtual_world world;
  fake<mote_actor> mote{world};
  fake<ecology_actor> ecology{world};

  mote_app_actor sampler(config::sampler_app config, std::uint64_t seed = 1) {
    return world.spawn_at("mote_app/kitchen/stove/sampler-1", rubicon::sampler, std::move(config),
                          mote.handle(), seed);
  }
};

} // namespace

TEST_CASE("a sampler reads every period from a random phase on", "[actors][apps]") {
  std::set<duration> phases;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    rig x;
    const auto app = x.sampler({{quantity::temperature, quantity::light}, 10s}, seed);
    x.world.run_for(1min);
    CHECK(x.mote.size() == 0); // not joined yet
    x.world.send(app, joined);
    x.world.run_for(1min);
    const auto times = x.mote.times<read_transducers>();
    REQUIRE(times.size() == 6);
    phases.insert(times[0] - instant(1min));
    CHECK(times[0] < instant(70s));
    for (std::size_t i = 1; i < times.size(); ++i)
      CHECK(times[i] - times[i - 1] == 10s);
    CHECK(x.mote.all<read_transducers>()[0].kinds ==
          std::vector{quantity::temperature, quantity::light});
  }
  CHECK(phases.size() == 10);
}

TEST_CASE("a sampler's jitter delays readings and never adds up", "[actors][apps]") {
  rig x;
  const auto app = x.sampler({{quantity::temperature}, 10s, 2s});
  x.world.send(app, joined);
  x.world.run_for(1000s);
  const auto times = x.mote.times<read_transducers>();
  REQUIRE(times.size() >= 99);
  std::set<duration> late;
  for (std::size_t i = 1; i < times.size(); ++i)
    late.insert(times[i] - times[0] - static_cast<int>(i) * 10s);
  CHECK(*late.begin() >= 0s);
  CHECK(*late.rbegin() < 2s);
  CHECK(late.size() > 50);
}

TEST_CASE("a sampler sends its counts in network byte order to the gateway", "[actors][apps]") {
  const bool reliable = GENERATE(false, true);
  rig x;
  const auto app = x.sampler({{quantity::temperature}, 10s, 0s, 6, reliable});
  x.world.send(app, transducers_read{{0x0102, -2}});
  x.world.send(app, transducers_read{{0}});
  const auto sent = x.mote.all<send_message>();
  REQUIRE(sent.size() == 2);
  CHECK(sent[0].destination == gateway);
  CHECK(sent[0].am_type == 6);
  CHECK(sent[0].octets == payload(bytes{0x01, 0x02, 0xff, 0xfe}));
  CHECK(sent[0].reliable == reliable);
  CHECK(sent[0].token != sent[1].token);
  CHECK(sent[0].app.actor == app);
}

TEST_CASE("a sampler says when it has measured, if it is to", "[actors][apps][IF-06]") {
  rig x;
  config::sampler_app config{{quantity::temperature}, 10s};
  config.stamped = true;
  const auto app = x.sampler(config);
  x.world.send(app, transducers_read{{0x0102}, 0x03040506});
  const auto sent = x.mote.all<send_message>();
  REQUIRE(sent.size() == 1);
  CHECK(sent[0].octets == payload(bytes{0x01, 0x02, 0x03, 0x04, 0x05, 0x06}));
}

TEST_CASE("a sampler averages the counts that it is to", "[actors][apps][PXY-17]") {
  rig x;
  config::sampler_app config{{quantity::temperature, quantity::light}, 10s};
  config.mean_of = {2, 1};
  const auto app = x.sampler(config);
  for (const auto count : std::vector<std::int16_t>{10, 20, -41})
    x.world.send(app, transducers_read{{count, count}});
  const auto sent = x.mote.all<send_message>();
  REQUIRE(sent.size() == 3);
  CHECK(sent[0].octets == payload(bytes{0x00, 0x0a, 0x00, 0x0a}));
  CHECK(sent[1].octets == payload(bytes{0x00, 0x0f, 0x00, 0x14}));
  CHECK(sent[2].octets == payload(bytes{0xff, 0xf5, 0xff, 0xd7})); // -10.5 and -41
}

TEST_CASE("a sampler rests while its mote is in no island and starts afresh afterwards",
          "[actors][apps]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    rig x;
    const auto app = x.sampler({{quantity::temperature}, 10s}, seed);
    x.world.send(app, joined);
    x.world.run_for(30s);
    x.world.send(app, lost);
    x.mote.forget();
    x.world.run_for(30s);
    CHECK(x.mote.size() == 0);
    x.world.send(app, joined);
    x.world.send(app, lost); // and the reading now under way must not come
    x.world.send(app, joined);
    x.world.run_for(1min);
    const auto times = x.mote.times<read_transducers>();
    REQUIRE(times.size() == 6);
    for (std::size_t i = 1; i < times.size(); ++i)
      CHECK(times[i] - times[i - 1] == 10s);
  }
}

TEST_CASE("a sampler sends only while somebody subscribes to its channel, if it is to",
          "[actors][apps][GW-10]") {
  rig x;
  config::sampler_app config{{quantity::temperature}, 10s};
  config.channel = 3;
  config.only_subscribed = true;
  const auto app = x.sampler(config);
  const auto readings_in_a_minute = [&] {
    x.mote.forget();
    x.world.run_for(1min);
    return x.mote.count<read_transducers>();
  };
  x.world.send(app, joined);
  CHECK(readings_in_a_minute() == 0);
  x.world.send(app, outputs_wanted{{{4, 0ms}}});
  CHECK(readings_in_a_minute() == 0);
  x.world.send(app, outputs_wanted{{{3, 0ms}, {4, 0ms}}});
  CHECK(readings_in_a_minute() == 6);
  x.world.send(app, outputs_wanted{{{mote::any_channel, 0ms}}});
  CHECK(readings_in_a_minute() == 6);
  x.world.send(app, outputs_wanted{});
  CHECK(readings_in_a_minute() == 0);
  x.world.send(app, outputs_wanted{{{3, 0ms}}});
  x.world.send(app, lost);
  CHECK(readings_in_a_minute() == 0);
  x.world.send(app, joined); // what was wanted still is
  CHECK(readings_in_a_minute() == 6);
}

TEST_CASE("a sampler takes the period that subscribers ask for, within its bound",
          "[actors][apps][IF-04]") {
  rig x;
  config::sampler_app config{{quantity::temperature}, 10s};
  config.every_min = 1s;
  const auto app = x.sampler(config);
  x.world.send(app, joined);
  x.world.run_for(10s);
  const auto periods = [&] {
    x.mote.forget();
    x.world.run_for(3min);
    const auto times = x.mote.times<read_transducers>();
    std::set<duration> all;
    for (std::size_t i = 1; i < times.size(); ++i)
      all.insert(times[i] - times[i - 1]);
    return all;
  };
  CHECK(periods() == std::set<duration>{10s});
  x.world.send(app, outputs_wanted{{{1, 2500ms}}});
  const auto asked = x.world.now();
  CHECK(periods() == std::set<duration>{2500ms});
  CHECK(x.mote.times<read_transducers>().front() <= asked + 2500ms);
  x.world.send(app, outputs_wanted{{{1, 1min}}});
  CHECK(periods() == std::set<duration>{1min});
  x.world.send(app, outputs_wanted{{{1, 10ms}}});
  CHECK(periods() == std::set<duration>{1s});
  x.world.send(app, outputs_wanted{});
  CHECK(periods() == std::set<duration>{10s});
}

TEST_CASE("a sampler takes no expiry of its life before a rejoin", "[actors][apps]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    rig x;
    const auto app = x.sampler({{quantity::temperature}, 10s}, seed);
    x.world.send(app, joined);
    x.world.send(app, lost);
    x.world.send(app, joined);
    x.world.run_for(1min);
    const auto times = x.mote.times<read_transducers>();
    REQUIRE(times.size() == 6);
    for (std::size_t i = 1; i < times.size(); ++i)
      CHECK(times[i] - times[i - 1] == 10s);
  }
}

TEST_CASE("an actuator obeys the first octet and answers with the state that came of it",
          "[actors][apps][GW-12]") {
  rig x;
  const auto app =
      x.world.spawn(actuator, config::actuator_app{"switch", 2}, x.mote.handle(), std::uint8_t{1});
  REQUIRE(x.mote.count<claim_am_type>() == 1);
  CHECK(x.mote.all<claim_am_type>()[0].am_type == 2);
  CHECK(x.mote.all<claim_am_type>()[0].app.actor == app);

  x.world.send(app, joined);
  REQUIRE(x.mote.count<send_message>() == 1);
  CHECK(x.mote.all<send_message>()[0].octets == payload(bytes{1})); // as it was at the start

  x.world.send(app, message_received{gateway, 2, bytes{}});
  CHECK(x.mote.count<set_actuator>() == 0);
  x.world.send(app, message_received{gateway, 2, bytes{9, 1}});
  REQUIRE(x.mote.count<set_actuator>() == 1);
  CHECK(x.mote.all<set_actuator>()[0].name == "switch");
  CHECK(x.mote.all<set_actuator>()[0].state == 9);
  CHECK(x.mote.count<send_message>() == 1); // the mote has not said yet what came of it

  x.world.send(app, actuator_changed{"switch", 0, false});
  REQUIRE(x.mote.count<send_message>() == 2);
  const auto answer = x.mote.all<send_message>()[1];
  CHECK(answer.destination == gateway);
  CHECK(answer.am_type == 2);
  CHECK(answer.octets == payload(bytes{0}));
  CHECK(answer.reliable);
  x.world.send(app, joined);
  CHECK(x.mote.all<send_message>().back().octets == payload(bytes{0}));
}

TEST_CASE("a messenger sends its text every period while its mote is in an island",
          "[actors][apps]") {
  rig x;
  const mote_address pager{island_id{2}, mote_id{7}};
  const auto app = x.world.spawn(messenger, config::messenger_app{pager, "dinner", 30s, 10, true},
                                 x.mote.handle());
  x.world.run_for(1min);
  CHECK(x.mote.size() == 0);
  x.world.send(app, joined);
  x.world.run_for(70s);
  CHECK(x.mote.times<send_message>() == std::vector{instant(90s), instant(120s)});
  const auto sent = x.mote.all<send_message>();
  CHECK(sent[0].destination == pager);
  CHECK(sent[0].am_type == 10);
  CHECK(to_string(sent[0].octets.view()) == "dinner");
  CHECK(sent[0].reliable);
  CHECK(sent[0].token != sent[1].token);

  x.world.send(app, lost);
  x.world.send(app, joined); // at 130 s; the expiry at 150 s is of the life before
  x.world.run_for(35s);
  CHECK(x.mote.times<send_message>().size() == 3);
  CHECK(x.mote.times<send_message>().back() == instant(160s));
  x.world.send(app, lost);
  x.world.run_for(5min);
  CHECK(x.mote.count<send_message>() == 3);
}

TEST_CASE("a messenger logs what was not delivered", "[actors][apps]") {
  rig x;
  const auto app = x.world.spawn(messenger, config::messenger_app{}, x.mote.handle());
  x.world.send(app, send_ended{1, false, true});
  CHECK(x.world.logged("undelivered") == 0);
  x.world.send(app, send_ended{2, false, false});
  x.world.send(app, send_ended{3, true, false});
  CHECK(x.world.logged("undelivered number=2 refused=false") == 1);
  CHECK(x.world.logged("undelivered number=3 refused=true") == 1);
}

TEST_CASE("a listener claims its type and tells the first message it hears", "[actors][apps]") {
  rig x;
  const auto app = x.world.spawn_at("mote_app/bedroom/pager/listener-10", listener,
                                    config::listener_app{10}, x.mote.handle(), x.ecology.handle());
  REQUIRE(x.mote.count<claim_am_type>() == 1);
  CHECK(x.mote.all<claim_am_type>()[0].am_type == 10);
  CHECK(x.ecology.size() == 0);
  const mote_address button{island_id{1}, mote_id{8}};
  for (const std::string text : {"dinner", "dessert"})
    x.world.send(app, message_received{button, 10, to_bytes(std::string_view(text))});
  REQUIRE(x.ecology.count<story>() == 1);
  CHECK(x.ecology.all<story>()[0].who == "mote_app/bedroom/pager/listener-10");
  CHECK(x.ecology.all<story>()[0].what == "heard \"dinner\" from mote 1/8");
}
