// What a file may say about the radios of single motes: medium access and channel.
#include <string>

#include "config/checks/slot_check.hpp"
#include "config/checks/warnings.hpp"
#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

std::string warnings_in(const std::string& toml) {
  const auto x = load_text(toml, "t");
  for (const auto& each : x.problems)
    FAIL_CHECK(to_string(each));
  std::string out;
  for (const auto& each : warnings_of(x, "t"))
    out += each.message + '\n';
  return out;
}

} // namespace

TEST_CASE("a mote has its type's medium access, and its own where it says so",
          "[config][radio][NET-15]") {
  const auto x = good("[ecology]\nname = 't'\n"
                      "[mote_type.c]\ntype = 7\ncsma = { min_be = 1, retries = 2 }\nchannel = 20\n"
                      "[[island]]\nname = 'k'\nid = 1\nchannel = 15\n"
                      "sink = { csma = { backoffs = 5 } }\n"
                      "[[island.mote]]\nid = 2\ntype = 'c'\nposition_m = [1, 2]\n"
                      "[[island.mote]]\nid = 3\ntype = 'c'\nposition_m = [1, 2]\n"
                      "channel = 15\ncsma = { max_be = 8, retries = 0 }\n"
                      "[[island.group]]\nlayout = 'ring'\nradius = '3m'\ncount = 2\ntype = 9\n"
                      "csma.min_be = 0\n");
  const auto& island = x.islands.at(0);
  CHECK(island.sink.access.backoffs_max == 5U);
  CHECK(!island.sink.access.min_be);
  const auto& a = island.motes.at(0);
  CHECK(a.access.min_be == 1U);
  CHECK(!a.access.max_be);
  CHECK(a.access.retries_max == 2U);
  CHECK(int{channel_of(island, a)} == 20);
  const auto& b = island.motes.at(1);
  CHECK(b.access.min_be == 1U);
  CHECK(b.access.max_be == 8U);
  CHECK(b.access.retries_max == 0U);
  CHECK(int{channel_of(island, b)} == 15);
  const auto& c = island.motes.at(3);
  CHECK(c.access.min_be == 0U);
  CHECK(int{channel_of(island, c)} == 15);
  CHECK(summary(x).find(", channel 15") != std::string::npos);
}

TEST_CASE("medium access of a mote is checked", "[config][radio][NET-15]") {
  check_mistakes(mote_head, R"(
csma = { min_be = 6 }
#                 ^ `min_be` must not be above `max_be`, which is 5

csma = { min_be = 4, max_be = 3 }
#                 ^ `min_be` must not be above `max_be`, which is 3

csma = { max_be = 2 }
#                 ^ `max_be` must be a whole number from 3 to 8, not 2

csma = { min_be = 9 }
#                 ^ `min_be` must be a whole number from 0 to 8, not 9

csma = { backoffs = 6 }
#                   ^ `backoffs` must be a whole number from 0 to 5, not 6

csma = { retries = 8 }
#                  ^ `retries` must be a whole number from 0 to 7, not 8

channel = 10
#         ^ `channel` must be a whole number from 11 to 26, not 10

channel = 27
#         ^ `channel` must be a whole number from 11 to 26, not 27
)");
}

TEST_CASE("what a medium access does not have is refused", "[config][radio]") {
  CHECK(problem_in(mote_head + "csma = { backoffs = 3 }\n[radio.mac]\nmicaz = \"cc2420\"\n") ==
        "19:8: with the medium access \"cc2420\" of a micaz `min_be`, `max_be` and `backoffs` have "
        "no effect: only `retries` does");
  CHECK(problem_in(mote_head + "csma = { retries = 3 }\n[radio.mac]\nmicaz = \"cc2420\"\n") ==
        "none");
}

TEST_CASE("slots have room for the longest back-off of any mote", "[config][radio][SYN-16]") {
  const auto usual = good(mote_head);
  const auto slow = good(mote_head + "csma = { min_be = 7, max_be = 8 }\n");
  CHECK(access_of(usual.radio, usual.islands.at(0)).back_off == 7 * 320us);
  CHECK(access_of(slow.radio, slow.islands.at(0)).back_off == 127 * 320us);
}

TEST_CASE("a mote on a channel of its own has a warning", "[config][radio]") {
  const std::string more = "[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = [3, 2]\n";
  CHECK(warnings_in(mote_head + more) == warnings_in(mote_head + "channel = 26\n" + more));
  CHECK(
      warnings_in(mote_head + "channel = 15\n" + more)
          .find("mote `c-2` cannot reach any radio of its island: no other one is on channel 15") !=
      std::string::npos);
  const auto two = warnings_in(mote_head + "channel = 15\n" + more + "channel = 15\n");
  CHECK(two.find("mote `c-2` cannot reach its sink: it is on channel 15, the sink on 26") !=
        std::string::npos);
  CHECK(two.find("mote `c-3` cannot reach its sink") != std::string::npos);
}

TEST_CASE("a mote far away on another channel is no mistake", "[config][radio]") {
  const std::string far = "[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = [900, 2]\n";
  CHECK(problem_in(mote_head + far).find("unreachable") != std::string::npos);
  CHECK(problem_in(mote_head + far + "channel = 12\n") == "none");
}

TEST_CASE("noise may have a channel", "[config][radio][GEN-03]") {
  const auto with = [](const std::string& more) {
    return mote_head +
           "[[fault]]\nkind = \"noise\"\nat = \"1s\"\nisland = \"k\"\n"
           "position_m = [0, 0]\n" +
           more;
  };
  const auto noise = [&](const std::string& more) {
    return std::get<noise_fault>(good(with(more)).faults.at(0).what).channel;
  };
  CHECK(!noise(""));
  CHECK(noise("channel = 11\n") == std::uint8_t{11});
  CHECK(problem_in(with("channel = 3\n")).find("from 11 to 26") != std::string::npos);
}

TEST_CASE("an island may have a base station with plain motes around it", "[config][GW-17]") {
  const auto x = good("[ecology]\nname = 't'\n"
                      "[[island]]\nname = 'k'\nid = 1\nsink = { role = 'base_station' }\n"
                      "plain = [{ am_type = 147, type = 905 }]\n"
                      "[[island.mote]]\nid = 2\nposition_m = [1, 2]\n"
                      "transducers.light = { model = 'constant', value = 20 }\n"
                      "apps = [{ app = 'oscilloscope', transducer = 'light', every = '500ms' }]\n"
                      "[[island.mote]]\nid = 3\nposition_m = [900, 2]\n"
                      "apps = [{ app = 'blink' }, { app = 'count', every = '1s' }]\n");
  const auto& island = x.islands.at(0);
  CHECK(island.stack == stack::plain);
  CHECK(island.sink.promiscuous);
  CHECK(has_plain_sink(island));
  CHECK(has_line(island.stack));
  const auto& scope = std::get<tinyos::program_config>(island.motes.at(0).apps.at(0));
  CHECK(scope.kind == tinyos::program_kind::oscilloscope);
  CHECK(scope.every == 500ms);
  CHECK(scope.transducer == device::quantity::light);
  const auto& blink = std::get<tinyos::program_config>(island.motes.at(1).apps.at(0));
  CHECK(blink.kind == tinyos::program_kind::blink);
  CHECK(blink.every == 250ms);
  CHECK(summary(x).find(", base station, 57600 baud") != std::string::npos);
}

TEST_CASE("what does not go with a base station is refused", "[config][GW-17]") {
  constexpr std::string_view start = "[ecology]\nname = \"t\"\n"
                                     "[[island]]\nname = \"k\"\nid = 1\n";
  check_mistakes(start, R"(
sink = { role = "base_station", promiscuous = false }
#                                             ^ a base station accepts every frame that it receives

stack = "mac"
sink = { role = "base_station" }
#               ^ `role` has no effect in an island with stack = "mac"

sink = { role = "base_station" }
duty_cycle = {}
#            ^ `duty_cycle` has no effect in an island with a base station, which does not know its motes

sink = { role = "base_station" }
mote = [{ id = 2, position_m = [1, 0], apps = [{ app = "listener", am_type = 7 }] }]
#                                                                            ^ a mote around a base station has no other apps than oscilloscope, blink, count, sender, relay and receiver

sink = { role = "base_station" }
mote = [{ id = 2, position_m = [1, 0], apps = [{ app = "oscilloscope", transducer = "light" }] }]
#                                                                                   ^ the mote has no transducer `light`; it has: none

sink = { role = "base_station" }
mote = [{ id = 2, position_m = [1, 0], apps = [{ app = "blink", every = "70s" }] }]
#                                                                       ^ `every` must be a time from 1 ms to 1 min, not "70s"

mote = [{ id = 2, type = 7, position_m = [1, 0], apps = [{ app = "blink" }] }]
#                                                                ^ a plain program of TinyOS needs an island whose sink has role = "base_station"

plain = [{ am_type = 6, type = 7 }]
#       ^ `plain` has no effect without a real sink, a base station or `real`
)");
}
