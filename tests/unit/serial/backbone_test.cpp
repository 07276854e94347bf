#include "serial/cable/backbone.hpp"

#include "serial/cable/line_config.hpp"
#include "support/catch.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using serial::test::start;

namespace {

/// Both sinks run.
backbone make_backbone(backbone_config config = {}) {
  backbone x(config, random_stream(1));
  x.set_end(backbone_direction::up, true);
  x.set_end(backbone_direction::down, true);
  return x;
}

backbone_packet packet_of(std::size_t size, std::optional<std::uint64_t> token = {}) {
  return {token, 5, bytes(size, 0x55)};
}

/// Everything until nothing is due any more, with its times.
std::vector<std::pair<instant, backbone_output>> outputs_of(backbone& x) {
  std::vector<std::pair<instant, backbone_output>> found;
  while (const auto due = x.deadline()) {
    CHECK(x.on_time(*due - 1ns).empty());
    for (auto& each : x.on_time(*due))
      found.emplace_back(*due, std::move(each));
  }
  return found;
}

} // namespace

TEST_CASE("a packet crosses both cables, and is acknowledged", "[serial]") {
  auto x = make_backbone({.jitter = 0s});
  x.send(backbone_direction::up, packet_of(41, 7), start);
  const auto passage = 2 * transmission_time(41 + backbone::overhead, 57600) + 2ms;
  const auto found = outputs_of(x);
  REQUIRE(found.size() == 2);
  const auto& arrived = std::get<backbone_arrived>(found[0].second);
  CHECK(found[0].first == start + passage);
  CHECK(arrived.to == backbone_direction::up);
  CHECK(arrived.am_type == 5);
  CHECK(arrived.octets == payload(bytes(41, 0x55)));
  CHECK(arrived.age == passage);
  const auto& done = std::get<backbone_done>(found[1].second);
  CHECK(found[1].first == start + passage + 2ms);
  CHECK(done.token == 7);
  CHECK(done.acked);
  CHECK(x.counters(backbone_direction::up).arrived == 1);
  CHECK(x.counters(backbone_direction::down).sent == 0);
}

TEST_CASE("packets in one direction queue up, and carry how long they waited", "[serial]") {
  auto x = make_backbone({.jitter = 0s});
  for (int i = 0; i < 3; ++i)
    x.send(backbone_direction::down, packet_of(41), start);
  x.send(backbone_direction::up, packet_of(41), start); // the other direction does not wait
  const auto one = transmission_time(41 + backbone::overhead, 57600);
  const auto found = outputs_of(x);
  REQUIRE(found.size() == 4);
  CHECK(std::get<backbone_arrived>(found[0].second).to == backbone_direction::up);
  for (int i = 0; i < 3; ++i) {
    const auto& arrived = std::get<backbone_arrived>(found[static_cast<std::size_t>(i + 1)].second);
    CHECK(arrived.to == backbone_direction::down);
    CHECK(arrived.age == (i + 2) * one + 2ms);
    CHECK(found[static_cast<std::size_t>(i + 1)].first == start + arrived.age);
  }
}

TEST_CASE("the age of a packet is wrong by half of the jitter at most", "[serial]") {
  auto x = make_backbone();
  duration most{};
  for (int i = 0; i < 200; ++i) {
    const auto sent = start + i * 1s;
    x.send(backbone_direction::down, packet_of(60), sent);
    const auto found = outputs_of(x);
    REQUIRE(found.size() == 1);
    const auto& arrived = std::get<backbone_arrived>(found[0].second);
    const auto error = std::chrono::abs(found[0].first - sent - arrived.age);
    CHECK(error <= 500us);
    most = std::max(most, error);
  }
  CHECK(most > 400us);
}

TEST_CASE("no frame overtakes another on a backbone", "[serial]") {
  auto x = make_backbone({.baud = 1'000'000, .jitter = 50ms});
  for (std::uint8_t i = 0; i < 20; ++i)
    x.send(backbone_direction::up, {std::nullopt, i, bytes(20)}, start);
  std::uint8_t next = 0;
  for (const auto& [when, what] : outputs_of(x))
    CHECK(std::get<backbone_arrived>(what).am_type == next++);
  CHECK(next == 20);
}

TEST_CASE("what a backbone loses is counted, and not acknowledged", "[serial]") {
  SECTION("at a sink that is out of order") {
    auto x = make_backbone();
    x.set_end(backbone_direction::down, false);
    x.send(backbone_direction::down, packet_of(41, 1), start);
    x.send(backbone_direction::down, packet_of(41), start);
    const auto found = outputs_of(x);
    REQUIRE(found.size() == 1);
    CHECK_FALSE(std::get<backbone_done>(found[0].second).acked);
    CHECK(found[0].first > start + backbone::ack_wait);
    CHECK(x.counters(backbone_direction::down).end_off == 2);
    CHECK(x.counters(backbone_direction::down).arrived == 0);
  }
  SECTION("because it is cut") {
    auto x = make_backbone();
    x.send(backbone_direction::up, packet_of(41, 1), start);
    CHECK(x.cut(start + 1ms).empty());
    CHECK(x.is_cut());
    x.send(backbone_direction::up, packet_of(41, 2), start + 2ms);
    const auto found = outputs_of(x);
    REQUIRE(found.size() == 2);
    for (const auto& [when, what] : found)
      CHECK_FALSE(std::get<backbone_done>(what).acked);
    CHECK(x.counters(backbone_direction::up).cut == 2);
    x.repair();
    x.send(backbone_direction::up, packet_of(41, 3), start + 1s);
    CHECK(outputs_of(x).size() == 2);
    CHECK(x.counters(backbone_direction::up).arrived == 1);
  }
  SECTION("at a full queue") {
    auto x = make_backbone({.queue = 2});
    for (std::uint64_t i = 0; i < 4; ++i)
      x.send(backbone_direction::up, packet_of(41, i), start);
    std::size_t acked = 0;
    for (const auto& [when, what] : outputs_of(x)) {
      const auto* done = std::get_if<backbone_done>(&what);
      acked += done != nullptr && done->acked ? 1 : 0;
    }
    CHECK(acked == 2);
    CHECK(x.counters(backbone_direction::up).overflow == 2);
    CHECK(x.counters(backbone_direction::up).sent == 4);
  }
}

TEST_CASE("a sink's next life is not notified of packets of the one before", "[serial]") {
  auto x = make_backbone({.latency = 1s, .jitter = 0s});
  x.send(backbone_direction::up, packet_of(41, 1), start);
  const auto first = x.on_time(start + 1500ms); // it has arrived, its acknowledgement has not
  REQUIRE(first.size() == 1);
  CHECK(std::holds_alternative<backbone_arrived>(first[0]));
  x.send(backbone_direction::up, packet_of(41, 2), start + 1500ms);
  x.send(backbone_direction::down, packet_of(41, 1), start + 1500ms);
  x.set_end(backbone_direction::down, false); // the further sink ends
  x.set_end(backbone_direction::down, true);
  std::size_t arrived = 0;
  std::vector<backbone_direction> done;
  for (const auto& [when, what] : outputs_of(x)) {
    if (const auto* ended = std::get_if<backbone_done>(&what))
      done.push_back(ended->to);
    else
      ++arrived;
  }
  CHECK(arrived == 2);
  CHECK(done == std::vector{backbone_direction::down});
}
