#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/codec.hpp"
#include "core/tuples/device_keys.hpp"
#include "proxy/proxy.hpp"
#include "support/catch.hpp"
#include "unit/proxy/fixture.hpp"

using namespace rubicon;
using namespace rubicon::test;

TEST_CASE("values that are not renewed are marked stale", "[proxy][PXY-20]") {
  proxy_settings settings;
  settings.stale_after = 10s;
  auto aut = started(settings);
  CHECK_FALSE(aut.deadline());
  CHECK(lines_of(aut.on_output(2, bytes{1}, start)) ==
        lines{base + "state = on", base + "state.freshness = fresh"});
  CHECK(lines_of(aut.on_output(1, bytes{0x00, 0xdf, 45}, start + 5s)) ==
        lines{base + "temperature = 22.3", base + "humidity = 45",
              base + "temperature.freshness = fresh", base + "humidity.freshness = fresh"});
  CHECK(lines_of(aut.on_output(2, bytes{0}, start + 6s)) == lines{base + "state = off"});
  CHECK(aut.deadline() == start + 15s);
  CHECK(lines_of(aut.on_time(start + 15s)) ==
        lines{base + "temperature.freshness = stale", base + "humidity.freshness = stale"});
  CHECK(lines_of(aut.on_time(start + 16s)) == lines{base + "state.freshness = stale"});
  CHECK_FALSE(aut.deadline());
  CHECK(lines_of(aut.on_output(2, bytes{0}, start + 20s)) ==
        lines{base + "state = off", base + "state.freshness = fresh"});
}

TEST_CASE("a field is read from a stream", "[proxy][PXY-18]") {
  auto what = climate();
  what.settings.stale_after = 10s;
  proxy::field outside;
  outside.name = "outside";
  outside.scale = 0.1;
  outside.stream = proxy::stream_input{2, 3s};
  what.fields.push_back(outside);
  face aut(what, identity());
  static_cast<void>(aut.start(start));
  const auto read = streams_of(aut.what());
  REQUIRE(read.size() == 1);
  CHECK(read.front().number == 2);
  CHECK(read.front().every == 3s);
  CHECK(aut.watches().size() == face(climate(), identity()).watches().size());
  CHECK(lines_of(aut.on_record(2, -15, 0, start)) ==
        lines{base + "outside = -1.5", base + "outside.freshness = fresh"});
  CHECK(aut.on_record(7, 1, 0, start).empty());             // of no field
  CHECK(lines_of(aut.on_output(2, bytes{1}, start + 5s)) == // channel 2 is not stream 2
        lines{base + "state = on", base + "state.freshness = fresh"});
  CHECK(lines_of(aut.on_time(start + 10s)) == lines{base + "outside.freshness = stale"});
}

TEST_CASE("readings have a latency, learned from the times that they hold", "[proxy][IF-05]") {
  auto what = climate();
  what.stamped_channels = {1};
  face aut(what, identity());
  static_cast<void>(aut.start(start));
  CHECK(reads_times(what));
  constexpr duration ahead = 24h * 20000 + 7ms;
  const auto message = [&](instant at) {
    byte_writer out;
    out.append(bytes{0x00, 0xdf, 45});
    out.big(static_cast<std::uint32_t>((at.time_since_epoch() + ahead) / 1ms));
    return out.finish();
  };
  const lines readings{base + "temperature = 22.3", base + "humidity = 45"};
  auto now = start + 1min;
  CHECK(lines_of(aut.on_output(1, message(now - 1s), now)) ==
        readings); // the time is not known yet
  CHECK_FALSE(aut.reading_latency());
  aut.on_clock(ahead);
  auto first = readings; // 100 ms and four deviations of half of it, and a quarter more
  first.push_back(base + "temperature.latency = 0.375000");
  first.push_back(base + "humidity.latency = 0.375000");
  CHECK(lines_of(aut.on_output(1, message(now - 100ms), now)) == first);
  CHECK(aut.reading_latency() == 375ms);

  SECTION("it is published again when it has halved") {
    std::size_t published = 0;
    for (int i = 0; i < 100; ++i)
      published += lines_of(aut.on_output(1, message(now - 100ms), now += 10s)).size() > 2 ? 1 : 0;
    CHECK(published == 1);
    CHECK(*aut.reading_latency() > 125ms);
    CHECK(*aut.reading_latency() <= 188ms);
    CHECK(aut.counters().late == 0);
  }
  SECTION("what is older than it is counted, and widens it") {
    const auto late = lines_of(aut.on_output(1, message(now - 400ms), now));
    CHECK(late.size() == 4);
    CHECK(*aut.reading_latency() > 400ms);
    CHECK(aut.counters().late == 1);
  }
  SECTION("a time that is not the network's says nothing") {
    for (const duration wrong : {duration(-1h - 1ms), duration(12ms), duration(-24h * 20)})
      CHECK(lines_of(aut.on_output(1, message(now + wrong), now)) == readings);
    CHECK(aut.counters().other_times == 3);
    CHECK(aut.reading_latency() == 375ms);
  }
  SECTION("a message without a time behind its fields is one without") {
    CHECK(lines_of(aut.on_output(1, bytes{0x00, 0xdf, 45}, now)) == readings);
    CHECK(aut.counters().other_times == 0);
  }
}

TEST_CASE("a period is asked for whenever the mote is listed", "[proxy][GW-10][IF-04]") {
  proxy_settings settings;
  settings.period = 2500ms;
  auto aut = started(settings);
  const auto watches = aut.watches();
  CHECK(watches.back() == watch{watch::source::gateway, device_status_key(mote_id{7}), {}});
  const auto says = [&aut](std::string_view text) {
    return lines_of(aut.on_gateway_tuple(device_status_key(mote_id{7}), to_bytes(text), start));
  };
  const lines asks{"period devices.7.output.1.period 2500",
                   "period devices.7.output.2.period 2500"};
  CHECK(says("listed 3.000000") == asks);
  CHECK(says("left silence 4.000000").empty());
  CHECK(says("listed 5.000000") == asks);
  CHECK(says("here").empty());
  CHECK(aut.counters().bad_statuses == 1);

  auto without = started();
  CHECK(without.watches().size() + 1 == watches.size());
}

TEST_CASE("indirect information is of the interface, a position perhaps of the table",
          "[proxy][PXY-06][PXY-05]") {
  auto what = climate();
  what.indirect = true;
  auto who = identity();
  who.interface_name = "kitchen-gateway";
  who.interface_place = position{1, 2, 3};
  const auto about = [](const lines& all) {
    lines out;
    for (const auto& x : all)
      if (x.find(".interface") != std::string::npos || x.find(".position") != std::string::npos)
        out.push_back(x.substr(base.size()));
    return out;
  };
  SECTION("of the interface alone") {
    face aut(what, who);
    CHECK(about(lines_of(aut.start(start))) == lines{"interface = kitchen-gateway",
                                                     "position.accuracy = interface",
                                                     "position = 1.00 2.00 3.00"});
    CHECK(about(lines_of(aut.on_presence(device_presence::left, "silence", start + 1s))) ==
          lines{"interface = none", "position.accuracy = unknown", "position = unknown"});
    CHECK(about(lines_of(aut.on_presence(device_presence::left, "battery", start + 2s))).empty());
    CHECK(about(lines_of(aut.on_presence(device_presence::listed, {}, start + 3s))).size() == 3);
    CHECK(about(lines_of(aut.on_presence(device_presence::stale, {}, start + 4s))).empty());
  }
  SECTION("of the table") {
    what.objects = {{"5/8", "", {}, position{9, 9, 9}},
                    {"5/7", "", {{"shelf", "upper"}}, position{4, 5, 6}}};
    face aut(what, who);
    const auto first = lines_of(aut.start(start));
    CHECK(std::ranges::count(first, base + "shelf = upper") == 1);
    CHECK(about(first) == lines{"interface = kitchen-gateway", "position.accuracy = prior",
                                "position = 4.00 5.00 6.00"});
    CHECK(about(lines_of(aut.on_presence(device_presence::left, "silence", start + 1s))) ==
          lines{"interface = none", "position.accuracy = prior", "position = 4.00 5.00 6.00"});
  }
  SECTION("not unless the class says so") {
    CHECK(about(lines_of(face(climate(), who).start(start))).empty());
  }
}

TEST_CASE("a proxy computes the mean that its class wants, unless the mote does",
          "[proxy][PXY-17]") {
  auto what = climate();
  what.fields[0].mean_of = 3;
  const auto temperatures = [&what] {
    face aut(what, identity());
    static_cast<void>(aut.start(start));
    lines out;
    for (const std::uint8_t count : bytes{10, 20, 41, 40})
      out.push_back(lines_of(aut.on_output(1, bytes{0, count, 45}, start)).front());
    return out;
  };
  const auto key = base + "temperature = ";
  CHECK(temperatures() == lines{key + "1.0", key + "1.5", key + "2.4", key + "3.4"});
  what.fields[0].computed_by_mote = true;
  CHECK(temperatures() == lines{key + "1.0", key + "2.0", key + "4.1", key + "4.0"});
}

TEST_CASE("an input of numbers publishes its range and its unit", "[proxy][PXY-12]") {
  auto what = climate();
  what.inputs = {{"level", 2, {}}};
  what.inputs[0].numbers = rubicon::proxy::number_form{encoding::u8, 0.5, 0, 0, 100.25};
  what.inputs[0].unit = "%";
  face aut(what, identity());
  const auto all = lines_of(aut.start(start));
  CHECK(std::ranges::count(all, base + "level.range = 0 100.25") == 1);
  CHECK(std::ranges::count(all, base + "level.unit = %") == 1);
  CHECK(std::ranges::count_if(
            all, [](const auto& x) { return x.find("level.words") != std::string::npos; }) == 0);
  CHECK(lines_of(aut.on_input("level", "50", start)) == lines{"write 5/7 devices.7.input.2 64"});
  CHECK(lines_of(aut.on_input("level", "101", start)) ==
        lines{base + "level.outcome = 101 refused"});
}

TEST_CASE("a proxy goes by its class as it is now", "[proxy][ACT-10]") {
  auto what = climate();
  what.settings.stale_after = 10s;
  what.settings.inactive_after = 30s;
  face aut(what, identity());
  static_cast<void>(aut.start(start));
  static_cast<void>(aut.on_output(1, bytes{0, 200, 45}, start));
  const auto watches = aut.watches();
  const auto changed = [&aut](auto set) {
    rubicon::proxy::class_change x;
    x.class_name = "climate";
    set(x);
    return lines_of(aut.on_class_changed(x));
  };

  SECTION("its period is asked for at once, and again") {
    CHECK(changed([](auto& x) {
            x.settings = {{"period", duration(2s)}};
          }) ==
          lines{"period devices.7.output.1.period 2000", "period devices.7.output.2.period 2000"});
    const auto more = aut.watches();
    REQUIRE(more.size() == watches.size() + 1);
    CHECK(std::equal(watches.begin(), watches.end(), more.begin()));
    CHECK(lines_of(aut.on_gateway_tuple(device_status_key(mote_id{7}), to_bytes("listed 3.000000"),
                                        start))
              .size() == 2);
  }
  SECTION("its fields are read in another form") {
    CHECK(changed([](auto& x) {
            x.field = "temperature";
            x.field_settings = {{"unit", "K"}, {"add", 273.15}, {"decimals", std::int64_t{2}}};
          }) == lines{base + "temperature.unit = K"});
    CHECK(lines_of(aut.on_output(1, bytes{0, 200, 45}, start)).front() ==
          base + "temperature = 293.15");
  }
  SECTION("what was read is stale at another time") {
    CHECK(changed([](auto& x) { x.settings = {{"stale_after", duration(3s)}}; }).empty());
    CHECK(aut.deadline() == start + 3s);
    CHECK(lines_of(aut.on_time(start + 3s)).front() == base + "temperature.freshness = stale");
  }
  SECTION("it becomes inactive at another time") {
    static_cast<void>(aut.on_time(start + 10s)); // stale
    CHECK(aut.deadline() == start + 30s);
    CHECK(changed([](auto& x) { x.settings = {{"inactive_after", duration(1min)}}; }).empty());
    CHECK(aut.deadline() == start + 1min);
  }
  SECTION("what is written has another deadline") {
    CHECK(changed([](auto& x) {
            x.settings = {{"answer_timeout", duration(5s)}};
          }) == lines{base + "switch.deadline = 10.000000", base + "switch.latency = 10.000000",
                      base + "led.deadline = 10.000000", base + "led.latency = 10.000000"});
    static_cast<void>(aut.on_input("switch", "on", start + 1s));
    CHECK(lines_of(aut.on_time(start + 6s)).back() == base + "switch.outcome = on timeout");
  }
}

TEST_CASE("writes after the first of a request are counted", "[proxy][PXY-12]") {
  auto what = climate();
  what.settings.answer_timeout = 5s;
  what.settings.retry_for = 1min;
  face aut(what, identity());
  static_cast<void>(aut.start(start));
  static_cast<void>(aut.on_input("switch", "on", start));
  CHECK(aut.counters().retries == 0);
  static_cast<void>(aut.on_time(start + 5s)); // no answer
  static_cast<void>(aut.on_time(start + 6s)); // written again
  CHECK(aut.counters().retries == 1);
  CHECK(aut.counters().requested == 1);
}
