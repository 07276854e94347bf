// Programs in Lua: the example, and what comes of errors.
#include <string>
#include <string_view>

#include "ecology/ecology_files.hpp"
#include "script/program.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

double figure_named(const report::run_report& x, std::string_view who, std::string_view name) {
  for (const auto& program : x.programs)
    for (const auto& [each, value] : program.figures)
      if (program.who == who && each == name)
        return value;
  FAIL("no such figure");
  return 0;
}

/// The only program of a mote is this script.
void run_on(config::mote_description& mote, std::string text, bool is_separate) {
  auto config = std::make_shared<const script::program_config>(
      script::program_config{{"wrong.lua", std::move(text)}, {}, {}});
  const apps::app_config program = apps::custom_config{script::make_kind(config, 0), {}};
  auto& all = mote.apps.edit();
  all.clear();
  if (is_separate)
    all.emplace_back(config::separate_app{program});
  else
    all.emplace_back(program);
}

} // namespace

TEST_CASE("scripts sample, switch and list, the same in each run", "[ecology][PAR-05]") {
  const auto hall = example("lua.toml");
  const auto report = run(hall);
  CHECK(report.violations.empty());
  CHECK(report.actors.failures.empty());
  CHECK(report.motes_joined() == 4);
  CHECK(figure_named(report, "hall/panel", "switched") >= 2); // in each period of the temperature
  CHECK(figure_named(report, "hall-gateway", "motes") == 4);
  CHECK(figure_named(report, "hall/fan", "events") >= 4);
  CHECK(figure_named(report, "hall/south", "instructions") > 1000);
  CHECK(run(hall).trace_hash == report.trace_hash);
}

TEST_CASE("an error of a script ends its mote, or the program in its own actor alone",
          "[ecology][ACT-03]") {
  const bool is_separate = GENERATE(false, true);
  auto hall = example("lua.toml");
  hall.length = 2min;
  run_on(hall.islands.at(0).motes.at(0), "after(60, function() local x = nil + 1 end)\n",
         is_separate);
  const auto report = run(hall);
  REQUIRE(report.actors.failures.size() == 1); // its next life waits as long
  const auto& failure = report.actors.failures.at(0);
  INFO(failure);
  CHECK(failure.find("wrong.lua:1: attempt to perform arithmetic on a nil value") !=
        std::string::npos);
  CHECK(failure.find("in function <wrong.lua:1>") != std::string::npos);
  CHECK(report.motes_joined() == 4);
}
