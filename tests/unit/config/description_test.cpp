#include <string>
#include <variant>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using rubicon::test::good;
using rubicon::test::island_head;
using rubicon::test::mote_head;

namespace {

ecology_description after(std::string_view start, std::string_view rest) {
  return good(std::string(start) + std::string(rest));
}

mote_description mote_with(std::string_view rest) {
  return after(mote_head, rest).islands.at(0).motes.at(0);
}

} // namespace

TEST_CASE("what a file does not say has its default", "[config][GEN-04][ADR-09]") {
  const auto x = after("[ecology]\nname = \"t\"\n[[island]]\nname = \"k\"\nid = 1\n",
                       "[[island.mote]]\nid = 2\ntype = 5\nposition_m = [1, 2]\n");
  CHECK(x.seed == 1);
  CHECK(x.mode == run_mode::virtual_time);
  CHECK(x.length == 10min);
  CHECK(x.network == "rubicon");
  CHECK(std::get<radio::unit_disk>(x.radio.propagation).range_m == 30);
  CHECK(std::holds_alternative<radio::no_noise>(x.radio.noise));
  CHECK(x.radio.collisions == radio::collision_rule::strict);
  CHECK(x.radio.sensing == radio::sensing::energy_or_carrier);
  CHECK(x.radio.window == radio::sensing_window::whole);
  CHECK_FALSE(x.radio.capture);
  CHECK(x.radio.loss == 0);
  CHECK(x.radio.queue == 8);
  CHECK_FALSE(x.radio.retries_max);
  CHECK(x.radio.macs.empty());
  CHECK(x.radio.links.empty());
  const auto& island = x.islands.at(0);
  CHECK(island.stack == stack::full);
  CHECK_FALSE(island.sink.transmit_dbm);
  CHECK_FALSE(island.sink.promiscuous);
  CHECK(island.sink.id == default_sink);
  CHECK(island.sink.platform->name == "micaz");
  CHECK(island.sink.place == position{});
  CHECK(island.serial.baud == island.sink.platform->serial_baud);
  CHECK(island.serial.latency == 1ms);
  CHECK(island.gateway_name == "k-gateway");
  CHECK(island.gateway_links.empty());
  CHECK(island.host.empty());
  CHECK(island.keep_alive == 10s);
  const auto& mote = island.motes.at(0);
  CHECK(mote.name == "mote-2");
  CHECK(mote.type == 5);
  CHECK(mote.type_name.empty());
  CHECK(mote.platform->name == "micaz");
  CHECK_FALSE(mote.battery_mah);
  REQUIRE(x.airs.size() == 1);
  CHECK(x.airs[0].name == "k");
  CHECK(x.airs[0].islands == std::vector{island_id{1}});
}

TEST_CASE("everything a file may say arrives", "[config][GEN-04]") {
  const auto x =
      good("[ecology]\nname = \"t\"\nseed = 9\nmode = \"wall\"\nduration = \"1d\"\n"
           "network = \"n\"\n"
           "[radio]\nrange = \"25m\"\nloss = \"2%\"\nqueue = 4\nretries = 0\n"
           "[[host]]\nname = \"h\"\naddress = \"pc.local\"\n"
           "[[island]]\nname = \"k\"\nid = 254\nhost = \"h\"\nkeep_alive = \"20s\"\n"
           "sink = { id = 60, platform = \"telosb\", position_m = [1, 2, 3] }\n"
           "serial = { baud = 9600, latency = \"2ms\", octet_error = 0.01, buffer = 64 }\n"
           "gateway = { name = \"g\", links = [\"inproc://pc\"] }\n"
           "[[peer]]\nname = \"pc\"\nid = 1\nhost = \"h\"\nlinks = [\"inproc://g\"]\n");
  CHECK(x.seed == 9);
  CHECK(x.mode == run_mode::wall);
  CHECK(x.length == 24h);
  CHECK(x.network == "n");
  CHECK(std::get<radio::unit_disk>(x.radio.propagation).range_m == 25);
  CHECK(x.radio.loss == 0.02);
  CHECK(x.radio.queue == 4);
  CHECK(x.radio.retries_max == 0U);
  REQUIRE(x.hosts.size() == 1);
  CHECK(x.hosts[0].address == "pc.local");
  const auto& island = x.islands.at(0);
  CHECK(island.id == island_id{254});
  CHECK(island.host == "h");
  CHECK(island.keep_alive == 20s);
  CHECK(island.sink.id == mote_id{60});
  CHECK(island.sink.platform->name == "telosb");
  CHECK(island.sink.place == position{1, 2, 3});
  CHECK(island.serial.baud == 9600);
  CHECK(island.serial.latency == 2ms);
  CHECK(island.serial.octet_error == 0.01);
  CHECK(island.serial.buffer == 64);
  CHECK(island.gateway_name == "g");
  CHECK(island.gateway_links == std::vector<std::string>{"pc"});
  CHECK(x.peers.at(0).links == std::vector<std::string>{"g"});
  CHECK(x.peers.at(0).host == "h");
}

TEST_CASE("a floor plan arrives, and is not needed", "[config][ACT-09]") {
  CHECK_FALSE(after(mote_head, "").plan);
  const auto x = after(mote_head, "[plan]\npicture = \"flat.png\"\nposition_m = [-1, -2]\n"
                                  "width = \"12.5m\"\n");
  REQUIRE(x.plan);
  CHECK(x.plan->picture == "flat.png");
  CHECK(x.plan->corner == position{-1, -2, 0});
  CHECK(x.plan->width_m == 12.5);
}

TEST_CASE("a serial line is as fast as the sink's platform", "[config]") {
  const auto x = after(island_head, "sink.platform = \"telosb\"\n");
  CHECK(x.islands.at(0).serial.baud == radio::find_platform("telosb")->serial_baud);
}

TEST_CASE("a mote has what its type has", "[config]") {
  const auto x = mote_with("");
  CHECK(x.name == "c-2");
  CHECK(x.type == 7);
  CHECK(x.type_name == "c");
  CHECK(x.place == position{1, 2, 0});
  REQUIRE(x.transducers.size() == 1);
  CHECK(std::get<device::constant_model>(x.transducers[0].model).value == 20);
  REQUIRE(x.actuators.size() == 1);
  CHECK(x.actuators[0].name == "fan");
}

TEST_CASE("a mote changes and extends what its type has", "[config]") {
  const auto x =
      mote_with("name = \"n\"\nplatform = \"iris\"\nbattery = \"1Ah\"\n"
                "transducers.light = { model = \"constant\", value = 5 }\n"
                "transducers.temperature = { model = \"constant\", value = 30 }\n"
                "actuators = [{ name = \"fan\", kind = \"dimmer\", initial = 9 },\n"
                "             { name = \"lamp\", kind = \"relay\", initial = \"on\" }]\n");
  CHECK(x.name == "n");
  CHECK(x.platform->name == "iris");
  CHECK(x.battery_mah == 1000.0);
  REQUIRE(x.transducers.size() == 2);
  CHECK(x.transducers[0].kind == device::quantity::temperature);
  CHECK(std::get<device::constant_model>(x.transducers[0].model).value == 30);
  CHECK(x.transducers[1].kind == device::quantity::light);
  REQUIRE(x.actuators.size() == 2);
  CHECK(x.actuators[0].kind == device::actuator_kind::dimmer);
  CHECK(x.actuators[0].initial == 9);
  CHECK(x.actuators[1].initial == 1);
}

TEST_CASE("an app of a mote replaces its type's on the same channel", "[config]") {
  std::string toml(mote_head);
  toml.insert(toml.find("actuators"), "apps = [\n"
                                      "  { app = \"sampler\", transducers = [\"temperature\"] },\n"
                                      "  { app = \"actuator\", actuator = \"fan\" },\n"
                                      "  { app = \"listener\" },\n"
                                      "  { app = \"messenger\", to = \"k/c-2\", text = \"a\" },\n"
                                      "]\n");
  const auto x =
      after(toml, "apps = [\n"
                  "  { app = \"sampler\", transducers = [\"temperature\"], every = \"1s\" },\n"
                  "  { app = \"sampler\", transducers = [\"temperature\"], channel = 9 },\n"
                  "  { app = \"listener\", am_type = 11 },\n"
                  "  { app = \"messenger\", to = \"k/c-2\", text = \"b\" },\n"
                  "]\n")
          .islands.at(0)
          .motes.at(0)
          .apps;
  REQUIRE(x.size() == 7);
  CHECK(std::get<actuator_app>(x[0]).actuator == "fan");
  CHECK(std::get<listener_app>(x[1]).am_type == 10);
  CHECK(std::get<messenger_app>(x[2]).text == "a");
  CHECK(std::get<sampler_app>(x[3]).every == 1s);
  CHECK(std::get<sampler_app>(x[4]).channel == 9);
  CHECK(std::get<listener_app>(x[5]).am_type == 11);
  CHECK(std::get<messenger_app>(x[6]).text == "b");
}

TEST_CASE("a virtual run may start on any day", "[config]") {
  const auto day = [](const std::string& date) {
    return good("[ecology]\nname = \"t\"\ndate = \"" + date +
                "\"\nstart = \"23:50\"\n[[peer]]\nname = \"pc\"\nid = 300\n")
        .date;
  };
  CHECK(day("1970-01-01") == duration(0s));
  CHECK(day("2038-01-19") == duration(24h * 24855));
  CHECK(day("2149-12-31") == duration(24h * 65743));
  CHECK_FALSE(good(std::string(test::head)).date);
}

TEST_CASE("a field is a stamp where its motes' samplers send one", "[config][PXY-04]") {
  const auto layout = [](const std::string& sampler, int offset, const std::string& more = {}) {
    return good(mote_head + "[[island.mote.apps]]\napp = \"sampler\"\n" +
                "transducers = [\"temperature\"]\nevery = \"5s\"\n" + sampler + more +
                "[[proxy]]\nname = \"p\"\ntypes = [7]\n[[proxy.field]]\nname = \"f\"\n" +
                "channel = 1\nencoding = \"u32\"\noffset = " + std::to_string(offset) + "\n")
        .proxies.front()
        .fields.front()
        .layout;
  };
  CHECK(layout("stamped = true\n", 2) == proxy::encoding::stamp);
  CHECK(layout("stamped = true\n", 0) == proxy::encoding::u32);
  CHECK(layout("", 2) == proxy::encoding::stamp);
  CHECK(layout("stamped = false\n", 2) == proxy::encoding::u32);
  CHECK(layout("stamped = true\n", 2,
               "[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = [1, 3]\n") ==
        proxy::encoding::u32);
}

TEST_CASE("apps of motes arrive with their keys", "[config]") {
  const auto x = mote_with("[[island.mote.apps]]\napp = \"sampler\"\n"
                           "transducers = [\"light\", \"temperature\"]\nevery = \"5s\"\n"
                           "jitter = \"1s\"\nchannel = 0\nreliable = true\nstamped = true\n"
                           "only_subscribed = true\nevery_min = \"2s\"\n"
                           "[[island.mote.apps]]\napp = \"messenger\"\nto = \"k/c-2\"\n"
                           "text = \"hi\"\nevery = \"1min\"\nam_type = 255\nreliable = false\n"
                           "[[island.mote.apps]]\napp = \"actuator\"\nactuator = \"fan\"\n"
                           "channel = 255\n"
                           "[[island.mote.apps]]\napp = \"listener\"\nam_type = 3\n"
                           "[island.mote.transducers]\n"
                           "light = { model = \"constant\", value = 1 }\n")
                     .apps;
  REQUIRE(x.size() == 4);
  const auto& sampler = std::get<sampler_app>(x[0]);
  CHECK(sampler.transducers == std::vector{device::quantity::light, device::quantity::temperature});
  CHECK(sampler.every == 5s);
  CHECK(sampler.jitter == 1s);
  CHECK(sampler.channel == 0);
  CHECK(sampler.reliable);
  CHECK(sampler.only_subscribed);
  CHECK(sampler.every_min == 2s);
  CHECK(sampler.stamped);
  const auto& messenger = std::get<messenger_app>(x[1]);
  CHECK(messenger.to == mote_address{island_id{1}, mote_id{2}});
  CHECK(messenger.text == "hi");
  CHECK(messenger.every == 1min);
  CHECK(messenger.am_type == 255);
  CHECK_FALSE(messenger.reliable);
  CHECK(std::get<actuator_app>(x[2]).channel == 255);
  CHECK(std::get<listener_app>(x[3]).am_type == 3);
}

TEST_CASE("models of transducers arrive with their keys", "[config]") {
  const auto x =
      mote_with("[island.mote.transducers]\n"
                "sound = { model = \"sine\", mean = 1, amplitude = 2.5, period = \"1h\","
                " phase_turns = -0.25, noise = 0.5, resolution = 2 }\n"
                "light = { model = \"points\", points = [[\"0s\", 1], [\"1min\", -2.5]] }\n");
  REQUIRE(x.transducers.size() == 3);
  const auto& light = std::get<device::points_model>(x.transducers[1].model);
  CHECK(light.points == std::vector<std::pair<duration, double>>{{0s, 1}, {1min, -2.5}});
  CHECK(x.transducers[1].resolution == 0.1);
  const auto& sound = std::get<device::sine_model>(x.transducers[2].model);
  CHECK(sound.mean == 1);
  CHECK(sound.amplitude == 2.5);
  CHECK(sound.period == 1h);
  CHECK(sound.phase_turns == -0.25);
  CHECK(x.transducers[2].noise == 0.5);
  CHECK(x.transducers[2].resolution == 2);
}

TEST_CASE("islands, motes, peers and faults are in order", "[config]") {
  const auto x = good("[ecology]\nname = \"t\"\n"
                      "[[fault]]\nat = \"2s\"\nkind = \"unplug\"\nisland = \"b\"\n"
                      "[[fault]]\nat = \"1s\"\nkind = \"crash\"\nmote = \"b/mote-9\"\n"
                      "[[air]]\nname = \"x\"\nislands = [\"c\", \"b\"]\n"
                      "[[peer]]\nname = \"p\"\nid = 400\n[[peer]]\nname = \"q\"\nid = 300\n"
                      "[[island]]\nname = \"c\"\nid = 3\n[[island]]\nname = \"b\"\nid = 2\n"
                      "mote = [{ id = 9, type = 1, position_m = [0, 0] },\n"
                      "{ id = 8, type = 1, position_m = [0, 0] }]\n"
                      "[[island]]\nname = \"a\"\nid = 1\n");
  REQUIRE(x.islands.size() == 3);
  CHECK(x.islands[0].name == "a");
  CHECK(x.islands[2].name == "c");
  CHECK(x.islands[1].motes.at(0).id == mote_id{8});
  CHECK(x.peers.at(0).name == "q");
  REQUIRE(x.airs.size() == 2);
  CHECK(x.airs[0].islands == std::vector{island_id{3}, island_id{2}});
  CHECK(x.airs[1].name == "a");
  REQUIRE(x.faults.size() == 2);
  CHECK(std::get<crash_fault>(x.faults[0].what).mote == mote_address{island_id{2}, mote_id{9}});
  CHECK(std::get<unplug_fault>(x.faults[1].what).island == island_id{2});
  CHECK(std::get<unplug_fault>(x.faults[1].what).length == 30s);
}

TEST_CASE("apps of peers arrive with their keys", "[config]") {
  const auto x =
      after(island_head, "[[peer]]\nname = \"q\"\nid = 301\napps = [\n"
                         "  { app = \"proxy_manager\" },\n"
                         "  { app = \"collector\", keys = [\"*.t\", \"a\"] },\n"
                         "  { app = \"rules\", rules = [{ when = \"a\", above = 2, below = 1.5,"
                         " write = \"b\", then = \"on\", otherwise = \"off\" }] },\n]\n")
          .peers.at(1)
          .apps;
  REQUIRE(x.size() == 3);
  CHECK(std::get<proxy_manager_app>(x[0]).islands == std::vector{island_id{1}});
  CHECK(std::get<collector_app>(x[1]).keys == std::vector<std::string>{"*.t", "a"});
  const auto& rule = std::get<proxy::rules_config>(x[2]).rules.at(0);
  CHECK(rule.when == "a");
  CHECK(rule.above == 2.0);
  CHECK(rule.below == 1.5);
  REQUIRE(rule.writes.size() == 1);
  CHECK(rule.writes[0].key == "b");
  CHECK(rule.writes[0].then == "on");
  CHECK(rule.writes[0].otherwise == "off");
}

TEST_CASE("a proxy class arrives with all its keys", "[config][PXY-11][PXY-13]") {
  const auto x = after(test::head, "[[proxy]]\nname = \"p\"\ntypes = [7, \"100..119\"]\n"
                                   "prefix = \"x.{id}\"\nproperties = { b = \"1\", a = \"2\" }\n"
                                   "[[proxy.field]]\nname = \"f\"\nchannel = 3\noffset = 2\n"
                                   "encoding = \"u32\"\nscale = 0.5\nadd = -1\ndecimals = 3\n"
                                   "unit = \"C\"\nwords = { 1 = \"on\", 0 = \"off\" }\n"
                                   "[[proxy.input]]\nname = \"i\"\nchannel = 4\n"
                                   "words = { on = \"01ff\", off = \"00\" }\n")
                     .proxies.at(0);
  REQUIRE(x.types.size() == 2);
  CHECK(x.types[0].first == 7);
  CHECK(x.types[0].last == 7);
  CHECK(x.types[1].first == 100);
  CHECK(x.types[1].last == 119);
  CHECK(x.prefix == "x.{id}");
  using texts = std::vector<std::pair<std::string, std::string>>;
  CHECK(x.properties == texts{{"b", "1"}, {"a", "2"}});
  const auto& field = x.fields.at(0);
  CHECK(field.channel == 3);
  CHECK(field.offset == 2);
  CHECK(field.layout == proxy::encoding::u32);
  CHECK(field.scale == 0.5);
  CHECK(field.add == -1);
  CHECK(field.decimals == 3);
  CHECK(field.unit == "C");
  CHECK(field.words == std::vector<std::pair<std::int64_t, std::string>>{{1, "on"}, {0, "off"}});
  const auto& input = x.inputs.at(0);
  CHECK(input.channel == 4);
  CHECK(input.words == std::vector<std::pair<std::string, bytes>>{{"on", {1, 255}}, {"off", {0}}});
}
