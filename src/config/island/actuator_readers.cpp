#include <algorithm>

#include "config/island/mote_readers.hpp"

namespace rubicon::config {

namespace {

constexpr time_span way_time{0s, 24h};

void read_relay(table_reader& in, device::actuator_config& out) {
  out.kind = device::actuator_kind::relay;
  in.optional("initial", word<std::uint8_t>{{{"off", 0}, {"on", 1}}}, out.initial,
              "transmitted as 0 and 1");
}

void read_dimmer(table_reader& in, device::actuator_config& out) {
  out.kind = device::actuator_kind::dimmer;
  in.optional("initial", whole<std::uint8_t>{}, out.initial, "at the start");
  in.optional("fade", way_time, out.travel, "from 0 to 255, at constant speed");
}

void read_level(table_reader& in, device::actuator_config& out) {
  out.kind = device::actuator_kind::level;
  out.travel = 20s;
  in.optional("initial", whole<std::uint8_t>{}, out.initial, "at the start");
  in.optional("travel", way_time, out.travel, "from 0 to 255, at constant speed");
}

} // namespace

void read_actuators(table_reader& in, std::vector<device::actuator_config>& out) {
  name_claims names;
  in.tables(
      "actuators", "actuators",
      {"actuators; those of a mote replace those of its type with the same name, or are added",
       "none"},
      [&](table_reader& x) {
        device::actuator_config config;
        x.required("name", name_text{}, config.name, "unique on the mote");
        x.one_of("kind", "what it is",
                 {{"relay", [&config](table_reader& y) { read_relay(y, config); }},
                  {"dimmer", [&config](table_reader& y) { read_dimmer(y, config); }},
                  {"level", [&config](table_reader& y) { read_level(y, config); }}});
        if (!config.name.empty())
          names.claim(config.name, "actuator", x.at("name"), x.problems());
        std::erase_if(out, [&config](const auto& y) { return y.name == config.name; });
        out.push_back(std::move(config));
      });
}

} // namespace rubicon::config
