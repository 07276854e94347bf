#include <csignal>
#include <cstdint>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <poll.h>

#include "cli/child_process.hpp"
#include "cli/print/swarm_text.hpp"
#include "cli/swarm.hpp"
#include "config/run/fault_variation.hpp"
#include "config/run/variation.hpp"
#include "report/print/text_layout.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

child_end run_shell(const std::string& script) {
  child_process child("/bin/sh", {"sh", "-c", script});
  for (auto open = child.descriptors(); !open.empty(); open = child.descriptors()) {
    std::vector<pollfd> watched;
    for (const auto x : open)
      watched.push_back({x, POLLIN, 0});
    REQUIRE(poll(watched.data(), watched.size(), -1) > 0);
    child.read();
  }
  return child.wait();
}

child_end said(int status, std::string out) {
  return {status, 0, std::move(out), {}, false};
}

const std::string good_report =
    R"({"interrupted": false, "complete": true, "reason": "", "events": 12, "simulated_s": 20.0, "violations": []})";
const std::string bad_report =
    R"({"interrupted": false, "complete": true, "reason": "", "events": 12, "simulated_s": 20.0, "violations": [
        {"at_s": 1.5, "invariant": "every mote is joined", "detail": "kitchen/shelf: never joined"}]})";

seed_outcome judged(const child_end& how) {
  const auto x = judge(7, how, 250ms, false);
  REQUIRE(x.has_value());
  CHECK(x->seed == 7);
  return *x;
}

std::string only_violation(const seed_outcome& x) {
  REQUIRE(x.violations.size() == 1);
  return x.violations[0].invariant + ": " + x.violations[0].detail;
}

seed_outcome good_outcome(std::uint64_t seed, duration real = 1s) {
  return {seed, {}, real, 10, 2};
}

seed_outcome bad_outcome(std::uint64_t seed) {
  return {seed, {{instant(1s), "rule", "broken"}}, 1s, 10, 2};
}

std::vector<std::uint64_t> seeds_of(const std::vector<seed_outcome>& x) {
  std::vector<std::uint64_t> seeds;
  for (const auto& outcome : x)
    seeds.push_back(outcome.seed);
  return seeds;
}

using seed_list = std::vector<std::uint64_t>;

} // namespace

TEST_CASE("a child's outputs and status come back", "[cli]") {
  const auto x = run_shell("cat; echo out; echo err >&2; exit 3");
  CHECK(x.out == "out\n"); // its standard input was empty
  CHECK(x.err == "err\n");
  CHECK(x.status == 3);
  CHECK(x.signal == 0);
}

TEST_CASE("a child's end by a signal is told", "[cli]") {
  const auto x = run_shell("echo partly; kill -ABRT $$");
  CHECK(x.out == "partly\n");
  CHECK(x.status == -1);
  CHECK(x.signal == SIGABRT);
}

TEST_CASE("a child that talks without end keeps only its last words, or is killed", "[cli]") {
  const auto loud = run_shell("head -c 100000 /dev/zero | tr '\\0' x >&2; echo end >&2");
  CHECK(loud.err.size() == child_process::err_octets_max);
  CHECK(loud.err.ends_with("xend\n"));
  const auto endless = run_shell("exec cat /dev/zero 2>/dev/null");
  CHECK(endless.overlong);
  CHECK(endless.signal == SIGKILL);
}

TEST_CASE("a child that is not waited for is killed", "[cli]") {
  // Its end would never come by itself: without the kill this test does not end either.
  const child_process child("/bin/sh", {"sh", "-c", "exec tail -f /dev/null"});
  CHECK(child.descriptors().size() == 2);
}

TEST_CASE("a program that is not there cannot be started", "[cli]") {
  CHECK_THROWS_AS(child_process("/nowhere/program", {"program"}), std::system_error);
}

TEST_CASE("a good report is a good seed", "[cli]") {
  const auto x = judged(said(0, good_report));
  CHECK(x.violations.empty());
  CHECK(x.events == 12);
  CHECK(x.simulated_s == 20.0);
  CHECK(x.real == 250ms);
}

TEST_CASE("the time to the first flat battery is compared between seeds whose runs it has ended",
          "[cli][NRG-05]") {
  const std::string title = "time to the first flat battery, h";
  auto report = good_report;
  CHECK(!judged(said(0, report)).figures.contains(title));
  report.insert(1, R"("ended_by": "", )");
  CHECK(!judged(said(0, report)).figures.contains(title));
  report.replace(report.find(R"("", )"), 2, R"("kitchen/climate-7")");
  CHECK(judged(said(0, report)).figures.at(title) == Approx(20.0 / 3600));
}

TEST_CASE("a swarm counts the situations that its runs came into", "[cli]") {
  const auto report_of = [](const std::string& met) {
    auto text = good_report;
    return text.insert(1, R"("expectations": [{"expect": "joined within 20 s", "met": true},
                             {"expect": "sometimes b", "met": )" +
                              met + R"(}, {"expect": "sometimes a", "met": null}], )");
  };
  swarm x({7, 9});
  while (x.next()) {
  }
  CHECK_FALSE(x.misses_situations());
  for (const std::uint64_t seed : {7, 8, 9}) {
    auto outcome = judged(said(0, report_of(seed == 7 ? "null" : "true")));
    outcome.seed = seed;
    REQUIRE(outcome.situations.size() == 2);
    CHECK(outcome.violations.empty());
    static_cast<void>(x.ended(std::move(outcome)));
  }
  CHECK(x.misses_situations());
  CHECK(swarm_summary(x, {"a.toml"}, 1s, false) ==
        "3 runs in 1.00 s, 1 at a time: no violations\n"
        "  sometimes b: 2 of 3 runs, first seed 8\n"
        "  sometimes a: NEVER reached\n"
        "  36 events, 60.0 ×, slowest seed 7 (0.25 s)\n");
  const auto object =
      nlohmann::json::parse(swarm_json().text(x, {"a.toml"}, 1s, false)).at("situations");
  CHECK(object == nlohmann::json::parse(R"([{"name": "b", "runs": 2, "first_seed": 8},
                                            {"name": "a", "runs": 0, "first_seed": null}])"));
}

TEST_CASE("a swarm says in how many runs each kind of fault was", "[cli]") {
  swarm x({1, 50});
  while (x.next()) {
  }
  std::uint64_t with_crash = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    with_crash += config::leaves_out(seed, "crash") ? 0 : 1;
    static_cast<void>(x.ended(good_outcome(seed)));
  }
  swarm_words words{"a.toml"};
  words.fault_kinds = {"crash"};
  CHECK((with_crash > 10 && with_crash < 40));
  CHECK(swarm_summary(x, words, 1s, false)
            .find("  fault crash: " + std::to_string(with_crash) + " of 50 runs\n") !=
        std::string::npos);
  const auto object = nlohmann::json::parse(swarm_json().text(x, words, 1s, false));
  CHECK(object.at("faults").at("crash") == with_crash);
}

TEST_CASE("violations of a report are those of its seed", "[cli]") {
  const auto x = judged(said(1, bad_report));
  CHECK(only_violation(x) == "every mote is joined: kitchen/shelf: never joined");
  CHECK(x.violations[0].at == instant(1500ms));
}

TEST_CASE("a run without a report is a violation, whatever the reason", "[cli]") {
  CHECK(only_violation(*judge(7, {-1, SIGKILL, good_report, {}, false}, 300s, true)) ==
        "no end: the run had not ended after 5 min");
  CHECK(only_violation(judged({-1, SIGABRT, {}, "W a log line\nAssertion failed\n", false})) ==
        "no crash: the run ended with signal 6: Assertion failed");
  CHECK(only_violation(judged({-1, SIGSEGV, good_report, {}, false})) ==
        "no crash: the run ended with signal 11");
  CHECK(only_violation(judged({2, 0, {}, "rubicon: no such folder\n", false})) ==
        "a report: the run ended with status 2 and without a report: rubicon: no such folder");
  CHECK(only_violation(judged({-1, SIGKILL, {}, {}, true})) ==
        "a report: the report of the run is too long");
  const auto report = GENERATE(
      as<std::string>{}, "", "{", "[]", "{}", "null",
      R"({"interrupted": false, "complete": true, "reason": "", "events": "many"})",
      R"({"interrupted": false, "complete": true, "reason": "", "events": 1, "simulated_s": 1,
                                   "violations": [{"at_s": 1}]})");
  CHECK(only_violation(judged(said(0, report))).starts_with("a report: the run ended with"));
}

TEST_CASE("a status that does not fit the report is a violation", "[cli]") {
  CHECK(judged(said(1, good_report)).violations.size() == 1);
  CHECK(only_violation(judged(said(0, bad_report))) ==
        "a report: the run ended with status 0 and 1 violations");
}

TEST_CASE("an interrupted run says nothing about its seed", "[cli]") {
  auto report = good_report;
  report.replace(report.find("false"), 5, "true");
  CHECK(!judge(7, said(0, report), 1s, false));
}

TEST_CASE("every seed of a range is given once, and no other", "[cli]") {
  swarm x({3, 5});
  CHECK(x.next() == 3U);
  CHECK(x.next() == 4U);
  CHECK(x.next() == 5U);
  CHECK(!x.next());
  swarm highest({UINT64_MAX, UINT64_MAX});
  CHECK(highest.next() == UINT64_MAX);
  CHECK(!highest.next());
}

TEST_CASE("outcomes are told in the order of their seeds", "[cli]") {
  swarm x({1, 4});
  while (x.next()) {
  }
  CHECK(x.ended(good_outcome(3)).empty());
  CHECK(x.ended(bad_outcome(2)).empty());
  CHECK(x.finished() == 2);
  CHECK(x.so_far().runs == 0);
  CHECK(seeds_of(x.ended(good_outcome(1, 3s))) == seed_list{1, 2, 3});
  CHECK(seeds_of(x.ended(bad_outcome(4))) == seed_list{4});
  const auto& totals = x.so_far();
  CHECK(totals.runs == 4);
  CHECK(totals.failures == 2);
  CHECK(totals.failed_seeds == seed_list{2, 4});
  CHECK(totals.violations.at("rule") == 2);
  CHECK(totals.events == 40);
  CHECK(totals.simulated_s == 8);
  CHECK(totals.slowest_seed == 1U);
  CHECK(totals.slowest == 3s);
}

TEST_CASE("when it is given up, what waits is told and nothing starts", "[cli]") {
  swarm x({1, 9});
  for (int i = 0; i < 4; ++i)
    REQUIRE(x.next());
  CHECK(x.ended(good_outcome(4)).empty());
  CHECK(x.ended(bad_outcome(2)).empty());
  CHECK(seeds_of(x.give_up()) == seed_list{2, 4});
  CHECK(x.so_far().runs == 2);
  CHECK(!x.next());
}

TEST_CASE("one slow seed does not let the others pile up", "[cli]") {
  swarm x({0, 10 * swarm::ahead_max});
  REQUIRE(x.next() == 0U);
  for (std::uint64_t seed = 1; seed < swarm::ahead_max; ++seed) {
    REQUIRE(x.next() == seed);
    REQUIRE(x.ended(good_outcome(seed)).empty());
  }
  CHECK(!x.next());
  CHECK(x.ended(good_outcome(0)).size() == swarm::ahead_max);
  CHECK(x.next() == swarm::ahead_max);
}

TEST_CASE("a replay is a command that a shell understands", "[cli]") {
  CHECK(replay_command({"config/home.toml"}, 7) == "rubicon run config/home.toml --seed 7");
  CHECK(replay_command({"my home.toml", "10min", 2, true}, 7) ==
        "rubicon run 'my home.toml' --seed 7 --for 10min --mode virtual");
  CHECK(replay_command({"it's.toml"}, 7) == "rubicon run 'it'\\''s.toml' --seed 7");
  CHECK(replay_command({"a.toml", {}, 1, false, {"x=1", "y=a b"}}, 7) ==
        "rubicon run a.toml --set x=1 --set 'y=a b' --seed 7");
}

TEST_CASE("each violation is one line", "[cli]") {
  auto x = bad_outcome(7);
  x.violations.push_back({instant{}, "another\033", "line\none"});
  CHECK(violation_lines({"a.toml"}, x) ==
        "seed 7  rule  broken  replay: rubicon run a.toml --seed 7\n"
        "seed 7  another\\x1b  line\\none  replay: rubicon run a.toml --seed 7\n");
}

TEST_CASE("a swarm says what the seed of a violation has drawn", "[cli][ACT-04]") {
  swarm_words words{"a.toml"};
  words.text = "[parameters]\nloss = { from = 0.1, to = 0.5 }\n[radio]\nloss = \"${loss}\"\n"
               "[[fault]]\nkind = \"crash\"\n";
  words.settings = {"ecology.vary_faults=true"};
  std::uint64_t seed = 1;
  while (!config::leaves_out(seed, "crash"))
    ++seed;
  const auto varied = config::variation_of(words.text, words.settings, seed);
  const auto loss = varied.drawn.at("loss");
  const auto lines = violation_lines(words, bad_outcome(seed));
  CHECK(lines == "seed " + std::to_string(seed) + "  (loss=" + loss +
                     ", without crash)  rule  broken  replay: " + replay_command(words, seed) +
                     '\n');
  swarm x({seed, seed});
  REQUIRE(x.next());
  swarm_json listed;
  for (const auto& outcome : x.ended(bad_outcome(seed)))
    listed.add(words, outcome);
  const auto found =
      nlohmann::json::parse(listed.text(x, words, 1s, false)).at("violations").at(0).at("varied");
  CHECK(found == nlohmann::json{{"drawn", {{"loss", loss}}}, {"left_out", {"crash"}}});
}

TEST_CASE("progress tells how far, and which seeds failed", "[cli]") {
  swarm x({1, 200});
  for (int i = 0; i < 4; ++i)
    static_cast<void>(x.next());
  static_cast<void>(x.ended(good_outcome(1)));
  static_cast<void>(x.ended(bad_outcome(2)));
  CHECK(swarm_progress(x, 2s, 100) == "2 of 200 runs  1%  3 min 18 s left  1 with violations: 2");
  for (std::size_t width = 0; width < 70; ++width)
    CHECK(report::display_width(swarm_progress(x, 2s, width)) <= width);
  CHECK(!swarm_progress(swarm({0, UINT64_MAX}), 2s, 100).empty());
}

TEST_CASE("the summary counts, and tells what is missing after an interruption", "[cli]") {
  swarm x({1, 5});
  while (x.next()) {
  }
  static_cast<void>(x.ended(good_outcome(1, 2s)));
  static_cast<void>(x.ended(bad_outcome(2)));
  CHECK(swarm_summary(x, {"a.toml", "", 4}, 2s, true) ==
        "2 runs in 2.00 s, 4 at a time: 1 with violations: 2\n"
        "  rule: 1\n"
        "  20 events, 2.0 ×, slowest seed 1 (2.00 s)\n"
        "interrupted: 3 runs missing\n");
  CHECK(swarm_summary(swarm({1, 5}), {"a.toml"}, 0s, false).find("no violations") !=
        std::string::npos);
}

TEST_CASE("the JSON object lists violations up to a limit and counts the rest", "[cli]") {
  swarm x({0, 4000});
  swarm_json listed;
  for (std::uint64_t seed = 0; seed < swarm::listed_max + 3; ++seed) {
    REQUIRE(x.next() == seed);
    for (const auto& outcome : x.ended(bad_outcome(seed)))
      listed.add({"a.toml"}, outcome);
  }
  const auto object = nlohmann::json::parse(listed.text(x, {"a.toml", "", 4}, 2s, false));
  CHECK(object.at("violations").size() == swarm::listed_max);
  CHECK(object.at("violations_left_out") == 3);
  CHECK(object.at("failed_seeds").size() == swarm::listed_max);
  CHECK(object.at("failures") == swarm::listed_max + 3);
  const auto& first = object.at("violations").at(0);
  CHECK(first.at("seed") == 0);
  CHECK(first.at("at_s") == 1.0);
  CHECK(first.at("replay") == "rubicon run a.toml --seed 0");
}
