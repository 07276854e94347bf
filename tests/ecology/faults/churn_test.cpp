// Everything that can go, comes and goes (requirements.md part D, 8).
#include <string>

#include <spdlog/spdlog.h>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

TEST_CASE("after hours of churn the picture is true, and nothing has leaked",
          "[ecology][NFR-08][IF-11][IF-13][DIS-07]") {
  spdlog::set_level(spdlog::level::off); // each crash is an error
  auto what = example("scenarios/churn.toml");
  // As many faults an hour as in the file, and the last minutes quiet as there.
  const std::uint32_t part = seeds(2) == 1 ? 48 : 12;
  what.length /= part;
  for (auto& x : what.faults) {
    REQUIRE(x.repeated);
    x.repeated->count /= part;
    x.repeated->until = what.length - 10min;
  }
  const auto report = run(what);
  CHECK(told_violations(report).empty());
  CHECK(report.actors.restarted > 5);
  CHECK(report.motes_left() == 0);
  const auto messages = report.messages();
  CHECK(messages.reliable_sent ==
        messages.reliable_acked + messages.reliable_failed + messages.reliable_open);
  CHECK(messages.reliable_open <= 2); // of the last seconds
  for (const auto& peer : report.peers)
    CHECK(peer.hosts_known == report.peers.size());
  for (const auto& proxy : report.proxies)
    CHECK(proxy.status == "active");
}
