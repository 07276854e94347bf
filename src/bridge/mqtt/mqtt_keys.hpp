// The keys of what a file may say about a bridge to an MQTT broker.
#pragma once

#include "bridge/mqtt/broker_config.hpp"
#include "bridge/mqtt/mqtt_config.hpp"
#include "bridge/mqtt/simulated_events.hpp"
#include "core/describe/keys.hpp"

namespace rubicon::bridge {

inline auto keys_of(const mqtt_config*) {
  return keys::of(
      keys::optional(
          "base", &mqtt_config::base, keys::name_text{},
          {"first part of all own topics: bridges of one broker differ in it", "`rubicon`"}),
      keys::optional("home_assistant", &mqtt_config::home_assistant, keys::flag{},
                     "announces objects to Home Assistant"),
      keys::optional("discovery", &mqtt_config::discovery, keys::name_text{},
                     {"first part of the topics that Home Assistant reads announcements from",
                      "`homeassistant`"}),
      keys::optional("remove_after", &mqtt_config::remove_after, keys::time_span{1s, 24h * 365},
                     "an object whose tuples have been deleted for so long, or that is not there "
                     "so long after a start, is removed from the broker"),
      keys::optional("rate", &mqtt_config::rate, keys::whole<std::uint32_t>{11, 1000},
                     "messages that the bridge publishes within any second, at most"));
}

inline auto keys_of(const broker_config*) {
  return keys::of(
      keys::optional("broker", &broker_config::address, keys::text{255},
                     {"where the broker is, in wall time; in virtual time it is simulated", "",
                      "text `\"HOST:PORT\"`"}),
      keys::optional("client", &broker_config::client, keys::name_text{},
                     {"id of the client; the broker closes the connection of another client of "
                      "the same id",
                      "`BASE-PEER`"}),
      keys::optional("user", &broker_config::user, keys::text{100},
                     {"name of a user of the broker", "anonymous"}),
      keys::optional("password_file", &broker_config::password_file, keys::text{4096},
                     {"file whose first line is the user's password, relative to the folder of "
                      "this file; no other user of the computer may have access to it",
                      "the environment variable `RUBICON_MQTT_PASSWORD`"}));
}

inline auto tls_keys() {
  return keys::of(
      keys::optional(
          "authority", &broker_config::authority, keys::text{4096},
          {"file with the certificates that sign the broker's, as PEM", "those of the system"}),
      keys::optional("certificate", &broker_config::certificate, keys::text{4096},
                     {"file with the certificate that the bridge presents; needs `key`", "none"}),
      keys::optional("key", &broker_config::key, keys::text{4096},
                     {"file with the key of that certificate", "none"}));
}

inline auto keys_of(const topic_rule*) {
  return keys::of(
      keys::required("topic", &topic_rule::topic, keys::text{256},
                     "that others publish; without wildcards, and not below `base`"),
      keys::required("key", &topic_rule::key, keys::tuple_key{},
                     "of the tuple of the bridge's peer that has the newest payload"),
      keys::optional("type", &topic_rule::type,
                     keys::word<payload_type>{{{"text", payload_type::text},
                                               {"number", payload_type::number},
                                               {"flag", payload_type::flag}}},
                     "what the payload must be: a text of up to 256 octets, a number, or `on`, "
                     "`true`, `1`, `off`, `false`, `0`, which become `on` and `off`. Others are "
                     "dropped and counted"),
      keys::optional("member", &topic_rule::member, keys::text{100},
                     {"the value is this member of the JSON object that the payload is",
                      "the payload itself"}));
}

inline auto keys_of(const broker_restart*) {
  return keys::of(
      keys::required("restart", &broker_restart::keeps,
                     keys::word<kept_messages>{
                         {{"empty", kept_messages::none}, {"persistent", kept_messages::retained}}},
                     "the simulated broker ends and begins again: without what it has retained, or "
                     "with it"),
      keys::required("at", &broker_restart::at, keys::time_span{0s, 24h * 365}, "when"));
}

inline auto keys_of(const other_publication*) {
  return keys::of(
      keys::required("topic", &other_publication::topic, keys::text{256},
                     "that another client of the simulated broker publishes; without wildcards"),
      keys::required("at", &other_publication::at, keys::time_span{0s, 24h * 365}, "when"),
      keys::optional("payload", &other_publication::payload, keys::text{1024},
                     {"what it publishes", "nothing"}),
      keys::optional("retain", &other_publication::retain, keys::flag{},
                     "the broker retains it for clients that subscribe later"));
}

inline keys::word<platform> platform_words() {
  keys::word<platform> out;
  for (const auto x :
       {platform::sensor, platform::binary_sensor, platform::switch_, platform::light,
        platform::cover, platform::fan, platform::number, platform::select, platform::button})
    out.choices.emplace_back(to_string(x), x);
  return out;
}

} // namespace rubicon::bridge
