#include <algorithm>
#include <cmath>

#include "config/island/model_readers.hpp"
#include "config/island/mote_readers.hpp"
#include "device/transducer_keys.hpp"

namespace rubicon::config {

namespace {

/// A model whose keys are listed beside it.
template <class Model>
void read_model(table_reader& in, device::transducer_model& out) {
  Model found;
  in.all(found);
  out = std::move(found);
}

void read_random_walk(table_reader& in, device::transducer_model& out) {
  device::random_walk_model model;
  in.all(model);
  if (in.sound() && model.min >= model.max)
    in.problems().add(in.at("max"), "`max` must be more than `min`, which is " + shown(model.min));
  else if (in.sound() && (model.start < model.min || model.start > model.max))
    in.problems().add(in.at("start"), "`start` must be from `min` to `max`, from " +
                                          shown(model.min) + " to " + shown(model.max));
  out = model;
}

double farthest(const device::time_series& series) {
  double most = 0;
  for (const auto& [at, value] : series)
    most = std::max(most, std::abs(value));
  return most;
}

/// The value farthest from zero; of a field, as far as its author decides it: a gradient has no
/// end.
struct extreme {
  double operator()(const device::constant_model& x) const { return std::abs(x.value); }
  double operator()(const device::sine_model& x) const {
    return std::abs(x.mean) + std::abs(x.amplitude);
  }
  double operator()(const device::points_model& x) const { return farthest(x.points); }
  double operator()(const device::random_walk_model& x) const {
    return std::max(std::abs(x.min), std::abs(x.max));
  }
  double operator()(const device::field_model& x) const {
    auto most = std::abs(x.base);
    for (const auto& each : x.sources)
      most += std::abs(each.strength) * (each.schedule.empty() ? 1 : farthest(each.schedule));
    return most;
  }
  double operator()(const device::trace_model& x) const {
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

/// Whether there is a model: a trace whose mistakes were reported for another mote is none.
bool has_model(const device::transducer_model& x) {
  const auto* trace = std::get_if<device::trace_model>(&x);
  return trace == nullptr || trace->table != nullptr;
}

void read_transducer(table_reader& in, device::transducer_config& out) {
  constexpr double count_max = 32767;
  in.all(out);
  in.one_of(
      "model", "model of the value",
      {{"constant", [&](table_reader& x) { read_model<device::constant_model>(x, out.model); }},
       {"sine", [&](table_reader& x) { read_model<device::sine_model>(x, out.model); }},
       {"points", [&](table_reader& x) { read_model<device::points_model>(x, out.model); }},
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

void read_transducers(table_reader& in, std::vector<device::transducer_config>& out) {
  const auto& known = in.shared().quantities.all();
  in.table(
      "transducers", "transducers",
      {"measured quantities; those of a mote replace those of its type of the same quantity, or "
       "are added",
       "none"},
      [&](table_reader& all) {
        for (std::size_t i = 0; i < known.size(); ++i) {
          device::transducer_config config;
          config.kind = static_cast<device::quantity>(i);
          if (config.kind == device::quantity::signal)
            continue; // it is not described
          const auto read = [&config](table_reader& x) { read_transducer(x, config); };
          if (!all.table(known[i].name, "transducers.QUANTITY", known[i].meaning.c_str(), read))
            continue;
          const auto at =
              std::ranges::lower_bound(out, config.kind, {}, &device::transducer_config::kind);
          if (at != out.end() && at->kind == config.kind)
            *at = std::move(config);
          else
            out.insert(at, std::move(config));
        }
        all.other_tables("transducers.QUANTITY", "of a [quantity](#quantity) of the file");
      });
}

} // namespace rubicon::config
