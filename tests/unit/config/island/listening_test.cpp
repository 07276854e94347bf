// What a file may say about radios that listen at low power.
#include <string>

#include "config/checks/listening_check.hpp"
#include "config/checks/slot_check.hpp"
#include "config/checks/warnings.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// Motes in a line, 19 m apart, with a sampler each.
std::string line(const std::string& interval, const std::string& every, int motes = 3) {
  std::string x = "[ecology]\nname = 't'\nduration = '1h'\n[radio]\nrange = '24m'\n"
                  "[mote_type.c]\ntype = 7\n"
                  "transducers.temperature = { model = 'constant', value = 20 }\n"
                  "apps = [{ app = 'sampler', transducers = ['temperature'], every = '" +
                  every +
                  "' }]\n[[peer]]\nname = 'pc'\nid = 300\n[[island]]\nname = 'k'\nid = 1\n"
                  "low_power_listening = { interval = '" +
                  interval + "' }\n";
  for (int i = 1; i <= motes; ++i)
    x += "[[island.mote]]\nid = " + std::to_string(1 + i) + "\ntype = 'c'\nposition_m = [" +
         std::to_string(19 * i) + ", 0]\n";
  return x;
}

std::string warnings_in(const std::string& toml) {
  const auto x = load_text(toml, "t");
  for (const auto& each : x.problems)
    FAIL_CHECK(to_string(each));
  std::string out;
  for (const auto& each : x.warnings)
    out += to_string(each) + '\n';
  return out;
}

} // namespace

TEST_CASE("an island's radios listen at low power if it says so", "[config][radio][NRG-02]") {
  const std::string head(island_head);
  CHECK(!good(head).islands.at(0).listening.enabled());
  const auto usual = good(head + "low_power_listening = {}\n").islands.at(0).listening;
  CHECK(usual.interval == 512ms);
  CHECK(usual.check == 11ms);
  CHECK(usual.awake == 100ms);
  CHECK(usual.train() == 532ms);
  const auto own = good(head + "low_power_listening = { interval = '1s', check = '5ms', "
                               "awake = '20ms' }\n")
                       .islands.at(0)
                       .listening;
  CHECK(own.interval == 1s);
  CHECK(own.check == 5ms);
  CHECK(own.awake == 20ms);
}

TEST_CASE("low-power listening is checked", "[config][radio][NRG-02]") {
  check_mistakes(island_head, R"(
low_power_listening = { interval = "10ms" }
#                                  ^ `interval` must be a time from 20 ms to 1 min, not "10ms"

low_power_listening = { interval = "40ms", check = "21ms" }
#                                                  ^ `check` must not be longer than half the `interval`, which is 40 ms

low_power_listening = { interval = "1s" }
#                     ^ `low_power_listening` and `duty_cycle` exclude each other: an island has at most one of them
duty_cycle = { period = "4s" }

low_power_listening = { interval = "1s", check = "2ms" }
#                                  ^ `check` must be longer than the gap between two copies of a frame, which is up to 2.464 ms by the medium access of its motes
)");
}

TEST_CASE("time-outs of an island count on receivers that sleep", "[config][radio][NRG-02]") {
  const auto asleep = good(line("512ms", "1min"));
  const auto access = access_of(asleep.radio, asleep.islands.at(0));
  CHECK(access.wake == 532ms);
  CHECK(access.answer_slack(3) == 5 * 532ms);
  CHECK(silence_max(asleep.islands.at(0)) == 60 * 512ms);
  const auto awake = good(mote_head);
  CHECK(access_of(awake.radio, awake.islands.at(0)).answer_slack(3) == 0s);
  CHECK(silence_max(awake.islands.at(0)) == 10s);
}

TEST_CASE("what an interval takes of the air follows from the rates of the file",
          "[config][radio][NRG-02]") {
  const auto x = good(line("512ms", "4s"));
  const auto need = air_need_of(x.islands.at(0), 24, 500ms);
  // The second mote's readings have a hop to a mote, the third's two: every 4 s.
  CHECK(need.hops_per_second == Approx(3.0 / 4));
  CHECK(need.broadcasts_per_second == Approx(4.0 / 60));
  CHECK(need.share == Approx(3.0 / 4 * 0.256 + 4.0 / 60 * 0.532));
  CHECK(air_need_of(x.islands.at(0), 100, 500ms).hops_per_second == 0); // all are next to the sink
}

TEST_CASE("an interval that is too long for the rates of a file has a warning",
          "[config][radio][NRG-02]") {
  CHECK(warnings_in(line("512ms", "1min")).empty());
  CHECK(warnings_in(line("128ms", "4s")).empty());
  const auto text = warnings_in(line("2s", "4s"));
  CHECK(text.find("t:16:36: an interval of 2 s is too long for its motes: 0.75 hops of messages "
                  "and vectors per second to motes whose radios sleep take half of it each, and "
                  "0.03 broadcasts per second take a whole one: 82 % of the channel's time") !=
        std::string::npos);
}

TEST_CASE("a keep_alive that low-power listening does not keep has a warning",
          "[config][radio][NRG-02]") {
  const std::string head(island_head);
  CHECK(warnings_in(head + "keep_alive = '31s'\nlow_power_listening = {}\n").empty());
  CHECK(warnings_in(head + "keep_alive = '30s'\nlow_power_listening = {}\n")
            .find("`keep_alive` is 30 s, but a mote is removed after sixty intervals") !=
        std::string::npos);
}
