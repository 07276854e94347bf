#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "config/load.hpp"
#include "config/run/fault_variation.hpp"
#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// Three peers `p-1` to `p-3`, ids 11 to 13, and `q` with the id 20; what follows stands from
/// line 11.
constexpr std::string_view peers_head = "[ecology]\nname = \"t\"\nduration = \"1h\"\n"
                                        "[[peer]]\nname = \"p\"\nid = 11\ncount = 3\n"
                                        "[[peer]]\nname = \"q\"\nid = 20\n";

fault_description fault_of(std::string_view keys) {
  return good(std::string(peers_head) + "[[fault]]\n" + std::string(keys)).faults.at(0);
}

template <class Fault>
Fault only_fault(std::string_view keys) {
  return std::get<Fault>(fault_of("at = \"1s\"\n" + std::string(keys)).what);
}

std::vector<peer_id> ids(std::initializer_list<std::int32_t> numbers) {
  std::vector<peer_id> out;
  for (const auto each : numbers)
    out.emplace_back(each);
  return out;
}

} // namespace

TEST_CASE("faults of peers arrive with their keys", "[config][ACT-04]") {
  CHECK(only_fault<kill_fault>("kind = \"kill\"\npeer = \"p-2\"\n").peer == peer_id{12});
  CHECK_FALSE(only_fault<kill_fault>("kind = \"kill\"\npeer = \"q\"\n").length);
  CHECK(only_fault<kill_fault>("kind = \"kill\"\npeer = \"*\"\nfor = \"5s\"\n").length == 5s);
  CHECK(only_fault<kill_fault>("kind = \"kill\"\npeer = \"*\"\n").peer == any_peer);
  CHECK(
      only_fault<power_off_fault>("kind = \"power_off\"\npeer = \"q\"\nfor = \"1min\"\n").length ==
      1min);
  CHECK(only_fault<pause_fault>("kind = \"pause\"\npeer = \"q\"\n").length == 10s);
  CHECK(only_fault<duplicate_id_fault>("kind = \"duplicate_id\"\npeer = \"q\"\n").peer ==
        peer_id{20});
  CHECK(
      only_fault<clock_step_fault>("kind = \"clock_step\"\npeer = \"q\"\nby = \"-1min30s\"\n").by ==
      -90s);
  CHECK(only_fault<clock_step_fault>("kind = \"clock_step\"\npeer = \"q\"\nby = \"5ms\"\n").by ==
        5ms);
}

TEST_CASE("faults of the network name single peers and tables of them", "[config][ACT-04]") {
  const auto parts = only_fault<partition_fault>(
      "kind = \"partition\"\ngroups = [[\"p\"], [\"q\"]]\nfor = \"10s\"\n");
  CHECK(parts.groups == std::vector{ids({11, 12, 13}), ids({20})});
  CHECK(parts.length == 10s);
  const auto one =
      only_fault<partition_fault>("kind = \"partition\"\ngroups = [[\"p-1\", \"q\"]]\n");
  CHECK(one.groups == std::vector<std::vector<peer_id>>{ids({11, 20})});
  CHECK(one.length == 30s);
  const auto all = only_fault<link_loss_fault>("kind = \"link_loss\"\nloss = \"20%\"\n");
  CHECK(all.loss == 0.2);
  CHECK(all.peers.empty());
  const auto some =
      only_fault<link_loss_fault>("kind = \"link_loss\"\nloss = 1\npeers = [\"q\", \"p\"]\n");
  CHECK(some.peers == ids({20, 11, 12, 13}));
}

TEST_CASE("a fault may happen often", "[config][ACT-04]") {
  CHECK_FALSE(fault_of("at = \"1s\"\nkind = \"kill\"\npeer = \"q\"\n").repeated);
  const auto every =
      fault_of("every = \"30s\"\nfrom = \"1min\"\nuntil = \"5min\"\nkind = \"pause\"\n"
               "peer = \"q\"\n");
  CHECK(every.at == 1min);
  REQUIRE(every.repeated);
  CHECK(every.repeated->every == 30s);
  CHECK(every.repeated->count == 0);
  CHECK(every.repeated->from == 1min);
  CHECK(every.repeated->until == 5min);
  const auto random = fault_of("random = 7\nkind = \"kill\"\npeer = \"*\"\n");
  CHECK(random.at == 0s);
  REQUIRE(random.repeated);
  CHECK(random.repeated->every == 0s);
  CHECK(random.repeated->count == 7);
  CHECK_FALSE(random.repeated->until);
}

TEST_CASE("a mote or an island may be drawn", "[config][ACT-04]") {
  const auto x = good(mote_head + "[[fault]]\nrandom = 2\nkind = \"crash\"\nmote = \"*\"\n"
                                  "[[fault]]\nrandom = 2\nkind = \"battery_end\"\nmote = \"*\"\n"
                                  "[[fault]]\nrandom = 2\nkind = \"unplug\"\nisland = \"*\"\n")
                     .faults;
  CHECK(std::get<crash_fault>(x.at(0).what).mote == any_mote);
  CHECK(std::get<battery_end_fault>(x.at(1).what).mote == any_mote);
  CHECK(std::get<unplug_fault>(x.at(2).what).island == any_island);
  check_mistakes(mote_head, R"(
[[island.mote.apps]]
app = "messenger"
to = "*"
#    ^ `to` must be the island and the name of a mote, as in "kitchen/climate-7", not "*"
text = "a"
)");
}

TEST_CASE("faults that cannot be are refused", "[config][GEN-06][ACT-04]") {
  check_mistakes(peers_head, R"(
[[fault]]
at = "1s"
kind = "kill"
peer = "p"
#      ^ no peer or gateway is named `p`: did you mean `q`?

[[fault]]
at = "1s"
kind = "kill"
peer = 7
#      ^ `peer` must be the name of a peer or gateway, or "*", not 7

[[fault]]
at = "1s"
kind = "kill"
peer = "q"
for = "0s"
#     ^ `for` must be a time from 1 ms to 3650 d, not "0s"

[[fault]]
at = "1s"
kind = "pause"
peer = "q"
for = "61min"
#     ^ `for` must be a time from 1 ms to 1 h, not "61min"

[[fault]]
at = "1s"
kind = "clock_step"
peer = "q"
by = "0s"
#    ^ `by` must be a time with its unit, forward or back, as in "5s" or "-5s", not "0s"

[[fault]]
at = "1s"
kind = "clock_step"
peer = "q"
by = "--5s"
#    ^ `by` must be a time with its unit, forward or back, as in "5s" or "-5s", not "--5s"

[[fault]]
at = "1s"
kind = "partition"
groups = []
#        ^ `groups` must be an array of at least 1, not an empty array

[[fault]]
at = "1s"
kind = "partition"
groups = [[]]
#         ^ `groups` must be an array of at least 1, not an empty array

[[fault]]
at = "1s"
kind = "partition"
groups = [["p"], ["p-2"]]
#                 ^ the peer with the id 12 is already in a group (line 14, column 12)

[[fault]]
at = "1s"
kind = "link_loss"
loss = 0.1
peers = ["q"]
#       ^ a link has two ends: name another peer

[[fault]]
at = "1s"
#    ^ `at` has no effect with `every` or `random`
every = "1s"
kind = "pause"
peer = "q"

[[fault]]
every = "1s"
random = 2
#        ^ `random` has no effect with `every`
kind = "pause"
peer = "q"

[[fault]]
at = "1s"
from = "1s"
#      ^ `from` has no effect without `every` or `random`
until = "2s"
#       ^ `until` has no effect without `every` or `random`
kind = "pause"
peer = "q"

[[fault]]
random = 1
from = "2s"
until = "1s"
#       ^ `until` must not be before `from`, which is 2 s
kind = "pause"
peer = "q"

[[fault]]
random = 1
until = "2h"
#       ^ `until` is after the end of the run, which is at 1 h
kind = "pause"
peer = "q"

[[fault]]
random = 0
#        ^ `random` must be a whole number from 1 to 100000, not 0
kind = "pause"
peer = "q"

[[fault]]
every = "36ms"
#       ^ that is more than 100000 times
kind = "pause"
peer = "q"

[[fault]]
every = "37ms"
kind = "pause"
peer = "q"
)");
}

TEST_CASE("a summary shows when faults happen, and to whom", "[config]") {
  const auto x = good(std::string(peers_head) +
                      "[[fault]]\nat = \"2s\"\nkind = \"power_off\"\npeer = \"q\"\n"
                      "[[fault]]\nrandom = 3\nkind = \"kill\"\npeer = \"*\"\nfor = \"9s\"\n"
                      "[[fault]]\nevery = \"1min\"\nfrom = \"3s\"\nuntil = \"5min\"\n"
                      "kind = \"clock_step\"\npeer = \"p-3\"\nby = \"-2s\"\n"
                      "[[fault]]\nat = \"4s\"\nkind = \"partition\"\n"
                      "groups = [[\"p\"], [\"q\"]]\n"
                      "[[fault]]\nat = \"5s\"\nkind = \"link_loss\"\nloss = 0.1\n");
  const auto text = summary(x);
  CHECK(text.substr(text.find("faults")) == R"(faults
  3 times                        kill        any peer for 9 s
  2 s                            power_off   q
  every 1 min from 3 s to 5 min  clock_step  p-3 by -2 s
  4 s                            partition   p-1, p-2, p-3 | q for 30 s
  5 s                            link_loss   10 % for 30 s
)");
}

TEST_CASE("a mote and a sink may be off for as long as one likes, and their clocks be set",
          "[config][ACT-04]") {
  const auto all = good(mote_head + "[[fault]]\nat = \"1s\"\nkind = \"crash\"\nmote = \"*\"\n"
                                    "[[fault]]\nat = \"2s\"\nkind = \"crash\"\nmote = \"*\"\n"
                                    "for = \"10min\"\n"
                                    "[[fault]]\nat = \"3s\"\nkind = \"crash\"\nsink = \"*\"\n"
                                    "[[fault]]\nat = \"4s\"\nkind = \"crash\"\nsink = \"k\"\n"
                                    "for = \"5s\"\n"
                                    "[[fault]]\nat = \"5s\"\nkind = \"clock_step\"\n"
                                    "mote = \"*\"\nby = \"-2s\"\n"
                                    "[[fault]]\nat = \"6s\"\nkind = \"clock_step\"\n"
                                    "sink = \"k\"\nby = \"3s\"\n");
  const auto& x = all.faults;
  CHECK(std::get<crash_fault>(x.at(0).what).length == 500ms);
  CHECK(std::get<crash_fault>(x.at(1).what).length == 10min);
  CHECK(std::get<sink_crash_fault>(x.at(2).what).island == any_island);
  CHECK(std::get<sink_crash_fault>(x.at(2).what).length == 500ms);
  CHECK(std::get<sink_crash_fault>(x.at(3).what).island == all.islands.at(0).id);
  CHECK(std::get<sink_crash_fault>(x.at(3).what).length == 5s);
  CHECK(std::get<crystal_step_fault>(x.at(4).what).by == -2s);
  CHECK(std::holds_alternative<sink_step_fault>(x.at(5).what));
  const auto text = summary(all);
  CHECK(text.substr(text.find("faults")) == R"(faults
  1 s  crash       any mote
  2 s  crash       any mote for 10 min
  3 s  crash       any sink
  4 s  crash       k/sink for 5 s
  5 s  clock_step  any mote by -2 s
  6 s  clock_step  k/sink by 3 s
)");
}

TEST_CASE("noise and losses of the radio arrive with their keys", "[config][ACT-04]") {
  const auto all = good(mote_head + "[[fault]]\nat = \"1s\"\nkind = \"noise\"\nisland = \"k\"\n"
                                    "position_m = [1, 2]\n"
                                    "[[fault]]\nat = \"2s\"\nkind = \"noise\"\nisland = \"k\"\n"
                                    "position_m = [1, 2]\npower = \"-5dBm\"\nduty = \"20%\"\n"
                                    "burst = \"2ms\"\nfor = \"1min\"\n"
                                    "[[fault]]\nat = \"3s\"\nkind = \"radio_loss\"\nloss = 0.2\n"
                                    "[[fault]]\nat = \"4s\"\nkind = \"radio_loss\"\nloss = 1\n"
                                    "island = \"*\"\nfor = \"2s\"\n");
  const auto& x = all.faults;
  const auto always = std::get<noise_fault>(x.at(0).what);
  CHECK(always.island == all.islands.at(0).id);
  CHECK(always.transmit_dbm == 0);
  CHECK(always.duty == 1);
  CHECK(always.length == 30s);
  const auto now_and_then = std::get<noise_fault>(x.at(1).what);
  CHECK(now_and_then.transmit_dbm == -5);
  CHECK(now_and_then.duty == 0.2);
  CHECK(now_and_then.burst == 2ms);
  CHECK_FALSE(std::get<radio_loss_fault>(x.at(2).what).island);
  CHECK(std::get<radio_loss_fault>(x.at(3).what).island == any_island);
  const auto text = summary(all);
  CHECK(text.substr(text.find("faults")) == R"(faults
  1 s  noise       k at [1, 2], 0 dBm for 30 s
  2 s  noise       k at [1, 2], -5 dBm, 20 % of the time in bursts of 2 ms for 1 min
  3 s  radio_loss  20 % for 30 s
  4 s  radio_loss  100 % in any island for 2 s
)");
}

TEST_CASE("faults of motes and radios that cannot be are refused", "[config][GEN-06][ACT-04]") {
  check_mistakes(mote_head, R"(
[[fault]]
#< `mote` is missing in kind = "crash"
at = "1s"
kind = "crash"

[[fault]]
at = "1s"
kind = "crash"
mote = "*"
sink = "k"
#      ^ `sink` has no effect with `mote`

[[fault]]
at = "1s"
kind = "crash"
sink = "b"
#      ^ no island is named `b`: did you mean `k`?

[[fault]]
at = "1s"
kind = "clock_step"
peer = "*"
mote = "*"
#      ^ `mote` has no effect with `peer`
by = "1s"

[[fault]]
at = "1s"
kind = "noise"
island = "*"
#        ^ no island is named `*`: did you mean `k`?
position_m = [0, 0]

[[fault]]
at = "1s"
kind = "noise"
island = "k"
position_m = [0, 0]
duty = 0
#      ^ `duty` must be above 0: remove the fault instead

[[fault]]
at = "1s"
kind = "radio_loss"
loss = 2
#      ^ `loss` must be a ratio from 0 to 1, or from "0%" to "100%", not 2
)");
}

TEST_CASE("motes may have a double, another island or another type", "[config][ACT-04][ADR-04]") {
  const std::string two = mote_head + "[[island]]\nid = 9\nname = \"other\"\n"
                                      "[mote_type.lamp]\ntype = 77\n"
                                      "actuators = [{ name = \"switch\", kind = \"relay\" }]\n";
  const auto name = good(two).islands.at(0).motes.at(0).name;
  const auto with = [&](const std::string& keys) {
    return two + "[[fault]]\nat = \"1s\"\nmote = \"k/" + name + "\"\n" + keys;
  };
  const auto x = good(with("kind = \"duplicate_id\"\nposition_m = [3, 4]\nfor = \"5s\"\n"));
  const auto second = std::get<mote_double_fault>(x.faults.at(0).what);
  CHECK(second.mote == mote_address{x.islands.at(0).id, mote_id{2}});
  CHECK(second.place.y_m == 4);
  CHECK(second.length == 5s);
  const auto moves =
      good(with("kind = \"move\"\nto_island = \"other\"\nto_m = [1, 1]\n")).faults.at(0);
  CHECK(std::get<move_island_fault>(moves.what).to == island_id{9});
  CHECK(std::get<move_island_fault>(moves.what).length == 10s);
  const auto becomes = good(with("kind = \"crash\"\ntype = \"lamp\"\n"));
  const auto& crash = std::get<crash_fault>(becomes.faults.at(0).what);
  REQUIRE(crash.becomes);
  CHECK(crash.becomes->type == 77);
  CHECK(crash.becomes->id == mote_id{2});
  CHECK(crash.becomes->actuators.size() == 1);
  CHECK(crash.becomes->apps.empty());
  const auto text = summary(becomes);
  CHECK(text.substr(text.find("faults")) ==
        "faults\n  1 s  crash  k/" + name + " and then of the type lamp\n");

  const auto wrong = [&](const std::string& keys) { return problem_after(with(keys), ""); };
  CHECK(wrong("kind = \"duplicate_id\"\n").find("`position_m` is missing") != std::string::npos);
  CHECK(wrong("kind = \"duplicate_id\"\npeer = \"*\"\n").find("`mote` has no effect with `peer`") !=
        std::string::npos);
  CHECK(wrong("kind = \"move\"\nto_island = \"k\"\nto_m = [1, 1]\n")
            .find("it is in that island already") != std::string::npos);
  CHECK(wrong("kind = \"crash\"\ntype = \"lamb\"\n")
            .find("no mote type is named `lamb`: did you mean `lamp`?") != std::string::npos);
  CHECK(problem_after(two, "[[fault]]\nat = \"1s\"\nkind = \"crash\"\nmote = \"*\"\n"
                           "type = \"lamp\"\n")
            .find("`type` needs the name of one `mote`, not \"*\"") != std::string::npos);
}

TEST_CASE("with varied faults each seed leaves out kinds of them", "[config][ACT-04]") {
  const auto toml = std::string(peers_head) +
                    "[[fault]]\nat = \"1s\"\nkind = \"kill\"\npeer = \"q\"\n"
                    "[[fault]]\nat = \"2s\"\nkind = \"kill\"\npeer = \"p-1\"\n"
                    "[[fault]]\nat = \"3s\"\nkind = \"pause\"\npeer = \"q\"\n";
  constexpr std::uint64_t seeds = 200;
  int killed = 0;
  int paused = 0;
  int both = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    overrides instead;
    instead.seed = seed;
    REQUIRE(load_text(toml, "e.toml", instead).ecology->faults.size() == 3);
    instead.settings = {"ecology.vary_faults=true"};
    const auto found = load_text(toml, "e.toml", instead);
    REQUIRE(problems_of(found) == "none");
    const bool kills = !leaves_out(seed, "kill");
    const bool pauses = !leaves_out(seed, "pause");
    CHECK(found.ecology->faults.size() == (kills ? 2U : 0U) + (pauses ? 1U : 0U));
    killed += kills ? 1 : 0;
    paused += pauses ? 1 : 0;
    both += kills && pauses ? 1 : 0;
  }
  CHECK((killed > 70 && killed < 130));
  CHECK((paused > 70 && paused < 130));
  CHECK((both > 25 && both < 75)); // a quarter: they are independent
}

TEST_CASE("a fault that a seed leaves out is checked all the same", "[config][GEN-06]") {
  const auto toml =
      std::string(peers_head) + "[[fault]]\nat = \"1s\"\nkind = \"kill\"\npeer = \"nobody\"\n";
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    overrides instead;
    instead.seed = seed;
    instead.settings = {"ecology.vary_faults=true"};
    CHECK(problems_of(load_text(toml, "e.toml", instead)) != "none");
  }
}

TEST_CASE("the kinds of faults that a file varies are known", "[config][ACT-04]") {
  const auto kinds = [](const std::string& toml) {
    return varied_kinds(std::get<node>(parse(toml, "e.toml")));
  };
  const std::string faults = "[[fault]]\nkind = \"pause\"\n[[fault]]\nkind = \"kill\"\n"
                             "[[fault]]\nkind = \"pause\"\n[[fault]]\n";
  CHECK(kinds("[ecology]\nvary_faults = true\n" + faults) ==
        std::vector<std::string>{"kill", "pause"});
  CHECK(kinds("[ecology]\nvary_faults = false\n" + faults).empty());
  CHECK(kinds(faults).empty());
  CHECK(kinds("[ecology]\nvary_faults = true\n").empty());
}
