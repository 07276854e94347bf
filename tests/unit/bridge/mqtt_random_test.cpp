#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "bridge/mqtt/mqtt_bridge.hpp"
#include "bridge/mqtt/simulated_broker.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"
#include "support/start.hpp"
#include "unit/bridge/classes.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::start;

namespace {

constexpr std::uint32_t bridge_client = 1;
constexpr std::uint32_t home_client = 2;
constexpr std::uint32_t object_count = 5;

/// A home: fans with their tuples, a bridge, a broker, and who sends commands. Bridge, broker and
/// fans end and begin at random, and messages are delayed.
class random_home {
public:
  explicit random_home(std::uint64_t seed) : rng_(seed, "home") {}

  void run() {
    begin_bridge();
    for (std::uint32_t i = 0; i < object_count; ++i)
      appear(i);
    for (int i = 0; i < 60; ++i) {
      advance(now_ + rng_.between(0s, 2s));
      disturb();
    }
    if (!connected_)
      connect();
    advance(now_ + 5s);
  }

  /// Until what an earlier life has announced is removed: a sweep and `remove_after`.
  void settle() { advance(now_ + 7s); }

  void check_entities() const {
    const auto& all = broker_.retained();
    CHECK(all.at("rubicon/bridge/state") == online);
    for (std::uint32_t i = 0; i < object_count; ++i) {
      const auto name = name_of(i);
      const auto available = all.find("rubicon/" + name + "/availability");
      INFO(name);
      if (!fans_.contains(i)) {
        CHECK((available == all.end() || available->second != online));
        continue;
      }
      REQUIRE(available != all.end());
      CHECK((available->second == online) == fans_.at(i).active);
      CHECK(all.contains(announcement_of(i)));
      REQUIRE(all.contains("rubicon/" + name));
      const auto state = nlohmann::json::parse(all.at("rubicon/" + name));
      CHECK(state["rssi"] == fans_.at(i).rssi);
      // A bridge that has begun anew knows the last outcome alone.
      const auto outcome = tuples_.find(name + ".speed.outcome");
      const bool failed = outcome != tuples_.end() && outcome->second.ends_with("failed");
      if (fans_.at(i).speed > 0 && !(failed && state["speed"].is_null()))
        CHECK(state["speed"] == fans_.at(i).speed);
    }
  }

  void check_ghosts() const {
    for (std::uint32_t i = 0; i < object_count; ++i)
      if (!fans_.contains(i))
        for (const auto& topic : {announcement_of(i), "rubicon/" + name_of(i),
                                  "rubicon/" + name_of(i) + "/availability"}) {
          INFO(topic);
          CHECK(!broker_.retained().contains(topic));
        }
  }

  void check_commands() const {
    for (const auto& [value, times] : executed_) {
      INFO("command " << value);
      CHECK(times == 1);
    }
  }

  [[nodiscard]] std::size_t executed() const { return executed_.size(); }

private:
  struct fan {
    bool active = true;
    int rssi = -40;
    int speed = 0; ///< acknowledged; 0: none
  };

  static constexpr std::string_view online = R"({"state":"online"})";

  static std::string announcement_of(std::uint32_t i) {
    return discovery_topic({"rubicon", "homeassistant"}, name_of(i));
  }

  static std::string name_of(std::uint32_t i) { return "kitchen.fan-" + std::to_string(i); }

  void at(instant when, std::function<void()> what) {
    events_.emplace(std::pair(when, ++last_event_), std::move(what));
  }

  void advance(instant end) {
    while (true) {
      const auto due = bridge_ ? bridge_->deadline() : std::nullopt;
      const auto next = events_.empty() ? end + 1s : events_.begin()->first.first;
      if (due && *due <= end && *due <= next) {
        now_ = std::max(now_, *due);
        perform(bridge_->on_time(now_));
      } else if (next <= end) {
        now_ = std::max(now_, next);
        auto event = events_.extract(events_.begin());
        event.mapped()();
      } else
        break;
    }
    now_ = end;
  }

  void perform(mqtt_outputs todo) {
    for (auto& each : todo) {
      if (auto* x = std::get_if<subscription>(&each))
        deliver(broker_.subscribe(bridge_client, x->topic));
      else if (auto* gone = std::get_if<unsubscription>(&each))
        broker_.unsubscribe(bridge_client, gone->topic);
      else if (auto* sent = std::get_if<publication>(&each))
        deliver(broker_.publish(*sent, true));
      else if (auto* write = std::get_if<components::write>(&each))
        execute(*write);
    }
  }

  void deliver(const simulated_broker::deliveries& all) {
    for (const auto& each : all)
      if (each.client == bridge_client)
        at(now_ + 1ms, [this, each, life = connection_] {
          if (life == connection_ && connected_)
            perform(bridge_->on_message({each.topic, each.payload, each.retained}, now_));
        });
  }

  void execute(const components::write& x) {
    const int value = std::stoi(x.text);
    ++executed_[value];
    const bool acknowledged = rng_.chance(0.7);
    const auto key = x.key;
    at(now_ + rng_.between(0s, 1s), [this, key, value, acknowledged] {
      for (auto& [i, each] : fans_)
        if (key == name_of(i) + ".speed") {
          if (acknowledged)
            each.speed = value;
          set(key + ".outcome",
              std::to_string(value) + (acknowledged ? " acknowledged" : " failed"));
        }
    });
  }

  void set(const std::string& key, const std::string& text) {
    tuples_[key] = text;
    if (bridge_)
      perform(bridge_->on_tuple(test::bridged_news(key, text), now_));
  }

  void appear(std::uint32_t i) {
    fans_[i] = {};
    set(name_of(i) + ".class", "fan");
    set(name_of(i) + ".status", "active");
    set(name_of(i) + ".rssi", "-40");
  }

  void disappear(std::uint32_t i) {
    fans_.erase(i);
    std::erase_if(tuples_, [&](const auto& each) {
      if (!each.first.starts_with(name_of(i) + '.'))
        return false;
      if (bridge_)
        perform(bridge_->on_tuple(test::bridged_deletion(each.first), now_));
      return true;
    });
  }

  void begin_bridge() {
    mqtt_config config;
    config.remove_after = 3s;
    bridge_ =
        std::make_unique<mqtt_bridge>(config, test::bridged_classes(), random_stream(rng_.next()));
    at(now_ + rng_.between(0s, 1s), [this] {
      for (const auto& [key, text] : tuples_)
        perform(bridge_->on_tuple(test::bridged_news(key, text), now_));
    });
    connect();
  }

  void connect() {
    ++connection_;
    connected_ = true;
    broker_.connect(bridge_client, bridge_->last_will());
    perform(bridge_->on_connected(now_));
  }

  void disconnect() {
    connected_ = false;
    deliver(broker_.lose(bridge_client));
    bridge_->on_disconnected();
    at(now_ + rng_.between(0s, 3s), [this, life = connection_] {
      if (!connected_ && life == connection_)
        connect();
    });
  }

  void disturb() {
    const auto i = static_cast<std::uint32_t>(rng_.below(object_count));
    switch (rng_.below(10)) {
    case 0: // the process of the bridge is killed
      static_cast<void>(broker_.lose(bridge_client));
      begin_bridge();
      break;
    case 1: // the broker is
      broker_.restart(rng_.chance(0.5));
      if (connected_)
        disconnect();
      break;
    case 2: // the connection is lost
      if (connected_)
        disconnect();
      break;
    case 3:
      deliver(broker_.publish({"homeassistant/status", "online"}, rng_.chance(0.5)));
      break;
    case 4:
      if (fans_.contains(i))
        disappear(i);
      break;
    case 5:
      if (!fans_.contains(i))
        appear(i);
      break;
    case 6:
      if (fans_.contains(i)) {
        fans_[i].active = !fans_[i].active;
        set(name_of(i) + ".status", fans_[i].active ? "active" : "lost");
      }
      break;
    case 7:
      if (fans_.contains(i)) {
        fans_[i].rssi = -static_cast<int>(rng_.below(90)) - 1;
        set(name_of(i) + ".rssi", std::to_string(fans_[i].rssi));
      }
      break;
    default: // a command, of which some are retained by who sends them
      deliver(broker_.publish({"rubicon/" + name_of(i) + "/set/speed", std::to_string(++value_)},
                              rng_.chance(0.5)));
    }
  }

  random_stream rng_;
  instant now_ = start;
  std::unique_ptr<mqtt_bridge> bridge_;
  simulated_broker broker_;
  bool connected_ = false;
  std::uint64_t connection_ = 0;
  std::map<std::uint32_t, fan> fans_;
  std::map<std::string, std::string> tuples_;
  std::map<int, int> executed_; ///< how often, by the value of the command
  int value_ = 0;
  std::map<std::pair<instant, std::uint64_t>, std::function<void()>> events_;
  std::uint64_t last_event_ = 0;
};

} // namespace

TEST_CASE("entities are true, none is left behind and no command is executed twice, whatever ends",
          "[bridge][mqtt]") {
  std::size_t executed = 0;
  for (std::uint64_t seed = 1; seed <= test::seeds(1000); ++seed) {
    INFO("seed " << seed);
    random_home home(seed);
    home.run();
    home.check_entities();
    home.settle();
    home.check_entities();
    home.check_ghosts();
    home.check_commands();
    executed += home.executed();
  }
  CHECK(executed > 0);
}
