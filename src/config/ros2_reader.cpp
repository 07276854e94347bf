// [[ros2]]
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bridge/ros2/message_template.hpp"
#include "bridge/ros2/message_types.hpp"
#include "bridge/ros2/ros2_keys.hpp"
#include "bridge/ros2/ros2_settings.hpp"
#include "bridge/ros2/rosbridge_place.hpp"
#include "config/bridge_peer.hpp"
#include "config/file_readers.hpp"
#include "core/text/spelling.hpp"
#include "translate/pattern.hpp"

namespace rubicon::config {

namespace {

constexpr std::string_view set_bool_type = "std_srvs/srv/SetBool";
constexpr std::string_view trigger_type = "std_srvs/srv/Trigger";

struct ros2_place {
  std::string peer;
};

auto ros2_place_keys() {
  return keys::of(keys::required("peer", &ros2_place::peer, bridge_peer{},
                                 "whose kernel the bridge uses: it reads tuples of all peers, and "
                                 "writes as this one"));
}

/// What is good of one table is checked further.
struct ros2_checker {
  const table_reader& in;

  void complain(std::string_view key, std::string what) const {
    in.problems().add(in.at(key), std::move(what));
  }

  void name(std::string_view key, const std::string& x, std::size_t blanks = 0) const {
    if (in.is_good(key) && !bridge::is_ros_name(x, blanks))
      complain(key, '`' + x +
                        "` is no name in ROS: letters, digits and `_` between slashes, as in "
                        "`kitchen/fan`" +
                        (blanks > 0 ? std::string(", and {1} to {") + std::to_string(blanks) + '}'
                                    : std::string()));
  }

  /// Writes the type in full. @param part `msg` or `srv`
  /// @returns whether it is one
  bool type(std::string& x, std::string_view part) const {
    if (const auto full = bridge::full_type(x, part)) {
      x = *full;
      return in.is_good("type") || x == set_bool_type;
    }
    if (in.is_good("type"))
      complain("type", '`' + x + "` is no type of ROS: give PACKAGE/NAME");
    return false;
  }

  /// A type of messages that the bridge knows, or a key that says what it is.
  void message_type(std::string& x, std::string_view key) const {
    const auto& all = bridge::known_types();
    if (type(x, "msg") && !in.has(key) && std::ranges::find(all, x) == all.end())
      complain("type", '`' + x + "` needs `" + std::string(key) + '`' + suggestion(x, all));
  }

  void document(std::string_view key, const std::string& x,
                const std::vector<std::string>& known_blanks) const {
    if (!in.is_good(key))
      return;
    const bridge::message_template made(x);
    if (!made.is_valid())
      return complain(key, '`' + std::string(key) + "` must be a JSON object");
    for (const auto& each : made.blanks())
      if (std::ranges::find(known_blanks, each) == known_blanks.end())
        return complain(key, "no blank is named `$" + each + '`' + suggestion(each, known_blanks));
  }
};

/// So that the check of tuples knows what the bridge does with this one.
void note_use(const table_reader& x, const std::string& who, const std::string& key) {
  if (x.is_good("key"))
    x.shared().seen.uses.push_back({who, key, x.at("key")});
}

void read_publications(table_reader& in, const std::string& who, bridge::ros2_config& out) {
  uniqueness<std::string> taken;
  in.tables("publish", "[[ros2.publish]]", {"tuples as topics of ROS", "none"},
            [&](table_reader& x) {
              bridge::topic_publication rule;
              x.all(rule);
              if (x.walks())
                return;
              const ros2_checker check{x};
              const auto stars = std::min<std::size_t>(translate::stars_in(rule.key), 9);
              check.name("topic", rule.topic, x.is_good("key") ? stars : 9);
              check.message_type(rule.type, "message");
              check.document("message", rule.content, bridge::message_blanks());
              const auto topic = bridge::absolute_name(out.name_space, rule.topic);
              if (out.clock_every && topic == "/clock")
                check.complain("topic", "`/clock` is published by `clock`");
              if (x.is_good("topic"))
                taken.add(topic, "topic `" + topic + '`', x.at("topic"), x.problems());
              note_use(x, who + " publishes", rule.key);
              out.publications.push_back(std::move(rule));
            });
}

/// What comes back from the server would be published again, and so on.
bool is_circle(const bridge::ros2_config& x, const bridge::topic_subscription& rule) {
  const auto topic = bridge::absolute_name(x.name_space, rule.topic);
  return std::ranges::any_of(x.publications, [&](const auto& each) {
    return bridge::absolute_name(x.name_space, each.topic) == topic &&
           translate::match(each.key, rule.key);
  });
}

void read_subscriptions(table_reader& in, bridge::ros2_config& out) {
  uniqueness<std::string> taken;
  in.tables("subscribe", "[[ros2.subscribe]]", {"topics of ROS as tuples", "none"},
            [&](table_reader& x) {
              bridge::topic_subscription rule;
              x.all(rule);
              if (x.walks())
                return;
              const ros2_checker check{x};
              check.name("topic", rule.topic);
              check.message_type(rule.type, "member");
              if (x.has("value") && !x.has("member"))
                check.complain("value", "`value` needs `member`");
              if (x.is_good("topic") && x.is_good("key") && is_circle(out, rule))
                check.complain("key", "`" + rule.key + "` is published on the topic that sets it");
              if (x.is_good("key"))
                taken.add(rule.key, "tuple `" + rule.key + '`', x.at("key"), x.problems());
              out.subscriptions.push_back(std::move(rule));
            });
}

void read_offers(table_reader& in, const std::string& who, bridge::ros2_config& out) {
  uniqueness<std::string> taken;
  in.tables("service", "[[ros2.service]]", {"services that write tuples", "none"},
            [&](table_reader& x) {
              bridge::offered_service rule;
              x.all(rule);
              if (x.walks())
                return;
              const ros2_checker check{x};
              check.name("service", rule.service);
              check.document("response", rule.content, {"success", "message"});
              if (check.type(rule.type, "srv") && !x.has("value") && !x.has("member") &&
                  rule.type != set_bool_type)
                x.problems().add(x.at(), "a service of `" + rule.type +
                                             "` needs `value` or `member`: what it writes");
              if (x.is_good("service"))
                taken.add(bridge::absolute_name(out.name_space, rule.service),
                          "service `" + rule.service + '`', x.at("service"), x.problems());
              note_use(x, who + " writes", rule.key);
              out.offers.push_back(std::move(rule));
            });
}

void read_requests(table_reader& in, bridge::ros2_config& out) {
  uniqueness<std::string> taken;
  in.tables("call", "[[ros2.call]]", {"tuples whose values are requests to services", "none"},
            [&](table_reader& x) {
              bridge::requested_service rule;
              x.all(rule);
              if (x.walks())
                return;
              const ros2_checker check{x};
              check.name("service", rule.service);
              check.document("request", rule.content, bridge::message_blanks());
              if (check.type(rule.type, "srv") && !x.has("request") && rule.type != set_bool_type &&
                  rule.type != trigger_type)
                check.complain("type", '`' + rule.type + "` needs `request`");
              if (x.is_good("key"))
                taken.add(rule.key, "tuple `" + rule.key + '`', x.at("key"), x.problems());
              out.requests.push_back(std::move(rule));
            });
}

void check_server(const ros2_checker& check, const bridge::ros2_settings& x) {
  const auto& in = check.in;
  const auto where = bridge::parse_rosbridge_place(x.server);
  if (in.is_good("server") && !where)
    check.complain("server", "`server` must be HOST:PORT or wss://HOST:PORT, as in "
                             "\"127.0.0.1:9090\"");
  if (in.is_good("path") && !x.path.starts_with('/'))
    check.complain("path", "`path` must begin with `/`");
  for (const auto* key : {"ca_file", "verify"})
    if (in.has(key) && where && !where->tls)
      check.complain(key, '`' + std::string(key) + "` needs TLS: `server = \"wss://" +
                              where->where.host + ':' + std::to_string(where->where.port) + "\"`");
  if (in.has("ca_file") && !x.verify)
    check.complain("ca_file", "`ca_file` has no use with `verify = false`");
}

} // namespace

void read_ros2(table_reader& root, ecology_description& out) {
  root.tables("ros2", "[[ros2]]", {"bridges to ROS 2 ([bridges.md](bridges.md#ros-2))", "none"},
              [&](table_reader& in) {
                auto all = std::make_shared<bridge::ros2_settings>();
                ros2_place place;
                in.all(place, ros2_place_keys());
                in.all(*all);
                in.all(all->bridge);
                const auto who = "the ROS 2 bridge of " + place.peer;
                read_publications(in, who, all->bridge);
                read_subscriptions(in, all->bridge);
                read_offers(in, who, all->bridge);
                read_requests(in, all->bridge);
                if (in.walks())
                  return;
                const ros2_checker check{in};
                check_server(check, *all);
                if (const auto* files = in.shared().files; files != nullptr) {
                  all->folder = std::filesystem::path(files->toml).parent_path().string();
                  all->place = files->toml + ':' + std::to_string(in.at().line);
                }
                check.name("namespace", all->bridge.name_space);
                add_bridge(out, place.peer, ros2_app{std::move(all)});
              });
}

} // namespace rubicon::config
