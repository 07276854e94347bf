#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers/random.hpp"
#include "core/tuples/device_keys.hpp"
#include "proxy/proxy.hpp"
#include "support/catch.hpp"
#include "unit/proxy/fixture.hpp"

using namespace rubicon;
using namespace rubicon::test;

TEST_CASE("a proxy starts with what it knows already", "[proxy][PXY-05][PXY-06][PXY-12][PXY-16]") {
  face aut(climate(), identity());
  CHECK(aut.prefix() == "kitchen.climate-7");
  CHECK(lines_of(aut.start(start)) ==
        lines{base + "class = climate", base + "id = 5/7", base + "island = kitchen",
              base + "colour = white", base + "size.height = 0.1 m", base + "temperature.unit = C",
              base + "humidity.unit = %", base + "switch.words = on off",
              base + "switch.deadline = 40.000000", base + "switch.latency = 40.000000",
              base + "switch = none", base + "led.words = red", base + "led.deadline = 40.000000",
              base + "led.latency = 40.000000", base + "led = none"} +
            became("active"));
  CHECK_FALSE(aut.deadline());
}

TEST_CASE("a proxy watches its inputs and its mote's channels, each once",
          "[proxy][PXY-12][PXY-14]") {
  using source = watch::source;
  CHECK(started().watches() ==
        std::vector<watch>{{source::own, base + "switch", "switch"},
                           {source::own, base + "led", "led"},
                           {source::gateway, "devices.7.output.1", ""},
                           {source::gateway, "devices.7.output.2", ""},
                           {source::gateway, "devices.7.input.2.status", ""},
                           {source::gateway, "devices.7.input.3.status", ""}});
}

TEST_CASE("a stamp is the whole network time, as far as its 32 bits go and beyond",
          "[proxy][PXY-04]") {
  auto what = climate();
  CHECK_FALSE(reads_times(what));
  what.fields = {{"time", 1, 2, encoding::stamp, 0.001, 0, 3, "s", {}}};
  face aut(what, identity());
  CHECK(reads_times(what));
  const auto at = [&](std::int64_t ms, instant now) {
    bytes octets{0, 0};
    for (int shift = 24; shift >= 0; shift -= 8)
      octets.push_back(static_cast<std::uint8_t>(ms >> shift));
    return lines_of(aut.on_output(1, octets, now));
  };
  static_cast<void>(aut.start(start));
  constexpr std::int64_t wrap = 1LL << 32;
  CHECK(at(700 * wrap - 1, start) == lines{base + "time = 4294967.295"}); // the rest is not known
  aut.on_clock(std::chrono::milliseconds(500 * wrap));
  CHECK(at(500 * wrap - 1, start) == lines{base + "time = 2147483647.999"});
  CHECK(at(500 * wrap + 1, start) == lines{base + "time = 2147483648.001"});
  CHECK(at(501 * wrap + 5, start + std::chrono::milliseconds(wrap)) ==
        lines{base + "time = 2151778615.301"});
}

TEST_CASE("a proxy consumes percepts of its own mote alone", "[proxy][PXY-08]") {
  const auto aut = started();
  CHECK(aut.consumes(signature_of({island_id{5}, mote_id{7}}, 142)));
  CHECK_FALSE(aut.consumes(signature_of({island_id{5}, mote_id{8}}, 142)));
  CHECK_FALSE(aut.consumes(signature_of({island_id{6}, mote_id{7}}, 142)));
  CHECK_FALSE(aut.consumes(signature{"rfid", "5/7", 142}));
}

TEST_CASE("every message is published as readings, equal ones too", "[proxy][PXY-04][CB-01]") {
  auto aut = started();
  CHECK(aut.values().empty());
  for (int i = 0; i < 2; ++i)
    CHECK(lines_of(aut.on_output(1, bytes{0x00, 0xdf, 45}, start)) ==
          lines{base + "temperature = 22.3", base + "humidity = 45"});
  CHECK(lines_of(aut.on_output(2, bytes{1}, start)) == lines{base + "state = on"});
  CHECK(aut.values() == std::vector<std::pair<std::string, std::string>>{
                            {"humidity", "45 %"}, {"state", "on"}, {"temperature", "22.3 C"}});
  CHECK(aut.counters().messages == 3);
}

TEST_CASE("messages that do not fit the class are counted and not published", "[proxy][PXY-04]") {
  auto aut = started();
  CHECK(aut.on_output(1, bytes{0x00, 0xdf}, start).empty());
  CHECK(aut.on_output(2, bytes{}, start).empty());
  CHECK(aut.on_output(9, bytes{1}, start).empty());
  CHECK(aut.counters().short_messages == 2);
  CHECK(aut.counters().unread_messages == 1);
  CHECK(aut.counters().messages == 0);
  CHECK(aut.values().empty());
}

TEST_CASE("a word written to an input reaches the mote and has an outcome", "[proxy][PXY-12]") {
  for (const std::string outcome : {"acknowledged", "failed", "unreachable"}) {
    auto aut = started();
    CHECK(lines_of(aut.on_input("switch", "on", start)) == lines{"write 5/7 devices.7.input.2 01"});
    CHECK(aut.open_requests() == 1);
    CHECK(aut.on_input_status(2, "1 pending", start).empty());
    auto expected = lines{base + "switch.outcome = on " + outcome};
    if (outcome == "acknowledged")
      expected = expected + lines{base + "switch.latency = 0.000000"};
    CHECK(lines_of(aut.on_input_status(2, "1 " + outcome, start)) == expected);
    CHECK(aut.open_requests() == 0);
    CHECK(aut.counters().requested == 1);
    CHECK(aut.counters().acknowledged == (outcome == "acknowledged" ? 1 : 0));
    CHECK(aut.counters().failed.count(outcome) == (outcome == "acknowledged" ? 0 : 1));
  }
}

TEST_CASE("channels do not wait for each other", "[proxy][PXY-12]") {
  auto aut = started();
  CHECK(aut.on_input("switch", "on", start).size() == 1);
  CHECK(lines_of(aut.on_input("led", "red", start)) == lines{"write 5/7 devices.7.input.3 0102"});
  CHECK(aut.on_input("switch", "off", start).empty());
  CHECK(lines_of(aut.on_input("switch", "on", start)) ==
        lines{base + "switch.outcome = off superseded"});
  CHECK(aut.open_requests() == 3);
  static_cast<void>(aut.on_input_status(2, "1 pending", start));
  CHECK(lines_of(aut.on_input_status(2, "1 failed", start)) ==
        lines{base + "switch.outcome = on failed", "write 5/7 devices.7.input.2 01"});
}

TEST_CASE("an unknown word is refused and not written", "[proxy][PXY-12]") {
  auto aut = started();
  CHECK(lines_of(aut.on_input("switch", "dim", start)) ==
        lines{base + "switch.outcome = dim refused"});
  for (const auto& strange :
       {std::string(65, 'x'), std::string("a b"), std::string("\x80"), std::string("o\0n", 3)})
    CHECK(lines_of(aut.on_input("switch", strange, start)) ==
          lines{base + "switch.outcome = ? refused"});
  CHECK(aut.counters().requested == 5);
  CHECK(aut.counters().failed.at("refused") == 5);
  CHECK(aut.open_requests() == 0);
}

TEST_CASE("the marker of an unset input asks for nothing", "[proxy][PXY-12][META-03]") {
  auto aut = started();
  CHECK(aut.on_input("switch", "none", start).empty());
  CHECK(aut.on_input("switch", "", start).empty());
  CHECK(aut.counters().requested == 0);
  CHECK(aut.on_input("handle", "on", start).empty());
  CHECK(aut.counters().foreign_tuples == 1);
  auto what = climate();
  what.inputs = {{"light", 2, {{"none", {0}}, {"full", {1}}}}};
  face lamp(what, identity());
  CHECK(lines_of(lamp.on_input("light", "none", start)) == lines{"write 5/7 devices.7.input.2 00"});
}

TEST_CASE("an input that may be any tuple is the one that its meta tuple points at",
          "[proxy][META-04][META-05][PXY-12]") {
  auto what = climate();
  what.inputs[0].meta = true;
  face aut(what, identity());
  const auto out = lines_of(aut.start(start));
  const auto has = [&](const std::string& line) { return std::ranges::count(out, line) == 1; };
  CHECK(has(base + "mi-switch -> " + base + "switch")); // at first its own
  CHECK(has(base + "switch = none"));
  CHECK(std::ranges::none_of(out, [](const auto& x) { return x.find("mi-led") < x.size(); }));
  const auto list = aut.watches();
  CHECK(list[0] == watch{watch::source::meta, base + "mi-switch", "switch"});
  CHECK(list[1] == watch{watch::source::own, base + "led", "led"});
  // Words are the same, whichever tuple they are of.
  CHECK(lines_of(aut.on_input("switch", "on", start)) == lines{"write 5/7 devices.7.input.2 01"});

  what.prefix = std::string(110, 'x') + ".y";
  what.inputs[0].name = "switchswitchsw"; // mi-NAME is over the limit, NAME is not
  face longer(what, identity());
  const auto before = longer.counters().bad_keys;
  for (const auto& line : lines_of(longer.start(start)))
    CHECK(line.find("mi-") == std::string::npos);
  CHECK(longer.counters().bad_keys > before);
}

TEST_CASE("what a request is expected to take is estimated from those before it",
          "[proxy][IF-07]") {
  auto aut = started();
  std::uint64_t number = 0;
  const auto take = [&](duration taken) {
    const auto asked = start + ++number * 1min;
    static_cast<void>(aut.on_input("switch", number % 2 == 0 ? "off" : "on", asked));
    static_cast<void>(aut.on_input_status(2, std::to_string(number) + " pending", asked));
    auto lines =
        lines_of(aut.on_input_status(2, std::to_string(number) + " acknowledged", asked + taken));
    REQUIRE(!lines.empty());
    lines.erase(lines.begin());
    return lines;
  };
  CHECK(take(20ms) == lines{base + "switch.latency = 0.060000"});
  std::size_t published_again = 0;
  for (int i = 0; i < 10; ++i)
    published_again += take(20ms).size();
  CHECK(published_again == 1); // when it has fallen below half of it
  CHECK(take(1s).size() == 1);
  CHECK(take(15s).size() == 1);
  CHECK(take(20s).size() == 1);
  CHECK(take(20s) == lines{base + "switch.latency = 40.000000"}); // never beyond the deadline
}

TEST_CASE("a request the gateway leaves alone times out", "[proxy][PXY-12][IF-07]") {
  auto aut = started();
  static_cast<void>(aut.on_input("switch", "on", start + 1s));
  static_cast<void>(aut.on_input("led", "red", start + 3s));
  CHECK(aut.deadline() == start + 21s);
  CHECK(aut.on_time(start + 20s).empty());
  CHECK(lines_of(aut.on_time(start + 21s)) == lines{base + "switch.outcome = on timeout"});
  CHECK(aut.deadline() == start + 23s);
  CHECK(lines_of(aut.on_time(start + 30s)) == lines{base + "led.outcome = red timeout"});
  CHECK(aut.counters().failed.at("timeout") == 2);
  CHECK_FALSE(aut.deadline());
}

TEST_CASE("a request waits as much longer as the mote's radio sleeps", "[proxy][PXY-12][IF-07]") {
  face aut(climate(), identity(), 100s);
  static_cast<void>(aut.start(start));
  static_cast<void>(aut.on_input("switch", "on", start + 1s));
  CHECK(aut.deadline() == start + 121s);
  CHECK(lines_of(aut.on_time(start + 121s)) == lines{base + "switch.outcome = on timeout"});
  const auto shorter = aut.on_class_changed(
      {.class_name = "climate", .settings = {{"answer_timeout", duration(5s)}}});
  CHECK(lines_of(shorter).at(0) == base + "switch.deadline = 210.000000");
}

TEST_CASE("a lost mote shows, and the same proxy carries on when it returns",
          "[proxy][PXY-15][PXY-16]") {
  auto aut = started();
  CHECK(aut.on_presence(device_presence::listed, {}, start).empty());
  const auto cause = GENERATE("not_listed", "gateway_gone");
  for (int i = 0; i < 3; ++i) {
    CHECK(lines_of(aut.on_presence(device_presence::left, cause, start)) == became("lost", cause));
    CHECK(aut.on_presence(device_presence::left, cause, start).empty());
    CHECK(aut.status() == face::state::lost);
    CHECK(lines_of(aut.on_presence(device_presence::listed, {}, start)) == became("active"));
    CHECK(aut.on_presence(device_presence::listed, {}, start).empty());
  }
}

TEST_CASE("a mote whose sink is silent is stale, and why it has left may be reported later",
          "[proxy][PXY-16][GW-15]") {
  auto aut = started();
  CHECK(lines_of(aut.on_presence(device_presence::stale, {}, start + 5s)) ==
        became("stale", "none", start + 5s));
  CHECK(aut.on_presence(device_presence::stale, {}, start + 6s).empty());
  CHECK(lines_of(aut.on_presence(device_presence::listed, {}, start + 7s)) ==
        became("active", "none", start + 7s));
  CHECK(lines_of(aut.on_presence(device_presence::left, "not_listed", start + 8s)) ==
        became("lost", "not_listed", start + 8s));
  CHECK(lines_of(aut.on_presence(device_presence::left, "battery", start + 9s)) ==
        lines{base + "status.cause = battery"});
}

TEST_CASE("requests to a lost mote are unreachable at once", "[proxy][PXY-12][GW-12]") {
  auto aut = started();
  static_cast<void>(aut.on_input("switch", "on", start));
  static_cast<void>(aut.on_input("switch", "off", start));
  CHECK(lines_of(aut.on_presence(device_presence::left, "not_listed", start)) ==
        became("lost", "not_listed") + lines{base + "switch.outcome = off unreachable"});
  CHECK(lines_of(aut.on_input("led", "red", start)) ==
        lines{base + "led.outcome = red unreachable"});
  CHECK(lines_of(aut.on_input("led", "blue", start)) == lines{base + "led.outcome = blue refused"});
  CHECK(aut.open_requests() == 1); // `on` is with the gateway
  CHECK(lines_of(aut.on_time(start + 20s)) == lines{base + "switch.outcome = on timeout"});
  static_cast<void>(aut.on_presence(device_presence::listed, {}, start + 30s));
  CHECK(aut.on_input("led", "red", start + 30s).size() == 1);
}

TEST_CASE("a message does not bring a lost mote back, its gateway does", "[proxy][PXY-16]") {
  auto aut = started();
  static_cast<void>(aut.on_presence(device_presence::left, "not_listed", start));
  CHECK(lines_of(aut.on_output(2, bytes{0}, start)) == lines{base + "state = off"});
  CHECK(aut.status() == face::state::lost);
}

TEST_CASE("a silent mote becomes inactive, and active at its next sign of life",
          "[proxy][PXY-20]") {
  proxy_settings settings;
  settings.inactive_after = 10s;
  auto aut = started(settings);
  CHECK(aut.deadline() == start + 10s);
  static_cast<void>(aut.on_output(9, bytes{}, start + 4s)); // unread, and yet it lives
  CHECK(aut.deadline() == start + 14s);
  CHECK(aut.on_time(start + 14s - 1ns).empty());
  CHECK(lines_of(aut.on_time(start + 14s)) == became("inactive", "none", start + 14s));
  CHECK_FALSE(aut.deadline());
  CHECK(aut.on_time(start + 99s).empty());
  SECTION("a message") {
    CHECK(lines_of(aut.on_output(2, bytes{1}, start + 100s)) ==
          became("active", "none", start + 100s) + lines{base + "state = on"});
  }
  SECTION("an acknowledgement") {
    CHECK(aut.on_input_status(2, "1 pending", start + 100s).empty());
    CHECK(lines_of(aut.on_input_status(2, "1 acknowledged", start + 100s)) ==
          became("active", "none", start + 100s));
  }
  SECTION("the gateway's list") {
    CHECK(lines_of(aut.on_presence(device_presence::listed, {}, start + 100s)) ==
          became("active", "none", start + 100s));
  }
  CHECK(aut.deadline() == start + 110s);
}

TEST_CASE("a proxy whose mote stays away retires once an absence", "[proxy][PXY-20]") {
  proxy_settings settings;
  settings.inactive_after = 10s;
  settings.retire_after = 60s;
  auto aut = started(settings);
  static_cast<void>(aut.on_presence(device_presence::left, "gateway_gone", start + 5s));
  CHECK(aut.deadline() == start + 65s);
  CHECK(aut.on_time(start + 64s).empty());
  CHECK(lines_of(aut.on_time(start + 65s)) == lines{"retire"});
  CHECK(aut.on_time(start + 66s).empty());
  CHECK_FALSE(aut.deadline());
  static_cast<void>(
      aut.on_presence(device_presence::listed, {}, start + 70s)); // it was faster than its end
  CHECK(aut.deadline() == start + 80s);
  static_cast<void>(aut.on_presence(device_presence::left, "not_listed", start + 75s));
  CHECK(lines_of(aut.on_time(start + 135s)) == lines{"retire"});
}

TEST_CASE("news of a mote that is lost do not put the end of its proxy off", "[proxy][PXY-20]") {
  proxy_settings settings;
  settings.retire_after = 60s;
  auto aut = started(settings);
  static_cast<void>(aut.on_presence(device_presence::left, "gateway_gone", start + 5s));
  for (const auto* const cause : {"not_listed", "not_listed", "battery"}) {
    static_cast<void>(aut.on_presence(device_presence::left, cause, start + 40s));
    CHECK(aut.deadline() == start + 65s);
  }
  CHECK(lines_of(aut.on_time(start + 65s)) == lines{"retire"});
}

TEST_CASE("a gateway's tuples are routed by their keys", "[proxy][PXY-08][PXY-14]") {
  auto aut = started();
  CHECK(lines_of(aut.on_gateway_tuple("devices.7.output.2", bytes{0}, start)) ==
        lines{base + "state = off"});
  static_cast<void>(aut.on_input("switch", "on", start));
  const auto value = [](std::string_view text) {
    auto octets = to_bytes(text);
    octets.push_back(0); // text travels with its NUL
    return octets;
  };
  CHECK(aut.on_gateway_tuple("devices.7.input.2.status", value("1 pending"), start).empty());
  CHECK(
      lines_of(aut.on_gateway_tuple("devices.7.INPUT.2.status", value("1 acknowledged"), start)) ==
      lines{base + "switch.outcome = on acknowledged", base + "switch.latency = 0.000000"});
  for (const auto* const key : {"devices.8.output.2", "devices.7.type", "devices", "", "kernel.id",
                                "devices.7.input.2", "devices.7.input.9.status"})
    CHECK(aut.on_gateway_tuple(key, bytes{0}, start).empty());
  CHECK(aut.counters().foreign_tuples == 7);
  CHECK(aut.on_input_status(2, "soon", start).empty());
  CHECK(aut.counters().bad_statuses == 1);
}

TEST_CASE("keys over the limits are counted and not set", "[proxy][TUP-03]") {
  auto what = climate();
  what.prefix = "a.b.c.d.{island}.{name}";
  face deep(what, identity());
  for (const auto& line : lines_of(deep.start(start)))
    CHECK(line.find(".unit") == std::string::npos);
  // Eight parts: status.cause and status.since, two units, size.height, and words, deadline and
  // latency of two inputs.
  CHECK(deep.counters().bad_keys == 11);
  auto who = identity();
  who.mote_name = std::string(200, 'n');
  face wide(climate(), who);
  CHECK(wide.start(start).empty());
  CHECK(wide.counters().bad_keys == 18);
}

TEST_CASE("whatever happens, requests and outcomes balance", "[proxy][PXY-12][IF-07]") {
  const auto seed = GENERATE(range(1, 21));
  random_stream rng(static_cast<std::uint64_t>(seed));
  proxy_settings settings;
  settings.inactive_after = 7s;
  auto aut = started(settings);
  std::uint64_t published_outcomes = 0;
  std::uint64_t sequence = 0;
  const std::vector<std::string> words{"on", "off", "red", "dim", "none"};
  const std::vector<std::string> outcomes{" pending", " acknowledged", " failed", " unreachable",
                                          ""};
  for (instant now = start; now < start + 600s; now += 250ms) {
    face::outputs out;
    switch (rng.below(7)) {
    case 0:
    case 1:
      out = aut.on_input(rng.chance(0.5) ? "switch" : "led", words[rng.below(5)], now);
      break;
    case 2:
      sequence += rng.below(3);
      out = aut.on_input_status(static_cast<std::uint16_t>(2 + rng.below(3)),
                                std::to_string(sequence) + outcomes[rng.below(5)], now);
      break;
    case 3:
      out = rng.chance(0.2) ? aut.on_presence(device_presence::left, "not_listed", now)
                            : aut.on_presence(device_presence::listed, {}, now);
      break;
    case 4:
      out = aut.on_output(static_cast<std::uint16_t>(rng.below(4)), bytes(rng.below(4)), now);
      break;
    default:
      out = aut.on_time(now);
      REQUIRE((!aut.deadline() || *aut.deadline() > now));
      break;
    }
    for (const auto& line : lines_of(out))
      published_outcomes += line.find(".outcome = ") != std::string::npos ? 1 : 0;
    std::uint64_t ended = aut.counters().acknowledged;
    for (const auto& [cause, times] : aut.counters().failed)
      ended += times;
    REQUIRE(published_outcomes == ended);
    REQUIRE(aut.counters().requested == ended + aut.open_requests());
    REQUIRE(aut.open_requests() <= 4);
  }
  CHECK(aut.counters().acknowledged > 0);
  CHECK(aut.counters().failed.size() == 5);
}
