#include <algorithm>

#include "config/island/mote_readers.hpp"

namespace rubicon::config {

namespace {

constexpr time_span travel_time{0s, 24h};

using device::actuator_config;

auto actuator_name_keys() {
  return keys::of(
      keys::required("name", &actuator_config::name, name_text{}, "unique on the mote"));
}

auto relay_keys() {
  return keys::of(keys::optional("initial", &actuator_config::initial,
                                 word<std::uint8_t>{{{"off", 0}, {"on", 1}}},
                                 "transmitted as 0 and 1"));
}

/// @param travel_name what the way from one end to the other is called
auto travel_keys(std::string_view travel_name) {
  return keys::of(
      keys::optional("initial", &actuator_config::initial, whole<std::uint8_t>{}, "at the start"),
      keys::optional(travel_name, &actuator_config::travel, travel_time,
                     "from 0 to 255, at constant speed"));
}

void read_relay(table_reader& in, actuator_config& out) {
  out.kind = device::actuator_kind::relay;
  in.all(out, relay_keys());
}

void read_dimmer(table_reader& in, actuator_config& out) {
  out.kind = device::actuator_kind::dimmer;
  in.all(out, travel_keys("fade"));
}

void read_level(table_reader& in, actuator_config& out) {
  out.kind = device::actuator_kind::level;
  out.travel = 20s;
  in.all(out, travel_keys("travel"));
}

} // namespace

void read_actuators(table_reader& in, std::vector<device::actuator_config>& out) {
  name_uniqueness names;
  in.tables(
      "actuators", "actuators",
      {"actuators; those of a mote replace those of its type with the same name, or are added",
       "none"},
      [&](table_reader& x) {
        device::actuator_config config;
        x.all(config, actuator_name_keys());
        x.one_of("kind", "what it is",
                 {{"relay", [&config](table_reader& y) { read_relay(y, config); }},
                  {"dimmer", [&config](table_reader& y) { read_dimmer(y, config); }},
                  {"level", [&config](table_reader& y) { read_level(y, config); }}});
        if (!config.name.empty())
          names.add(config.name, "actuator", x.at("name"), x.problems());
        std::erase_if(out, [&config](const auto& y) { return y.name == config.name; });
        out.push_back(std::move(config));
      });
}

} // namespace rubicon::config
