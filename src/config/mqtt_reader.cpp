// [mqtt]
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bridge/home_assistant/discovery.hpp"
#include "bridge/mqtt/mqtt_keys.hpp"
#include "bridge/mqtt/mqtt_settings.hpp"
#include "bridge/table/class_model.hpp"
#include "config/bridge_peer.hpp"
#include "config/checks/tuple_keys.hpp"
#include "config/file_readers.hpp"
#include "core/text/host_port.hpp"

namespace rubicon::config {

namespace {

/// What the file says of it beside the bridge's own settings.
struct bridge_place {
  std::string peer;
  std::optional<named_values<bridge::platform>> platforms;
};

auto bridge_peer_keys() {
  return keys::of(keys::required("peer", &bridge_place::peer, bridge_peer{},
                                 "whose kernel the bridge uses: it reads tuples of all peers, and "
                                 "writes inputs, as this one"));
}

auto platform_keys() {
  return keys::of(keys::optional(
      "platforms", &bridge_place::platforms,
      pairs_of<word<bridge::platform>>{bridge::platform_words()},
      {"platforms of Home Assistant by field or input of a class, as in `{ \"fan.switch\" = "
       "\"switch\" }`",
       "by quantity and words, see [bridges.md](bridges.md#platforms)"}));
}

std::string why_unfit(const std::string& name, bridge::platform as,
                      const std::vector<proxy::proxy_class>& classes) {
  const auto dot = name.find('.');
  const auto of = std::ranges::find(classes, name.substr(0, dot), &proxy::proxy_class::name);
  if (dot == std::string::npos || of == classes.end())
    return "`platforms`: no class is named `" + name.substr(0, dot) +
           "`; give CLASS.FIELD or CLASS.INPUT";
  const auto model = bridge::model_of(*of);
  const auto part = name.substr(dot + 1);
  bool known = false;
  bool fit = false;
  for (const auto& each : model.fields)
    if (each.name == part) {
      known = true;
      fit = fit || bridge::fits(each, as);
    }
  for (const auto& each : model.inputs)
    if (each.name == part) {
      known = true;
      fit = fit || bridge::fits(each, as);
    }
  if (!known)
    return "`platforms`: class `" + model.name + "` has no field or input `" + part + '`';
  return fit ? std::string()
             : '`' + name + "` cannot be a " + std::string(bridge::to_string(as)) +
                   ": its words and numbers do not fit";
}

void read_topics(table_reader& in, bridge::mqtt_config& out) {
  uniqueness<std::string> taken;
  in.tables("topic", "[[mqtt.topic]]", {"topics of others as tuples", "none"},
            [&](table_reader& x) {
              bridge::topic_rule rule;
              x.all(rule);
              if (x.is_good("topic") && (rule.topic.find_first_of("+#") != std::string::npos ||
                                         rule.topic.starts_with(out.base + '/')))
                x.problems().add(x.at("topic"), "`" + rule.topic +
                                                    "` has a wildcard, or is below `base`: only "
                                                    "topics of others become tuples");
              if (x.is_good("key"))
                taken.add(rule.key, "tuple `" + rule.key + '`', x.at("key"), x.problems());
              out.topics.push_back(std::move(rule));
            });
}

void read_simulated(table_reader& in, std::vector<bridge::simulated_event>& out) {
  in.tables("simulated", "[[mqtt.simulated]]",
            {"what happens at the simulated broker, in virtual time", "nothing"},
            [&](table_reader& x) {
              x.either([&out](auto event) { out.emplace_back(std::move(event)); },
                       bridge::keys_of(static_cast<const bridge::broker_restart*>(nullptr)),
                       bridge::keys_of(static_cast<const bridge::other_publication*>(nullptr)));
              const auto* event =
                  out.empty() ? nullptr : std::get_if<bridge::other_publication>(&out.back());
              if (event != nullptr && x.is_good("topic") &&
                  event->topic.find_first_of("+#") != std::string::npos)
                x.problems().add(x.at("topic"), '`' + event->topic +
                                                    "` has a wildcard: a client publishes to one "
                                                    "topic");
            });
}

void check_names(const table_reader& in, const bridge::mqtt_config& x) {
  if (x.home_assistant && x.base == x.discovery && (in.is_good("base") || in.is_good("discovery")))
    in.problems().add(in.at(in.has("base") ? "base" : "discovery"),
                      "`base` and `discovery` must differ: below `discovery` are the topics of "
                      "Home Assistant");
}

void check_broker(const table_reader& in, const bridge::broker_config& x) {
  const auto where = parse_host_port(x.address);
  if (in.is_good("broker") && (!where || where->host.empty()))
    in.problems().add(in.at("broker"), "`broker` must be HOST:PORT, as in \"127.0.0.1:1883\"");
  if (in.has("password_file") && !in.has("user"))
    in.problems().add(in.at("password_file"), "`password_file` needs `user`");
}

} // namespace

void read_mqtt(table_reader& root, ecology_description& out) {
  root.table(
      "mqtt", "[mqtt]",
      {"a bridge to an MQTT broker and Home Assistant ([bridges.md](bridges.md))", "none"},
      [&](table_reader& in) {
        auto all = std::make_shared<bridge::mqtt_settings>();
        bridge_place place;
        in.all(place, bridge_peer_keys());
        in.all(all->broker);
        in.table("tls", "[mqtt.tls]",
                 {"the connection is encrypted, and the broker proves who it is", "not encrypted"},
                 [&](table_reader& x) {
                   all->broker.tls = true;
                   x.all(all->broker, bridge::tls_keys());
                   if (x.has("certificate") != x.has("key") && !x.walks())
                     x.problems().add(x.at(), "`certificate` and `key` need each other");
                 });
        in.all(all->bridge);
        read_topics(in, all->bridge);
        read_simulated(in, all->simulated);
        in.all(place, platform_keys());
        if (in.walks())
          return;
        check_broker(in, all->broker);
        check_names(in, all->bridge);
        for (const auto& [name, as] : place.platforms.value_or(named_values<bridge::platform>())) {
          if (auto why = why_unfit(name.value, as, out.proxies); !why.empty())
            in.problems().add(name.at, std::move(why));
          all->bridge.platforms[name.value] = as;
        }
        if (const auto* files = in.shared().files; files != nullptr) {
          all->folder = std::filesystem::path(files->toml).parent_path().string();
          all->place = files->toml + ':' + std::to_string(in.at().line);
        }
        if (all->broker.client.empty())
          all->broker.client = all->bridge.base + '-' + place.peer;
        if (in.problems().empty())
          all->bridge.labels = object_labels(out);
        add_bridge(out, place.peer, mqtt_app{std::move(all)});
      });
}

} // namespace rubicon::config
