#include <algorithm>
#include <array>
#include <cmath>

#include "config/model_readers.hpp"
#include "config/mote_readers.hpp"
#include "mote/transducer_keys.hpp"

namespace rubicon::config {

namespace {

using mote::quantity;

struct quantity_word {
  std::string_view name;
  quantity kind;
  const char* unit;        ///< by convention,
  std::string_view symbol; ///< and what is published; empty: none
};

constexpr std::array<quantity_word, 9> quantity_words{
    {{"temperature", quantity::temperature, "degrees Celsius", "C"},
     {"humidity", quantity::humidity, "percent", "%"},
     {"light", quantity::light, "lux", "lx"},
     {"voltage", quantity::voltage, "volts", "V"},
     {"presence", quantity::presence, "0 or 1", ""},
     {"acceleration", quantity::acceleration, "metres per second squared", "m/s2"},
     {"magnetism", quantity::magnetism, "microtesla, or 0 and 1 of a reed contact", "uT"},
     {"sound", quantity::sound, "decibels", "dB"},
     {"signal", quantity::signal, "dBm", "dBm"}}};

/// A model whose keys are listed beside it.
template <class Model>
void read_model(table_reader& in, mote::transducer_model& out) {
  Model found;
  in.all(found);
  out = std::move(found);
}

void read_random_walk(table_reader& in, mote::transducer_model& out) {
  mote::random_walk_model model;
  in.all(model);
  if (in.sound() && model.min >= model.max)
    in.problems().add(in.at("max"), "`max` must be more than `min`, which is " + shown(model.min));
  else if (in.sound() && (model.start < model.min || model.start > model.max))
    in.problems().add(in.at("start"), "`start` must be from `min` to `max`, from " +
                                          shown(model.min) + " to " + shown(model.max));
  out = model;
}

double farthest(const mote::time_series& series) {
  double most = 0;
  for (const auto& [at, value] : series)
    most = std::max(most, std::abs(value));
  return most;
}

/// The value farthest from zero; of a field, as far as its author decides it: a gradient has no
/// end.
struct extreme {
  double operator()(const mote::constant_model& x) const { return std::abs(x.value); }
  double operator()(const mote::sine_model& x) const {
    return std::abs(x.mean) + std::abs(x.amplitude);
  }
  double operator()(const mote::points_model& x) const { return farthest(x.points); }
  double operator()(const mote::random_walk_model& x) const {
    return std::max(std::abs(x.min), std::abs(x.max));
  }
  double operator()(const mote::field_model& x) const {
    auto most = std::abs(x.base);
    for (const auto& each : x.sources)
      most += std::abs(each.strength) * (each.schedule.empty() ? 1 : farthest(each.schedule));
    return most;
  }
  double operator()(const mote::trace_model& x) const {
    double most = 0;
    for (const auto& [mote, series] : x.table->of_mote) {
      if (x.mote.value_or(mote) != mote)
        continue;
      for (const auto& [at, value] : series)
        most = std::max(most, std::abs(x.offset + x.scale * value));
    }
    return most;
  }
};

/// Whether there is a model: a trace whose mistakes another mote has told of already is none.
bool has_model(const mote::transducer_model& x) {
  const auto* trace = std::get_if<mote::trace_model>(&x);
  return trace == nullptr || trace->table != nullptr;
}

void read_transducer(table_reader& in, mote::transducer_config& out) {
  constexpr double count_max = 32767;
  in.all(out);
  in.one_of("model", "how the value behaves",
            {{"constant", [&](table_reader& x) { read_model<mote::constant_model>(x, out.model); }},
             {"sine", [&](table_reader& x) { read_model<mote::sine_model>(x, out.model); }},
             {"points", [&](table_reader& x) { read_model<mote::points_model>(x, out.model); }},
             {"random_walk", [&](table_reader& x) { read_random_walk(x, out.model); }},
             {"field", [&](table_reader& x) { out.model = read_field(x); }},
             {"trace", [&](table_reader& x) { out.model = read_trace(x, out.kind); }}});
  if (!in.sound() || in.walks() || !has_model(out.model))
    return;
  const auto most = std::visit(extreme{}, out.model);
  if (most / out.resolution > count_max)
    in.problems().add(in.at("resolution"), "a value of " + shown(most) + " is more than " +
                                               shown(count_max) + " counts of `resolution` " +
                                               shown(out.resolution) +
                                               ", which a message cannot carry: use a coarser one");
}

} // namespace

std::string_view word_of(mote::quantity x) {
  return quantity_words[static_cast<std::size_t>(x)].name;
}

std::string_view unit_of(mote::quantity x) {
  return quantity_words[static_cast<std::size_t>(x)].symbol;
}

void read_transducers(table_reader& in, std::vector<mote::transducer_config>& out) {
  in.table("transducers", "transducers",
           {"what it measures, by quantity; a mote's replace its type's of the same quantity, or "
            "are added",
            "none"},
           [&out](table_reader& all) {
             for (const auto& [name, kind, unit, symbol] : quantity_words) {
               if (kind == quantity::signal)
                 continue; // nobody describes it
               mote::transducer_config config;
               config.kind = kind;
               const auto read = [&config](table_reader& x) { read_transducer(x, config); };
               if (!all.table(name, "transducers.QUANTITY", unit, read))
                 continue;
               const auto at =
                   std::ranges::lower_bound(out, kind, {}, &mote::transducer_config::kind);
               if (at != out.end() && at->kind == kind)
                 *at = std::move(config);
               else
                 out.insert(at, std::move(config));
             }
           });
}

} // namespace rubicon::config
