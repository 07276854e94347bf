#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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

simulated_component bridge_at(std::shared_ptr<broker_site> site) {
  return {mqtt_bridge({}, bridged_classes(), random_stream(1)), std::move(site)};
}

simulated_component bridged_fan() {
  auto x = bridge_at(std::make_shared<broker_site>());
  static_cast<void>(x.start(start));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.class", "fan"), start));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.status", "active"), start));
  static_cast<void>(x.on_time(start + 2s));
  return x;
}

} // namespace

TEST_CASE("a bridge in virtual time watches tuples and publishes to its broker", "[bridge][mqtt]") {
  auto x = bridge_at(std::make_shared<broker_site>());
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

TEST_CASE("what a file says happens at the simulated broker, also while no bridge lives",
          "[bridge][mqtt]") {
  const auto site = std::make_shared<broker_site>(std::vector<simulated_event>{
      other_publication{"rubicon/kitchen.f/set/switch", "on", false, 10s},
      other_publication{"other", "kept", true, 4s},
      broker_restart{kept_messages::none, 20s},
      other_publication{"late", "kept", true, 21s},
      broker_restart{kept_messages::retained, 22s},
  });
  {
    auto x = bridge_at(site);
    static_cast<void>(x.start(start));
    static_cast<void>(x.on_tuple(bridged_news("kitchen.f.class", "fan"), start));
    std::size_t writes = 0;
    for (auto at = x.deadline(); at && *at <= instant(19s); at = x.deadline())
      for (const auto& each : x.on_time(*at))
        writes += std::holds_alternative<components::write>(each) ? 1 : 0;
    CHECK(writes == 1);
    CHECK(site->broker().retained().at("other") == "kept");
    CHECK(site->broker().retained().at("rubicon/bridge/state") == R"({"state":"online"})");
  }
  CHECK(site->broker().retained().at("rubicon/bridge/state") == R"({"state":"offline"})");
  auto next = bridge_at(site);
  static_cast<void>(next.start(instant(30s)));
  CHECK(!site->deadline());
  CHECK(!site->broker().retained().contains("other"));
  CHECK(site->broker().retained().at("late") == "kept");
}

TEST_CASE("1000 motes of 4 fields are at a simulated broker in the end, announced in 10 s",
          "[bridge][mqtt]") {
  class_model many{"many", "hall.*", {}, {}};
  many.fields = {{"a", "C", {}}, {"b", "%", {}}, {"c", "lx", {}}, {"d", "ppm", {}}};
  const auto site = std::make_shared<broker_site>();
  simulated_component x(mqtt_bridge({}, {many}, random_stream(2)), site);
  static_cast<void>(x.start(start));
  const auto set = [&x](int mote, const char* name, const std::string& text, instant now) {
    const auto key = "hall.m" + std::to_string(mote) + '.' + name;
    static_cast<void>(x.on_tuple(bridged_news(key, text), now));
  };
  for (int i = 0; i < 1000; ++i) {
    set(i, "class", "many", start);
    set(i, "status", "active", start);
  }
  const auto figure = [&x](const std::string& name) {
    const auto all = x.figures();
    return std::ranges::find(all, name, &std::pair<std::string, double>::first)->second;
  };
  // All motes report every 5 s, so that more is to be sent than may be.
  std::vector<std::pair<instant, double>> published;
  int round = 0;
  instant next_report = start;
  for (auto at = x.deadline(); at && *at <= start + 30s; at = x.deadline()) {
    if (next_report <= *at) {
      for (int i = 0; i < 1000; ++i)
        for (const auto* field : {"a", "b", "c", "d"})
          set(i, field, std::to_string(round), next_report);
      ++round;
      next_report += 5s;
    }
    static_cast<void>(x.on_time(*at));
    published.emplace_back(*at, figure("published"));
    if (*at < start + 10s)
      continue;
    const auto announced = std::ranges::count_if(site->broker().retained(), [](const auto& each) {
      return each.first.starts_with("homeassistant/device/");
    });
    REQUIRE(announced == 1000);
  }
  for (std::size_t i = 0, j = 0; i < published.size(); ++i) {
    while (published[i].first - published[j].first >= 1s)
      ++j;
    REQUIRE(published[i].second - (j == 0 ? 0 : published[j - 1].second) <= 200);
  }
  CHECK(site->broker().retained().size() == 3002);
  CHECK(figure("published") > 3002);
}
