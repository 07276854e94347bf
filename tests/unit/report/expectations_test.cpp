#include <string>
#include <utility>

#include "report/expect/expectations.hpp"
#include "support/catch.hpp"
#include "unit/report/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::report;
using rubicon::test::sample_report;

namespace {

using verdict = expectation_report::verdict;

const mote_address climate_7{island_id{3}, mote_id{7}};
const mote_scope of_kitchen{"kitchen", island_id{3}, {}};
const mote_scope of_climate_7{"kitchen/climate-7", island_id{3}, mote_id{7}};

instant at(duration x) {
  return instant{} + x;
}

/// One expectation of ten minutes.
class one {
public:
  explicit one(expectation x) : judge({std::move(x)}, 10min) {}

  [[nodiscard]] expectation_report result(const run_report& x = sample_report()) const {
    const auto all = judge.judge(x);
    REQUIRE(all.size() == 1);
    return all[0];
  }
  [[nodiscard]] bool met(const run_report& x = sample_report()) const {
    return result(x).outcome == verdict::met;
  }

  expectations judge;
};

tuple_expectation lamp_follows_door() {
  tuple_condition door{"kitchen.door", {"open"}, {}, {}};
  tuple_condition lamp{"bedroom.lamp.state", {"on"}, {}, {}};
  return {door, lamp, 5s};
}

} // namespace

TEST_CASE("expectations read as they are meant", "[report][expect]") {
  CHECK(to_text(delivery_expectation{of_kitchen, 0.99}) == "delivery kitchen >= 99%");
  CHECK(to_text(delivery_expectation{{}, 0.999}) == "delivery >= 99.9%");
  CHECK(to_text(lamp_follows_door()) ==
        "\"bedroom.lamp.state\" = \"on\" within 5 s of \"kitchen.door\" = \"open\"");
  CHECK(to_text(clock_expectation{{}, 1ms}) == "clock <= 1 ms");
  CHECK(to_text(clock_expectation{{}, 1ms, 0.999}) == "clock <= 1 ms in 99.9%");
  CHECK(to_text(joined_expectation{{}, 20s}) == "joined within 20 s");
  CHECK(to_text(battery_expectation{of_climate_7, 0.8}) == "battery kitchen/climate-7 >= 80%");
  CHECK(to_text(stream_expectation{7, climate_7, "robot", 1, {}}) == "stream 7 to robot >= 100%");
  CHECK(to_text(tuple_expectation{{}, {"a.b", {}, 1.5, 3}, 1min}) ==
        "\"a.b\" >= 1.5 and < 3 within 1 min");
}

TEST_CASE("delivery counts what was refused and leaves out what is open", "[report][expect]") {
  // 111 offered: 99 acknowledged and 9 arrived
  CHECK(one(delivery_expectation{of_climate_7, 0.97}).met());
  const auto unmet = one(delivery_expectation{of_climate_7, 0.98}).result();
  CHECK(unmet.outcome == verdict::unmet);
  CHECK(unmet.at == at(10min));
  CHECK(unmet.measured.starts_with("97.297% of 111 messages, crowded 1"));
  CHECK(unmet.explain == std::vector<std::string>{"--lost", "--from", "kitchen/climate-7"});
  auto x = sample_report();
  x.islands[0].motes[0].messages.in_transit = 1;
  x.islands[0].motes[0].messages.lost = {{"gave_up", 1}};
  CHECK(one(delivery_expectation{of_climate_7, 0.98}).met(x));
  CHECK(one(delivery_expectation{of_kitchen, 0.97}).met());
  const mote_scope silent{"kitchen/climate-8", island_id{3}, mote_id{8}};
  CHECK(one(delivery_expectation{silent, 0}).result().measured == "no message was offered");
  CHECK_FALSE(one(delivery_expectation{silent, 0}).met());
}

TEST_CASE("of reliable messages those refused are not acknowledged", "[report][expect]") {
  CHECK(one(acknowledged_expectation{of_climate_7, 0.98}).met()); // 99 of 101
  CHECK_FALSE(one(acknowledged_expectation{of_climate_7, 0.99}).met());
}

TEST_CASE("a stream is judged by what its writer produced", "[report][expect]") {
  const mote_address robot{island_id{100}, no_mote};
  CHECK(one(stream_expectation{7, robot, "robot", 0.97, {}}).met()); // 585 of 599
  CHECK_FALSE(one(stream_expectation{7, robot, "robot", 0.98, {}}).met());
  CHECK_FALSE(one(stream_expectation{8, robot, "robot", 0, {}}).met());
  auto x = sample_report();
  x.streams[0].pause = 30s;
  CHECK(one(stream_expectation{7, robot, "robot", 0.97, 30s}).met(x));
  CHECK_FALSE(one(stream_expectation{7, robot, "robot", 0.97, 29s}).met(x));
  x.streams[0].first_after = 31s; // that is a pause as well,
  CHECK_FALSE(one(stream_expectation{7, robot, "robot", 0.97, 30s}).met(x));
  CHECK(one(stream_expectation{7, robot, "robot", 0.97, 30s, 31s}).met(x)); // or one of its own
  CHECK_FALSE(one(stream_expectation{7, robot, "robot", 0.97, {}, 30s}).met(x));
  CHECK(one(stream_expectation{7, robot, "robot", 0.97, {}}).met(x));
  CHECK(to_text(stream_expectation{7, robot, "robot", 1, 10s, 30s}) ==
        "stream 7 to robot >= 100%, no pause > 10 s, the first within 30 s");
}

TEST_CASE("actuations are judged together or of one proxy, and must have been",
          "[report][expect]") {
  CHECK(one(actuations_expectation{"*", 5, 0.8}).met()); // 4 of 5
  CHECK_FALSE(one(actuations_expectation{"*", 6, 0.8}).met());
  CHECK_FALSE(one(actuations_expectation{"*", 1, 0.81}).met());
  CHECK(one(actuations_expectation{"Kitchen.Lamp-9", 1, 0.8}).met());
  CHECK_FALSE(one(actuations_expectation{"kitchen.climate-7", 1, 0}).met());
}

TEST_CASE("a tuple follows another in time, each time", "[report][expect]") {
  one x(lamp_follows_door());
  CHECK(x.judge.watches_tuples());
  CHECK_FALSE(x.judge.next_sample());
  CHECK(x.result().measured == "the condition never became true");
  CHECK_FALSE(x.met());
  x.judge.on_tuple("kitchen.door", "open", at(10s));
  x.judge.on_tuple("kitchen.door", "open", at(12s)); // said again, not opened again
  x.judge.on_tuple("bedroom.lamp.state", "off", at(14s));
  x.judge.on_tuple("Bedroom.Lamp.STATE", "on", at(15s));
  CHECK(x.met());
  CHECK(x.result().measured == "1 time, the slowest 5.000 s");
  x.judge.on_tuple("kitchen.door", "closed", at(20s));
  x.judge.on_tuple("kitchen.door", "open", at(30s)); // it is on
  CHECK(x.result().measured == "2 times, the slowest 5.000 s");
  x.judge.on_tuple_gone("bedroom.lamp.state", at(31s));
  x.judge.on_tuple("kitchen.door", "closed", at(32s));
  x.judge.on_tuple("kitchen.door", "open", at(598s)); // too late to judge
  CHECK(x.met());
  x.judge.on_tuple("bedroom.lamp.state", "on", instant{} + 598s + 5s + 1ns);
  const auto unmet = x.result();
  CHECK(unmet.outcome == verdict::unmet);
  CHECK(unmet.at == at(603s));
  CHECK(unmet.measured == "due since 598.000 s: not met until 603.000 s; 2 of 3 times");
  CHECK(unmet.explain == std::vector<std::string>{"kitchen.door", "--at", "598001ms"});
}

TEST_CASE("a tuple that never comes is missed when nobody says anything more", "[report][expect]") {
  one x(lamp_follows_door());
  x.judge.on_tuple("kitchen.door", "open", at(10s));
  CHECK(x.result().at == at(15s));
  CHECK_FALSE(x.met());
}

TEST_CASE("a tuple may be expected within a time from the start, by its number",
          "[report][expect]") {
  const tuple_condition warm{"a.b", {}, 20, 30};
  one late(tuple_expectation{{}, warm, 1min});
  late.judge.on_tuple("a.b", "19.9", at(1s));
  late.judge.on_tuple("a.b", "30", at(2s));
  late.judge.on_tuple("a.b", "25 C", at(3s));
  CHECK_FALSE(late.met());
  late.judge.on_tuple("a.b", "20", at(61s));
  CHECK(late.result().at == at(1min));
  one soon(tuple_expectation{{}, warm, 1min});
  soon.judge.on_tuple("a.b", "20", at(60s));
  CHECK(soon.met());
  auto shortened = sample_report();
  shortened.simulated = 30s;
  CHECK(one(tuple_expectation{{}, warm, 1min}).result(shortened).outcome == verdict::unjudged);
}

TEST_CASE("clocks are compared from a time on, and each counts", "[report][expect]") {
  one x(clock_expectation{{}, 1ms, 0.5, 1min, 10s});
  CHECK(x.judge.next_sample() == at(1min));
  x.judge.on_clock(climate_7, "kitchen/climate-7", 5ms, at(59s));
  CHECK(x.result().measured == "no mote's clock was ever compared");
  CHECK_FALSE(x.met());
  x.judge.on_sample(at(1min));
  CHECK(x.judge.next_sample() == at(70s));
  x.judge.on_clock(climate_7, "kitchen/climate-7", 1ms, at(1min));
  x.judge.on_clock(climate_7, "kitchen/climate-7", 2ms, at(70s));
  CHECK(x.met());
  x.judge.on_clock(climate_7, "kitchen/climate-7", 3ms, at(80s));
  const auto unmet = x.result();
  CHECK(unmet.outcome == verdict::unmet);
  CHECK(unmet.at == at(70s));
  CHECK(unmet.measured == "33.333% of 3 samples, worst 3 ms (kitchen/climate-7 at 1:20.000)");
  for (int i = 0; i < 100; ++i)
    x.judge.on_sample(at(i * 10s));
  CHECK_FALSE(x.judge.next_sample()); // the run is over
}

TEST_CASE("motes are to join in time, and to stay", "[report][expect]") {
  one x(joined_expectation{of_kitchen, 20s});
  x.judge.on_joined(climate_7, at(3s));
  x.judge.on_joined({island_id{3}, mote_id{8}}, at(20s));
  x.judge.on_joined({island_id{3}, mote_id{9}}, at(21s));
  const auto unmet = x.result();
  CHECK(unmet.outcome == verdict::unmet);
  CHECK(unmet.at == at(20s));
  CHECK(unmet.measured == "kitchen/lamp-9 at 0:21.000; 1 of 3 motes late");
  one again(joined_expectation{of_climate_7, 20s});
  again.judge.on_joined(climate_7, at(3s));
  again.judge.on_joined(climate_7, at(300s));
  CHECK(again.met());
  CHECK_FALSE(one(members_expectation{of_kitchen, {}}).met()); // the lamp's battery is flat
  CHECK(one(members_expectation{of_kitchen, 2}).met());
  auto shortened = sample_report();
  shortened.simulated = 10s;
  CHECK(one(joined_expectation{of_kitchen, 20s}).result(shortened).outcome == verdict::unjudged);
}

TEST_CASE("batteries and radios are judged by the worst", "[report][expect]") {
  CHECK(one(battery_expectation{of_kitchen, 0.998}).met()); // 3.301 of 2500 mAh
  CHECK_FALSE(one(battery_expectation{of_kitchen, 0.9987}).met());
  CHECK(one(battery_expectation{of_kitchen, 0.9987}).result().measured ==
        "99.867% (kitchen/climate-7)");
  CHECK_FALSE(one(radio_expectation{{}, 0.05}).met());
  auto x = sample_report();
  for (auto& island : x.islands)
    for (auto& mote : island.motes)
      mote.energy.radio_off = 100 * 600s;
  CHECK(one(radio_expectation{{}, 0.05}).met(x));
}

TEST_CASE("vectors missed before a time do not count", "[report][expect]") {
  auto run = sample_report();
  run.programs = {{"hall/n-2", "reservoir", {{"vectors updated", 90}, {"vectors missed", 10}}},
                  {"learner", "readout", {{"vectors updated", 95}, {"vectors missed", 5}}}};
  CHECK_FALSE(one(vectors_expectation{}).met(run));
  CHECK(one(vectors_expectation{"*", 15, {}}).met(run));
  one x(vectors_expectation{"*", 4, 2min});
  CHECK(x.judge.next_sample() == at(2min));
  x.judge.on_vectors("hall/n-2", 1, 10, at(2min));
  x.judge.on_vectors("learner", 1, 1, at(2min));
  x.judge.on_sample(at(2min));
  CHECK_FALSE(x.judge.next_sample());
  x.judge.on_vectors("learner", 1, 5, at(3min)); // asked for somebody else
  CHECK(x.met(run));
  CHECK(x.result(run).measured == "4 missed, 185 updated; most at learner: 4");
  CHECK_FALSE(one(vectors_expectation{"nobody", 0, {}}).met(run));
}

TEST_CASE("events and lines of the event log are counted", "[report][expect]") {
  CHECK(one(events_expectation{123'456}).met());
  CHECK_FALSE(one(events_expectation{123'455}).met());
  CHECK(one(event_log_expectation{"joined", "", 2, 2}).met());
  CHECK_FALSE(one(event_log_expectation{"joined", "lamp", 2, {}}).met());
  CHECK_FALSE(one(event_log_expectation{"left", "", 0, 0}).met());
}

TEST_CASE("lines of the event log count that the report has left out", "[report][expect]") {
  auto x = one(event_log_expectation{"left", "lamp", 3, 3});
  auto run = sample_report();
  run.event_log.clear();
  for (int i = 0; i < 3; ++i)
    x.judge.on_event({at(i * 1s), "kitchen/lamp-9", "left: battery"});
  x.judge.on_event({at(4s), "kitchen/lamp-9", "joined"});
  x.judge.on_event({at(5s), "kitchen/fan", "left: silence"});
  CHECK(x.met(run));
  CHECK(x.result(run).measured == "3 lines, the last at 0:02.000");
}

TEST_CASE("a run that does not come into a situation has done nothing wrong", "[report][expect]") {
  const sometimes_expectation gone{"a lamp leaves", {"left", "lamp"}, {}, {}, 1s};
  one x(gone);
  x.judge.on_event({at(1s), "kitchen/fan", "left: silence"});
  CHECK(x.result().text == "sometimes a lamp leaves");
  CHECK(x.result().outcome == verdict::unjudged);
  CHECK(x.result().measured == "not reached");
  x.judge.on_event({at(2s), "kitchen/lamp-9", "left: battery"});
  x.judge.on_event({at(3s), "kitchen/lamp-9", "left: battery"});
  CHECK(x.met());
  CHECK(x.result().measured == "reached 2 times, the first at 0:02.000");
  CHECK(x.result().at == at(2s));
}

TEST_CASE("a situation may need a tuple at that moment and a line before", "[report][expect]") {
  const tuple_condition on{"kitchen.lamp", {"on"}, {}, {}};
  one during(sometimes_expectation{"n", {"left", ""}, on, {}, 1s});
  CHECK(during.judge.watches_tuples());
  during.judge.on_event({at(1s), "a", "left: battery"});
  during.judge.on_tuple("Kitchen.Lamp", "on", at(2s));
  CHECK_FALSE(during.met());
  during.judge.on_tuple_gone("kitchen.lamp", at(3s));
  during.judge.on_event({at(4s), "a", "left: battery"});
  CHECK_FALSE(during.met());
  during.judge.on_tuple("kitchen.lamp", "on", at(5s));
  during.judge.on_event({at(6s), "a", "left: battery"});
  CHECK(during.met());

  one after(sometimes_expectation{"n", {"left", ""}, {}, event_line{"left", "b"}, 2s});
  CHECK_FALSE(after.judge.watches_tuples());
  after.judge.on_event({at(1s), "b", "left: battery"}); // not after itself
  after.judge.on_event({at(4s), "a", "left: battery"}); // too late
  CHECK_FALSE(after.met());
  after.judge.on_event({at(5s), "b", "left: battery"});
  after.judge.on_event({at(7s), "a", "left: battery"});
  CHECK(after.result().measured == "reached 1 time, the first at 0:07.000");

  one alone(sometimes_expectation{"n", {}, on, {}, 1s});
  alone.judge.on_tuple("kitchen.lamp", "on", at(2s));
  alone.judge.on_tuple("kitchen.lamp", "on", at(3s)); // it was so already
  CHECK(alone.result().measured == "reached 1 time, the first at 0:02.000");
}

TEST_CASE("a run that broke off is not judged", "[report][expect]") {
  auto x = sample_report();
  x.interrupted = true;
  CHECK(one(events_expectation{1}).result(x).outcome == verdict::unjudged);
  x = sample_report();
  x.complete = false;
  CHECK(one(events_expectation{1}).result(x).outcome == verdict::unjudged);
}

TEST_CASE("what is not met is a violation with its command", "[report][expect]") {
  expectation_report x{"events <= 1", verdict::unmet, "2 events", at(3s), {}, "rubicon run a.toml"};
  const auto found = violation_of(x);
  CHECK(found.at == at(3s));
  CHECK(found.invariant == "expected: events <= 1");
  CHECK(found.detail == "2 events; rubicon run a.toml");
}
