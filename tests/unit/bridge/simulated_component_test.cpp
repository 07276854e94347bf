#include <algorithm>
#include <string>
#include <variant>

#include "bridge/mqtt/simulated_component.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"
#include "unit/bridge/classes.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::bridged_classes;
using test::bridged_news;
using test::start;

namespace {

simulated_component bridged_fan() {
  simulated_component x(mqtt_bridge({}, bridged_classes(), random_stream(1)));
  static_cast<void>(x.start(start));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.class", "fan"), start));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.status", "active"), start));
  static_cast<void>(x.on_time(start + 2s));
  return x;
}

} // namespace

TEST_CASE("a bridge in virtual time watches tuples and publishes to its broker", "[bridge][mqtt]") {
  simulated_component x(mqtt_bridge({}, bridged_classes(), random_stream(1)));
  const auto watches = x.start(start);
  REQUIRE(watches.size() == 7);
  CHECK(std::get<components::watch>(watches[0]).key == "kitchen.*.class");
  const auto fan = bridged_fan();
  CHECK(fan.broker().retained().contains("rubicon/kitchen.f"));
  CHECK(fan.broker().retained().at("rubicon/bridge/state") == R"({"state":"online"})");
}

TEST_CASE("a command by the simulated broker is written to its tuple once", "[bridge][mqtt]") {
  auto x = bridged_fan();
  const auto outputs = x.publish({"rubicon/kitchen.f/set/switch", "on"}, true, start + 3s);
  REQUIRE(outputs.size() == 1);
  CHECK(std::get<components::write>(outputs[0]).key == "kitchen.f.switch");
  CHECK(x.restart_broker(true, start + 4s).empty()); // it is retained, and not executed again
  const auto figures = x.figures();
  const auto found =
      std::ranges::find(figures, "commands retained", &std::pair<std::string, double>::first);
  REQUIRE(found != figures.end());
  CHECK(found->second == 1);
}

TEST_CASE("a broker that has lost all has everything again after its restart", "[bridge][mqtt]") {
  auto x = bridged_fan();
  const auto before = x.broker().retained();
  static_cast<void>(x.restart_broker(false, start + 4s));
  CHECK(x.broker().retained().empty());
  static_cast<void>(x.on_time(start + 6s));
  CHECK(x.broker().retained() == before);
}
