#include "explain/outcome.hpp"
#include "support/catch.hpp"
#include "unit/explain/fixture.hpp"

using namespace rubicon;
using namespace rubicon::explain;
using namespace rubicon::test;

namespace {

const std::string rules = "peer_app/robot/rules-1";
const std::string proxy = "proxy/kitchen.near";

/// A proxy on the PC sets a value that rules on the robot want to hear.
explain_fixture watched_value(bool lost) {
  explain_fixture world;
  world.link(pc_kernel, robot_kernel);
  world.watches(rules, robot_kernel, "*.*.temperature");
  world.sets(proxy, pc_kernel, "kitchen.near.temperature", "21.5", 0);
  world.package(peis::port::push, pc_kernel, robot_kernel, 11, 30, "kitchen.near.temperature",
                "21.5", 1, lost);
  if (!lost)
    world.hears(robot_kernel, rules, 11, "kitchen.near.temperature", "21.5");
  return world;
}

} // namespace

TEST_CASE("a value is followed to those who hear of it, and to what they do", "[explain]") {
  auto world = watched_value(false);
  const auto heard = world.x.records.back().number;
  world.sets(rules, robot_kernel, "kitchen.fan.switch", "on", heard);
  const auto all = follow(world.x);
  REQUIRE(all.tuples.size() == 2);
  const auto text = tuple_text(all, 0, wide);
  CHECK(contains(text, "kitchen.near.temperature = 21.5"));
  CHECK(contains(text, "pc → robot"));
  CHECK(contains(text, "sets kitchen.fan.switch = on"));
  CHECK(contains(text, "robot/rules-1 received it after 1.0 ms"));
  CHECK(contains(tuple_text(all, 1, {}), "proxy kitchen.near"));
}

TEST_CASE("a value that a link loses is missed by those who live on", "[explain]") {
  auto world = watched_value(true);
  CHECK(audience_of(follow(world.x), follow(world.x).tuples.front()).empty()); // ended, perhaps
  world.sets(proxy, pc_kernel, "kitchen.near.temperature", "22.0", 0);
  world.package(peis::port::push, pc_kernel, robot_kernel, 11, 30, "kitchen.near.temperature",
                "22.0", 2);
  world.hears(robot_kernel, rules, 11, "kitchen.near.temperature", "22.0");
  const auto all = follow(world.x);
  const auto text = tuple_text(all, 0, wide);
  CHECK(contains(text, "PEIS: LOST, lost on the link"));
  CHECK(contains(text, "robot/rules-1 did not receive it"));
  CHECK(contains(tuple_text(all, 1, {}), "robot/rules-1 received it"));
}

TEST_CASE("who asks for a value after it was set has missed nothing", "[explain]") {
  explain_fixture world;
  world.sets(proxy, pc_kernel, "kitchen.near.temperature", "21.5", 0);
  world.now += 1s;
  world.watches(rules, pc_kernel, "kitchen.near.temperature");
  world.sets(proxy, pc_kernel, "kitchen.near.temperature", "22.0", 0);
  world.now += 1ms;
  world.hears(pc_kernel, rules, 11, "kitchen.near.temperature", "22.0");
  const auto all = follow(world.x);
  REQUIRE(all.tuples.size() == 2);
  CHECK(audience_of(all, all.tuples[0]).empty());
  CHECK(audience_of(all, all.tuples[1]).size() == 1);
}

TEST_CASE("the fragments of a packet are no repeats", "[explain]") {
  node hop;
  hop.fragments = 3;
  for (const std::uint32_t more : {0U, 1U, 2U}) {
    hop.attempts.resize(hop.fragments + more);
    CHECK(repeats(hop) == more);
  }
}

TEST_CASE("a package that is sent again is one hop", "[explain]") {
  auto world = watched_value(true);
  world.package(peis::port::push, pc_kernel, robot_kernel, 11, 30, "kitchen.near.temperature",
                "21.5", 1);
  world.hears(robot_kernel, rules, 11, "kitchen.near.temperature", "21.5");
  const auto text = tuple_text(follow(world.x), 0, wide);
  CHECK(contains(text, "PEIS: received after 1 repeat (lost on the link)"));
  CHECK(contains(text, "received it after 2.0 ms"));
}

TEST_CASE("equal values that follow each other are told apart", "[explain]") {
  explain_fixture world;
  world.watches(rules, pc_kernel, "kitchen.near.temperature");
  for (int i = 0; i < 3; ++i) {
    world.sets(proxy, pc_kernel, "kitchen.near.temperature", "21.5", 0);
    world.now += 1ms;
    world.hears(pc_kernel, rules, 11, "kitchen.near.temperature", "21.5");
    world.now += 1s;
  }
  const auto all = follow(world.x);
  REQUIRE(all.tuples.size() == 3);
  for (const auto& x : all.tuples) {
    const auto heard = audience_of(all, x);
    REQUIRE(heard.size() == 1);
    CHECK(heard.front().after == duration(1ms));
  }
}

TEST_CASE("a tuple of another peer is set when the request has reached it", "[explain]") {
  const auto lost = GENERATE(false, true);
  explain_fixture world;
  world.link(pc_kernel, gateway_kernel);
  record r;
  r.peer = 1;
  r.text = "devices.7.input.2";
  r.octets = to_bytes(std::string_view("1"));
  r.yes = true;
  world.put(kind::set_remote_tuple, proxy, pc_kernel, 0, r);
  world.package(peis::port::set, pc_kernel, gateway_kernel, 1, 1, "devices.7.input.2", "1", 0,
                lost);
  const auto all = follow(world.x);
  REQUIRE(all.tuples.size() == 1);
  CHECK(all.tuples.front().set.has_value() == !lost);
  const auto text = tuple_text(all, 0, wide);
  CHECK(contains(text, "writes devices.7.input.2 = 1 at kitchen-gateway"));
  CHECK(
      contains(text, lost ? "never set: it did not reach kitchen-gateway" : "now has this value"));
}

TEST_CASE("the value at a time is the newest that was set until then", "[explain]") {
  explain_fixture world;
  for (const auto* value : {"a", "b", "c"}) {
    world.now += 1s;
    world.sets(proxy, pc_kernel, "kitchen.near.state", value, 0);
  }
  const auto all = follow(world.x);
  const auto found = find(all, "Kitchen.Near.STATE");
  REQUIRE(std::holds_alternative<tuples_found>(found));
  const auto& indices = std::get<tuples_found>(found).indices;
  CHECK(indices.size() == 3);
  CHECK(!value_at(all, indices, instant(999ms)));
  CHECK(value_at(all, indices, instant(1s)) == 0U);
  CHECK(value_at(all, indices, instant(2500ms)) == 1U);
  CHECK(value_at(all, indices, instant(1h)) == 2U);
  const auto text = values_text(all, indices, 2, wide);
  CHECK(contains(text, "kitchen.near.state@pc, 3 values, the newest 2"));
  CHECK(!contains(text, "0:01.000"));
}

TEST_CASE("an unknown tuple is answered by those there are", "[explain]") {
  explain_fixture world;
  world.sets(proxy, pc_kernel, "kitchen.near.state", "a", 0);
  const auto found = find(follow(world.x), "kitchen.near.stat");
  REQUIRE(std::holds_alternative<nothing_found>(found));
  CHECK(std::get<nothing_found>(found).known == std::vector<std::string>{"kitchen.near.state"});
}

TEST_CASE("octets that no decoder takes are left out", "[explain]") {
  explain_fixture world;
  for (const auto what : {kind::radio_send, kind::frame, kind::frame_received, kind::serial_write,
                          kind::serial_octets, kind::link_octets, kind::link_lost}) {
    record r;
    r.channel = network::am::up;
    r.octets = {1, 2, 3};
    world.put(what, near_mote, pc_kernel, 7, r);
    world.put(what, "nobody", "nowhere", 1000, r);
  }
  const auto all = follow(world.x);
  CHECK(all.messages.empty());
  CHECK(all.tuples.empty());
}
