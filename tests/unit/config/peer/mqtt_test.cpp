#include <algorithm>
#include <string>
#include <variant>

#include "bridge/mqtt/mqtt_settings.hpp"
#include "config/checks/tuple_keys.hpp"
#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using rubicon::test::check_mistakes;
using rubicon::test::good;
using rubicon::test::proxy_head;

namespace {

const std::string fan_head = proxy_head + "[[proxy.input]]\nname = \"i\"\nchannel = 2\n"
                                          "words = { on = \"01\", off = \"00\" }\n";

} // namespace

TEST_CASE("a gateway cannot be the peer of a bridge", "[config][mqtt]") {
  CHECK(test::problem_after(test::island_head, "[mqtt]\npeer = \"k-gateway\"\n") ==
        "16:8: `k-gateway` is a gateway: a bridge needs a peer of its own, under [[peer]], with a "
        "link to it");
}

TEST_CASE("[mqtt] is a bridge beside the kernel of its peer", "[config][mqtt]") {
  const auto x = good(fan_head + R"([mqtt]
peer = "pc"
broker = "broker.local:8883"
user = "rubicon"
password_file = "secret"
remove_after = "1h"
platforms = { "p.i" = "select" }
tls.authority = "ca.crt"
topic = [{ topic = "zigbee2mqtt/lamp", key = "lamp.power", type = "number", member = "power" }]
[[mqtt.simulated]]
restart = "persistent"
at = "1min"
[[mqtt.simulated]]
topic = "homeassistant/status"
payload = "online"
at = "30s"
)");
  const auto& app = std::get<mqtt_app>(x.peers.at(0).apps.at(0));
  CHECK(app.settings->broker.address == "broker.local:8883");
  CHECK(app.settings->broker.client == "rubicon-pc");
  CHECK(app.settings->broker.tls);
  CHECK(app.settings->bridge.remove_after == 1h);
  CHECK(app.settings->bridge.platforms.at("p.i") == bridge::platform::select);
  REQUIRE(app.settings->bridge.topics.size() == 1);
  CHECK(app.settings->bridge.topics[0].type == bridge::payload_type::number);
  REQUIRE(app.settings->simulated.size() == 2);
  CHECK(std::get<bridge::broker_restart>(app.settings->simulated[0]).keeps ==
        bridge::kept_messages::retained);
  CHECK(std::get<bridge::other_publication>(app.settings->simulated[1]).at == 30s);
  CHECK(summary(x).find("MQTT bridge (simulated broker)") != std::string::npos);
  CHECK(std::ranges::any_of(tuple_keys(x),
                            [](const auto& each) { return each.pattern == "lamp.power"; }));
}

TEST_CASE("labels of motes are names of their devices", "[config][mqtt]") {
  const auto x = good(std::string(test::island_head) +
                      "[[island.mote]]\nid = 2\nname = \"Fan\"\nlabel = \"Küche / Lüfter\"\n"
                      "type = \"c\"\nposition_m = [1, 2]\n"
                      "[[proxy]]\nname = \"p\"\ntypes = [7]\n"
                      "[mqtt]\npeer = \"pc\"\n");
  const auto& app = std::get<mqtt_app>(x.peers.at(0).apps.at(0));
  CHECK(app.settings->bridge.labels.at("k.fan") == "Küche / Lüfter");
}

TEST_CASE("mistakes in [mqtt] are reported where they are", "[config][mqtt]") {
  check_mistakes(fan_head, R"(
[mqtt]
peer = "robot"
#      ^ no peer is named `robot`: there is pc

[mqtt]
peer = "pc"
broker = "localhost"
#        ^ `broker` must be HOST:PORT, as in "127.0.0.1:1883"

[mqtt]
peer = "pc"
broker = "localhost:70000"
#        ^ `broker` must be HOST:PORT, as in "127.0.0.1:1883"

[mqtt]
peer = "pc"
rate = 10
#      ^ `rate` must be a whole number from 11 to 1000, not 10

[mqtt]
peer = "pc"
base = "a/b"
#      ^ `base` must be a name of 1 to 32 letters, digits, - and _, not "a/b"

[mqtt]
peer = "pc"
base = "homeassistant"
#      ^ `base` and `discovery` must differ: below `discovery` are the topics of Home Assistant

[mqtt]
peer = "pc"
tls.certificate = "pc.crt"
#@ 15:1: `certificate` and `key` need each other

[mqtt]
peer = "pc"
password_file = "secret"
#               ^ `password_file` needs `user`

[mqtt]
peer = "pc"
platforms = { "p.i" = "number" }
#             ^ `p.i` cannot be a number: its words and numbers do not fit

[mqtt]
peer = "pc"
platforms = { "p.x" = "number" }
#             ^ `platforms`: class `p` has no field or input `x`

[mqtt]
peer = "pc"
platforms = { "q.i" = "switch" }
#             ^ `platforms`: no class is named `q`; give CLASS.FIELD or CLASS.INPUT

[mqtt]
peer = "pc"
[[mqtt.topic]]
topic = "a/#"
#       ^ `a/#` has a wildcard, or is below `base`: only topics of others become tuples
key = "x"

[mqtt]
peer = "pc"
[[mqtt.simulated]]
topic = "a/+"
#       ^ `a/+` has a wildcard: a client publishes to one topic
at = "1s"

[mqtt]
peer = "pc"
[[mqtt.topic]]
topic = "rubicon/x"
#       ^ `rubicon/x` has a wildcard, or is below `base`: only topics of others become tuples
key = "x"
)");
}
