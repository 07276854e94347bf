#include <cstdint>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "config/checks/warnings.hpp"
#include "config/load.hpp"
#include "config/run/reload.hpp"
#include "config/toml/written.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

config::loaded load(const std::string& toml, config::settings settings) {
  config::overrides instead;
  instead.settings = std::move(settings);
  return config::load_text(toml, "e.toml", instead);
}

std::string problems_with(const std::string& toml, const config::settings& settings) {
  return problems_of(load(toml, settings));
}

const std::string two_islands = mote_head + "name = \"stove\"\n"
                                            "[[island]]\nname = \"l\"\nid = 2\n";

std::string warning_texts(const config::loaded& x) {
  std::string out;
  for (const auto& each : x.warnings)
    out += to_string(each) + '\n';
  return out;
}

} // namespace

TEST_CASE("a setting writes a key of a table, and makes the table", "[config][GEN-04]") {
  const auto found = load(two_islands, {"ecology.duration=90s", "ecology.seed=7", "radio.loss=0.25",
                                        "island.k.mote.stove.position_m=[3, 4]",
                                        "mote_type.c.transducers.temperature.value=21.5"});
  REQUIRE(problems_of(found) == "none");
  CHECK(found.ecology->length == 90s);
  CHECK(found.ecology->seed == 7);
  CHECK(found.ecology->radio.loss == 0.25);
  CHECK(found.ecology->islands.front().motes.back().place.y_m == 4);
}

TEST_CASE("a setting names tables of an array by name, by number, or all", "[config][GEN-04]") {
  const auto tick = [](const config::loaded& x, std::size_t i) {
    return x.ecology->islands.at(i).sink.place.x_m;
  };
  const auto by_name = load(two_islands, {"island.l.sink.position_m=[5, 0]"});
  REQUIRE(problems_of(by_name) == "none");
  CHECK(tick(by_name, 0) == 0);
  CHECK(tick(by_name, 1) == 5);
  const auto by_number = load(two_islands, {"island.1.sink.position_m=[5, 0]"});
  REQUIRE(problems_of(by_number) == "none");
  CHECK(tick(by_number, 0) == 5);
  const auto all = load(two_islands, {"island.*.sink.position_m=[5, 0]"});
  REQUIRE(problems_of(all) == "none");
  CHECK(tick(all, 0) == 5);
  CHECK(tick(all, 1) == 5);
}

TEST_CASE("what a setting gets wrong is said with the setting", "[config][GEN-06]") {
  CHECK(
      problems_with(two_islands, {"radio.loss=2"}) ==
      "--set radio.loss=2: `loss` must be a ratio from 0 to 1, or from \"0%\" to \"100%\", not 2");
  CHECK(problems_with(two_islands, {"radio.los=0.2"})
            .find("--set radio.los=0.2: unknown key `los` in [radio]: did you mean `loss`?") == 0);
  CHECK(problems_with(two_islands, {"islnd.k.id=3"})
            .find("--set islnd.k.id=3: unknown key `islnd` in the file: did you mean `island`?") ==
        0);
  CHECK(problems_with(two_islands, {"island.m.id=3"}) ==
        "--set island.m.id=3: `island` has no `m`: did you mean `k`?");
  CHECK(problems_with(two_islands, {"island.k.id.x=3"}) ==
        "--set island.k.id.x=3: `island.k.id` is 1, and has no keys");
  CHECK(problems_with(two_islands, {"island.k=3"}) ==
        "--set island.k=3: `island.k` is a table: set one of its keys");
  for (const auto* each : {"", "x", "=3", "a..b=3", "\"a=3"})
    CHECK(problems_with(two_islands, {each}) ==
          "--set " + std::string(each) +
              ": must be the path of a key and its value, as in island.kitchen.id=3");
}

TEST_CASE("the value of a setting is TOML or else a text", "[config][GEN-04]") {
  const auto text = [](const std::string& setting) {
    const auto found = config::resolve("[t]\n", "e.toml", {setting});
    return config::written(*std::get<config::node>(found).find("t"));
  };
  CHECK(text("t.x=1500mAh") == "x = \"1500mAh\"\n");
  CHECK(text("t.x=0.2") == "x = 0.2\n");
  CHECK(text("t.x=3") == "x = 3\n");
  CHECK(text("t.x=\"3\"") == "x = \"3\"\n");
  CHECK(text("t.x=true") == "x = true\n");
  CHECK(text("t.x=") == "x = \"\"\n");
  CHECK(text("t.x=a = b") == "x = \"a = b\"\n");
  CHECK(text("t.x=1\ny=2") == "x = \"1\\u000ay=2\"\n");
  CHECK(text("t.x=2038-01-19") == "x = \"2038-01-19\"\n");
  CHECK(text("t.\"a.b\"=[1, 2]") == "\"a.b\" = [1, 2]\n");
}

TEST_CASE("a later setting of a key wins", "[config][GEN-04]") {
  const auto found = load(two_islands, {"ecology.seed=7", "ecology.seed=8"});
  REQUIRE(problems_of(found) == "none");
  CHECK(found.ecology->seed == 8);
}

TEST_CASE("texts of a file name its parameters", "[config][GEN-04]") {
  const auto toml = two_islands + "[parameters]\nloss = 0.1\nmetres = 40\n"
                                  "[radio]\nloss = \"${loss}\"\nrange = \"${metres}m\"\n";
  auto found = load(toml, {});
  REQUIRE(problems_of(found) == "none");
  CHECK(found.ecology->radio.loss == 0.1);
  CHECK(warning_texts(found).empty());
  for (const auto* each : {"loss=0.3", "parameters.loss=0.3"}) {
    found = load(toml, {each});
    REQUIRE(problems_of(found) == "none");
    CHECK(found.ecology->radio.loss == 0.3);
  }
  CHECK(problems_with(toml, {"loss=3"}).find("not 3") != std::string::npos);
}

TEST_CASE("a setting of a parameter that the file does not have is refused", "[config][GEN-06]") {
  const auto toml = two_islands + "[parameters]\nloss = 0.1\n[radio]\nloss = \"${loss}\"\n";
  for (const std::string each : {"los=0.3", "parameters.los=0.3"})
    CHECK(problems_with(toml, {each}) == "--set " + each +
                                             ": there is no parameter `los` in [parameters]: did "
                                             "you mean `loss`?");
  CHECK(problems_with(two_islands, {"parameters.loss=1"}) ==
        "--set parameters.loss=1: there is no parameter `loss` in [parameters]: there is none");
}

TEST_CASE("a mistake with parameters has a place", "[config][GEN-06]") {
  const auto after = [](const std::string& rest) {
    return problems_of(load(std::string(head) + rest, {}));
  };
  CHECK(after("[parameters]\nloss = 0.1\n[radio]\nloss = \"${los}\"\n") ==
        "e.toml:9:8: there is no parameter `los` in [parameters]: did you mean `loss`?");
  CHECK(after("[parameters]\nloss = 0.1\n[radio]\nrange = \"${loss\"\n") ==
        "e.toml:9:9: `${` has no `}`; a plain one is `$${`");
  CHECK(after("[parameters]\nloss = [1]\n") ==
        "e.toml:7:8: `loss` must be a text, a number, true or false, or a table with `from` and "
        "`to`, not an array of 1");
  CHECK(after("[parameters]\na = 1\nb = \"${a}\"\n") ==
        "e.toml:8:5: a parameter cannot name another");
  CHECK(after("[parameters]\n\"a b\" = 1\n") ==
        "e.toml:7:1: a parameter's name has letters, digits, - and _, at most 32");
}

TEST_CASE("a parameter with a range is drawn by the seed alone", "[config][GEN-04]") {
  const auto toml = two_islands + "[parameters]\nloss = { from = 0.1, to = 0.5 }\n"
                                  "metres = { from = 20, to = 22 }\n"
                                  "length = { from = \"0.1s\", to = \"0.5s\" }\n"
                                  "[radio]\nloss = \"${loss}\"\nrange = \"${metres}m\"\n"
                                  "[[fault]]\nat = \"1s\"\nkind = \"radio_loss\"\nloss = 1\n"
                                  "for = \"${length}\"\n";
  std::set<double> losses;
  std::set<duration> lengths;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    config::overrides instead;
    instead.seed = seed;
    const auto found = config::load_text(toml, "e.toml", instead);
    REQUIRE(problems_of(found) == "none");
    const auto loss = found.ecology->radio.loss;
    CHECK((loss >= 0.1 && loss <= 0.5));
    const auto& fault = std::get<config::radio_loss_fault>(found.ecology->faults.at(0).what);
    CHECK((fault.length >= 100ms && fault.length <= 500ms));
    losses.insert(loss);
    lengths.insert(fault.length);
    const auto again = load(toml, {"ecology.seed=" + std::to_string(seed)});
    REQUIRE(problems_of(again) == "none");
    CHECK(again.ecology->radio.loss == loss);
  }
  CHECK(losses.size() > 15);
  CHECK(lengths.size() > 15);
  const auto set = load(toml, {"loss=0.75"});
  REQUIRE(problems_of(set) == "none");
  CHECK(set.ecology->radio.loss == 0.75);
}

TEST_CASE("a file with its settings still draws its parameters", "[config][GEN-04]") {
  const auto toml = two_islands + "[parameters]\nloss = { from = 0.1, to = 0.5 }\n"
                                  "[radio]\nloss = \"${loss}\"\n";
  const auto text = config::resolved_text(toml, {"island.l.id=3"});
  const auto loss_of = [&text](std::uint64_t seed) {
    config::overrides instead;
    instead.seed = seed;
    const auto found = config::load_text(text, "e.toml", instead);
    REQUIRE(problems_of(found) == "none");
    return found.ecology->radio.loss;
  };
  CHECK(loss_of(1) != loss_of(2));
}

TEST_CASE("a range that is none has a place", "[config][GEN-06]") {
  const auto with = [](const std::string& range) {
    return problems_of(load(std::string(head) + "[parameters]\na = " + range + "\n", {}));
  };
  CHECK(with("{ from = 1 }") == "e.toml:7:5: `a` needs `from` and `to`, each a number, or a text "
                                "that begins with one");
  CHECK(with("{ from = \"s\", to = 1 }").starts_with("e.toml:7:5: `a` needs `from` and `to`"));
  CHECK(with("{ from = \"1s\", to = \"1min\" }") ==
        "e.toml:7:5: `from` and `to` of `a` must have the same unit");
  CHECK(with("{ from = 2, to = 1 }") == "e.toml:7:5: `to` of `a` must not be less than `from`");
  CHECK(with("{ from = 1, to = 2, by = 1 }") ==
        "e.toml:7:25: unknown key `by`: a range has `from` and `to`");
}

TEST_CASE("a parameter that nothing names is a warning", "[config][GEN-06]") {
  const auto found = load(std::string(head) + "[parameters]\nloss = 0.1\n", {});
  CHECK(warning_texts(found) == "e.toml:7:1: no value names the parameter `loss`\n");
}

TEST_CASE("texts keep what is no parameter", "[config][GEN-04]") {
  const auto text = [](const std::string& toml) {
    return config::written(std::get<config::node>(config::resolve(toml, "e.toml", {})));
  };
  CHECK(text("x = \"${HOME}\"\n") == "x = \"${HOME}\"\n");
  CHECK(text("x = \"$${HOME} ${a}\"\n[parameters]\na = 1.0\n") == "x = \"${HOME} 1.0\"\n");
}

TEST_CASE("a written file reads as the file that it was made of", "[config][GEN-04]") {
  const auto toml = std::string("x = [1, [2.5, \"a\\\"\\n\\u007f\"], { y = true }]\n"
                                "e = []\nn = 1e30\ni = -inf\n[t]\n\"k.k\" = 1\n[t.u]\n"
                                "[[t.v]]\na = 1\n[[t.v.w]]\n[[t.v]]\nb = 2\n");
  const auto once = config::written(std::get<config::node>(config::parse(toml, "")));
  const auto again = config::parse(once, "");
  REQUIRE(std::holds_alternative<config::node>(again));
  CHECK(config::written(std::get<config::node>(again)) == once);
  CHECK(once ==
        "x = [1, [2.5, \"a\\\"\\u000a\\u007f\"], { y = true }]\ne = []\nn = 1e+30\ni = -inf\n"
        "\n[t]\n\"k.k\" = 1\n\n[t.u]\n\n[[t.v]]\na = 1\n\n[[t.v.w]]\n\n[[t.v]]\nb = 2\n");
}

TEST_CASE("a file with its settings is one that needs none", "[config][GEN-04]") {
  const config::settings settings{"radio.loss=0.25", "island.l.id=3"};
  const auto text = config::resolved_text(two_islands, settings);
  const auto found = load(text, {});
  REQUIRE(problems_of(found) == "none");
  CHECK(found.ecology->radio.loss == 0.25);
  CHECK(found.ecology->islands.back().id == island_id{3});
  CHECK(config::resolved_text(two_islands, {}) == two_islands);
}

TEST_CASE("settings hold when a file is read again", "[config][ACT-10]") {
  config::overrides instead;
  instead.settings = {"island.k.mote.stove.position_m=[3, 4]"};
  config::followed_file file(two_islands, "e.toml", instead, {});
  CHECK(file.read(two_islands, 0s).refused.empty());
  const auto with = two_islands + "[parameters]\nunused = 1\n";
  CHECK(file.read(with, 0s).refused.empty());
}
