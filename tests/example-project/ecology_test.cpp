// The greenhouse as a whole, with its frost guard.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
#include <testkit/ecology.hpp>

#include "frost_guard.hpp"

using namespace std::chrono_literals;

static rubicon::test::ecology greenhouse() {
  rubicon::test::ecology_options options;
  options.known.applications.add(frost_guard_kind());
  return rubicon::test::ecology::of_file("greenhouse.toml", options);
}

TEST_CASE("the guard warns once of each frost") {
  auto x = greenhouse();
  REQUIRE(x.run_until([&] { return x.logged("bed/south", "frost!"); }, 5min));
  x.run_for(1s); // for the message to the gateway
  CHECK(x.tuple("bed-gateway", "devices.2.output.7") == "\x01");
  const auto report = x.finish();
  CHECK(report.violations.empty());
  REQUIRE(report.programs.size() == 1);
  CHECK(report.programs[0].figures[0] == std::pair<std::string, double>("warnings", 1));
}

TEST_CASE("a warning comes though the gateway is away when it is sent") {
  auto x = greenhouse();
  x.run_until(rubicon::instant(228s));
  x.inject("kind = 'kill'\n"
           "peer = 'bed-gateway'\n"
           "for = '5s'");
  REQUIRE(x.run_until([&] { return x.logged("bed/south", "frost!"); }, 20s));
  CHECK(x.tuple("bed-gateway", "devices.2.output.7") == std::nullopt); // it does not run
  CHECK(x.run_until([&] { return x.tuple("bed-gateway", "devices.2.output.7") == "\x01"; }, 1min));
  x.check_invariants();
}
