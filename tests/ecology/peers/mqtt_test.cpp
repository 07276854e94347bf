// The home with its bridge to MQTT, while its broker, its PC and its gateway end and begin again.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "bridge/home_assistant/discovery.hpp"
#include "core/numbers/random.hpp"
#include "core/text/decimal.hpp"
#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr std::string_view online = R"({"state":"online"})";
constexpr auto pc = "care-pc";
constexpr duration disturbed_from = 60s;
constexpr duration disturbed_until = 480s;

std::string seconds(duration x) {
  return '"' + std::to_string(x / 1ms) + "ms\"";
}

/// The shipped file without its rules: nobody but the broker's clients writes inputs.
std::string home_without_rules() {
  std::ifstream file(RUBICON_CONFIG_DIR "/bridged-home.toml");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto begin = text.find("[[peer.apps]]\napp = \"rules\"");
  const auto end = text.find("[[proxy]]");
  REQUIRE(begin < end);
  text.erase(begin, end - begin);
  const std::string mqtt = "[mqtt]\n";
  text.insert(text.find(mqtt) + mqtt.size(), "remove_after = \"30s\"\n");
  return text;
}

/// A home whose parts end at random, and what is known of that.
class disturbed_home {
public:
  explicit disturbed_home(std::uint64_t seed) : rng_(seed, "disturbed home") {
    publish(20s, "rubicon/kitchen.ghost/availability", std::string(online), true);
    publish(20s, bridge::discovery_topic({"rubicon", "homeassistant"}, "kitchen.ghost"), "{}",
            true);
    for (auto at = disturbed_from; at < disturbed_until; at += rng_.between(15s, 40s)) {
      times_.push_back(at);
      disturb(at);
    }
    fault(disturbed_until, "kill", "peer = \"care-pc\"\nfor = \"5s\"\n"); // the ghost is found
    times_.push_back(disturbed_until + 5s);
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::vector<duration>& times() const { return times_; }
  [[nodiscard]] std::uint64_t commands() const { return commands_; }

private:
  void publish(duration at, const std::string& topic, const std::string& payload, bool retain) {
    text_ += "[[mqtt.simulated]]\ntopic = '" + topic + "'\npayload = '" + payload +
             "'\nat = " + seconds(at) + "\nretain = " + (retain ? "true" : "false") + '\n';
  }

  void fault(duration at, const std::string& kind, const std::string& more) {
    text_ += "[[fault]]\nkind = \"" + kind + "\"\nat = " + seconds(at) + '\n' + more;
  }

  void disturb(duration at) {
    const auto length = "for = " + seconds(rng_.between(1s, 8s)) + '\n';
    switch (rng_.below(7)) {
    case 0:
    case 1:
      text_ += "[[mqtt.simulated]]\nrestart = \"" +
               std::string(rng_.chance(0.5) ? "empty" : "persistent") + "\"\nat = " + seconds(at) +
               '\n';
      break;
    case 2:
      publish(at, "homeassistant/status", "online", rng_.chance(0.5));
      break;
    case 3:
      fault(at, "kill", "peer = \"kitchen-gateway\"\n" + length);
      break;
    case 4:
      fault(at, "kill", "peer = \"care-pc\"\n" + length);
      break;
    default:
      ++commands_;
      publish(at, "rubicon/kitchen.fan/set/switch", commands_ % 2 == 0 ? "off" : "on",
              rng_.chance(0.5));
    }
  }

  random_stream rng_;
  std::string text_ = home_without_rules();
  std::vector<duration> times_;
  std::uint64_t commands_ = 0;
};

/// What the broker has retained of a topic; empty: nothing.
std::string retained_text(ecology& x, const std::string& topic) {
  const auto& all = x.retained(pc);
  const auto found = all.find(topic);
  return found == all.end() ? std::string() : found->second;
}

/// Whether what the broker has of an object is what its tuples say.
bool is_true(ecology& x, const std::string& name) {
  const auto status = x.tuple(pc, name + ".status");
  const bool active = status == "active";
  if ((retained_text(x, "rubicon/" + name + "/availability") == online) != active)
    return false;
  if (!active)
    return true;
  auto state = nlohmann::json::parse(retained_text(x, "rubicon/" + name), nullptr, false);
  const auto temperature = x.tuple(pc, name + ".temperature");
  const auto outcome = x.tuple(pc, name + ".switch.outcome");
  return state.is_object() &&
         !retained_text(x, bridge::discovery_topic({"rubicon", "homeassistant"}, name)).empty() &&
         (!temperature || state["temperature"] == *number_in(*temperature)) &&
         (!outcome || state["switch_outcome"] == outcome->substr(outcome->rfind(' ') + 1));
}

bool all_is_true(ecology& x) {
  const bool is_online = retained_text(x, "rubicon/bridge/state") == online;
  if (!x.tuple(pc, "kernel.name")) // the PC is off
    return !is_online;
  return is_online && is_true(x, "kitchen.fan") && is_true(x, "kitchen.climate");
}

double figure(const report::run_report& x, const std::string& name) {
  const auto program = std::ranges::find(x.programs, "mqtt", &report::program_report::kind);
  REQUIRE(program != x.programs.end());
  const auto found =
      std::ranges::find(program->figures, name, &std::pair<std::string, double>::first);
  REQUIRE(found != program->figures.end());
  return found->second;
}

} // namespace

TEST_CASE("entities of a home are true within 5 s whatever ends, and no command is written twice",
          "[ecology][mqtt]") {
  for (std::uint64_t seed = 1; seed <= seeds(20); ++seed) {
    CAPTURE(seed);
    const disturbed_home home(seed);
    ecology x(home.text(), {.seed = seed});
    for (const auto at : home.times()) {
      CAPTURE(at / 1ms);
      x.run_until(instant(at));
      CHECK(x.run_until([&] { return all_is_true(x); }, 5s, 100ms));
    }
    x.run_until(instant(590s));
    CHECK(all_is_true(x));
    CHECK(x.tuple(pc, "kitchen.fan.status") == "active");
    for (const auto& [topic, payload] : x.retained(pc)) {
      CAPTURE(topic);
      CHECK(topic.find("ghost") == std::string::npos);
    }
    const auto report = x.finish();
    CHECK(report.violations.empty());
    const auto commands = figure(report, "commands");
    CHECK(commands <= static_cast<double>(home.commands()));
    const auto fan = std::ranges::find(report.proxies, "kitchen.fan", &report::proxy_report::name);
    if (fan != report.proxies.end())
      CHECK(static_cast<double>(fan->actuations.requested) <= commands);
    CHECK(figure(report, "connections") >= 2); // over all lives
  }
}

TEST_CASE("a disturbed home with its bridge comes out the same on any number of threads",
          "[ecology][mqtt][GEN-07]") {
  const auto what = describe(disturbed_home(3).text());
  const auto outcome = [&what](unsigned threads) {
    run_options how;
    how.seed = 3;
    how.threads = threads;
    auto report = run_ecology(what, how);
    report.wall_s = 0;
    return report::to_json(report); // with the hash of its trace
  };
  const auto expected = outcome(1);
  CHECK(outcome(2) == expected);
  CHECK(outcome(3) == expected);
}
