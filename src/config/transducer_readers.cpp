#include <algorithm>
#include <array>
#include <cmath>

#include "config/mote_readers.hpp"

namespace rubicon::config {

namespace {

using mote::quantity;

constexpr std::array<std::pair<std::string_view, quantity>, 8> quantity_words{
    {{"temperature", quantity::temperature},
     {"humidity", quantity::humidity},
     {"light", quantity::light},
     {"voltage", quantity::voltage},
     {"presence", quantity::presence},
     {"acceleration", quantity::acceleration},
     {"magnetism", quantity::magnetism},
     {"sound", quantity::sound}}};

void read_constant(table_reader& in, mote::transducer_model& out) {
  mote::constant_model model;
  in.required("value", real{}, model.value);
  out = model;
}

void read_sine(table_reader& in, mote::transducer_model& out) {
  mote::sine_model model;
  in.required("mean", real{}, model.mean);
  in.required("amplitude", real{}, model.amplitude);
  in.optional("period", time_span{1ms}, model.period);
  in.optional("phase_turns", real{-1, 1}, model.phase_turns);
  out = model;
}

void read_points(table_reader& in, mote::transducer_model& out) {
  mote::points_model model;
  in.required("points", time_points{}, model.points);
  out = std::move(model);
}

/// The value farthest from zero.
struct extreme {
  double operator()(const mote::constant_model& x) const { return std::abs(x.value); }
  double operator()(const mote::sine_model& x) const {
    return std::abs(x.mean) + std::abs(x.amplitude);
  }
  double operator()(const mote::points_model& x) const {
    double most = 0;
    for (const auto& [at, value] : x.points)
      most = std::max(most, std::abs(value));
    return most;
  }
};

void read_transducer(table_reader& in, mote::transducer_config& out) {
  constexpr double count_max = 32767;
  in.optional("noise", real{0}, out.noise);
  in.optional("resolution", real{1e-9, 1e9}, out.resolution);
  in.one_of("model", {{"constant", [&](table_reader& x) { read_constant(x, out.model); }},
                      {"sine", [&](table_reader& x) { read_sine(x, out.model); }},
                      {"points", [&](table_reader& x) { read_points(x, out.model); }}});
  const auto most = std::visit(extreme{}, out.model);
  if (in.sound() && most / out.resolution > count_max)
    in.problems().add(in.at("resolution"), "a value of " + shown(most) + " is more than " +
                                               shown(count_max) + " counts of `resolution` " +
                                               shown(out.resolution) +
                                               ", which a message cannot carry: use a coarser one");
}

void read_relay(table_reader& in, mote::actuator_config& out) {
  in.optional("initial", word<std::uint8_t>{{{"off", 0}, {"on", 1}}}, out.initial);
}

void read_dimmer(table_reader& in, mote::actuator_config& out) {
  in.optional("initial", whole<std::uint8_t>{}, out.initial);
}

} // namespace

std::string_view word_of(mote::quantity x) {
  return quantity_words[static_cast<std::size_t>(x)].first;
}

void read_transducers(table_reader& in, std::vector<mote::transducer_config>& out) {
  in.table("transducers", "transducers", [&out](table_reader& all) {
    for (const auto& [name, kind] : quantity_words) {
      mote::transducer_config config;
      config.kind = kind;
      const auto read = [&config](table_reader& x) { read_transducer(x, config); };
      if (!all.table(name, "transducers.QUANTITY", read))
        continue;
      std::erase_if(out, [&config](const auto& x) { return x.kind == config.kind; });
      out.push_back(std::move(config));
    }
  });
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
}

void read_actuators(table_reader& in, std::vector<mote::actuator_config>& out) {
  name_claims names;
  in.tables("actuators", "actuators", [&](table_reader& x) {
    mote::actuator_config config;
    x.required("name", name_text{}, config.name);
    x.one_of("kind", {{"relay",
                       [&config](table_reader& y) {
                         config.kind = mote::actuator_kind::relay;
                         read_relay(y, config);
                       }},
                      {"dimmer", [&config](table_reader& y) {
                         config.kind = mote::actuator_kind::dimmer;
                         read_dimmer(y, config);
                       }}});
    if (!config.name.empty())
      names.claim(config.name, "actuator", x.at("name"), x.problems());
    std::erase_if(out, [&config](const auto& y) { return y.name == config.name; });
    out.push_back(std::move(config));
  });
}

} // namespace rubicon::config
