#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

TEST_CASE("the motes of the Intel lab report four values each", "[ecology][GEN-04]") {
  auto lab = example("intel-lab.toml");
  CHECK(lab.length == 24h);
  lab.length = 20min;
  const auto report = run(lab);
  CHECK(report.violations.empty());
  CHECK(report.motes_configured() == 54);
  CHECK(report.motes_joined() == 54);
  REQUIRE(report.proxies.size() == 54);
  for (const auto& x : report.proxies) {
    CHECK(x.status == "active");
    for (const auto* quantity : {"temperature", "humidity", "light", "voltage"})
      CHECK_FALSE(value(x, quantity).empty());
  }
  // One report each 31 s, less the first period and what the air has lost.
  const auto messages = report.messages();
  const auto expected = 54.0 * (20 * 60 / 31.0);
  CHECK(static_cast<double>(messages.unreliable_sent) == Approx(expected).epsilon(0.03));
  CHECK(static_cast<double>(messages.received) >
        0.99 * static_cast<double>(messages.unreliable_sent));
}

TEST_CASE("the Intel lab runs equally twice", "[ecology][GEN-07]") {
  auto lab = example("intel-lab.toml");
  lab.length = 90s;
  CHECK(run(lab, 7).trace_hash == run(lab, 7).trace_hash);
}
