#include "mote/gateway_lines.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using mote::gateway_lines;

namespace {

/// A sink with gateways that answer, or not, as the test says.
struct world {
  gateway_lines lines;
  std::vector<bool> there;
  std::vector<std::uint32_t> lives;
  std::uint32_t heard_term = 0;
  instant now{};

  explicit world(std::size_t count, instant start = {})
      : lines({.lines = count}, start), there(count, true), lives(count, 0), now(start) {}

  /// Answers arrive 10 ms after the question.
  void run_until(instant end) {
    while (lines.deadline() && *lines.deadline() <= end) {
      now = std::max(now, *lines.deadline());
      for (const auto& x : lines.on_time(now)) {
        heard_term = std::max(heard_term, x.what.term);
        if (there[x.line])
          lines.on_answer(x.line, {lives[x.line], heard_term}, now + 10ms);
      }
      now += 10ms;
    }
    now = end;
  }
};

} // namespace

TEST_CASE("with one gateway a sink asks nothing", "[mote][GW-14]") {
  gateway_lines one({.lines = 1}, {});
  CHECK(!one.deadline());
  CHECK(one.on_time({}).empty());
  one.on_answer(0, {3, 3}, {});
  one.on_answer(7, {3, 3}, {});
  CHECK(one.leader() == 0);
}

TEST_CASE("each gateway is asked and gets its incarnation, and one of them that it leads",
          "[mote][GW-14]") {
  gateway_lines x({.lines = 2}, {});
  auto asked = x.on_time({});
  REQUIRE(asked.size() == 2);
  CHECK(asked[0].what == network::gateway_poll{network::unknown_life, 1, true});
  CHECK(asked[1].what == network::gateway_poll{network::unknown_life, 1, false});
  x.on_answer(0, {4, 0}, instant{10ms});
  CHECK(x.deadline() == instant{10ms}); // it cannot lead before it knows that it is registered
  asked = x.on_time(instant{10ms});
  CHECK(asked[0].what == network::gateway_poll{4, 1, true});
  CHECK(x.deadline() == instant{510ms});
  CHECK(x.on_time(instant{509ms}).empty());
}

TEST_CASE("the lead is handed over when a gateway is silent, and back when it has been steady",
          "[mote][GW-14]") {
  world x(2);
  x.run_until(instant{60s});
  CHECK(x.lines.leader() == 0);
  CHECK(x.lines.term() == 1);
  x.there[0] = false;
  x.run_until(instant{61400ms});
  CHECK(x.lines.leader() == 0);
  x.run_until(instant{62600ms}); // two seconds of patience and one gap between questions
  CHECK(x.lines.leader() == 1);
  CHECK(x.lines.term() == 2);
  x.there[0] = true;
  x.run_until(instant{77s});
  CHECK(x.lines.leader() == 1);
  x.run_until(instant{79s});
  CHECK(x.lines.leader() == 0);
  CHECK(x.lines.term() == 3);
}

TEST_CASE("a gateway that comes and goes does not lead", "[mote][GW-14]") {
  world x(2);
  x.run_until(instant{10s});
  x.there[0] = false;
  x.run_until(instant{20s});
  for (int i = 0; i < 20; ++i) { // ten seconds there, three seconds not
    x.there[0] = true;
    x.run_until(x.now + 10s);
    x.there[0] = false;
    x.run_until(x.now + 3s);
    CHECK(x.lines.leader() == 1);
  }
  CHECK(x.lines.term() == 2);
}

TEST_CASE("without any gateway the last one keeps the lead, and the first that comes takes it",
          "[mote][GW-14]") {
  world x(3);
  x.run_until(instant{5s});
  x.there = {false, false, false};
  x.run_until(instant{30s});
  CHECK(x.lines.leader() == 0);
  x.there[2] = true;
  x.run_until(instant{31s});
  CHECK(x.lines.leader() == 2);
  x.there[1] = true;
  x.run_until(instant{47s});
  CHECK(x.lines.leader() == 1);
}

TEST_CASE("a first gateway that never was there is not waited for longer than others",
          "[mote][GW-14]") {
  world x(2);
  x.there[0] = false;
  x.run_until(instant{2600ms});
  CHECK(x.lines.leader() == 1);
}

TEST_CASE("a gateway that was started again leads in a new term", "[mote][GW-14]") {
  world x(2);
  x.run_until(instant{10s});
  x.lives[0] = 1; // so soon that it was not missed
  x.run_until(instant{11s});
  CHECK(x.lines.leader() == 0);
  CHECK(x.lines.term() == 2);
}

TEST_CASE("a sink that was started again begins above all terms that were", "[mote][GW-14]") {
  world x(2);
  x.heard_term = 9;
  x.run_until(instant{1s});
  CHECK(x.lines.term() == 10);
}
