#include "config/island/application_readers.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "apps/app_keys.hpp"
#include "config/file_readers.hpp"
#include "config/island/mote_readers.hpp"
#include "config/island/size_check.hpp"
#include "config/toml/values.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t synapses_max = 64;
constexpr std::size_t streams_max = 32;

std::vector<apps::synapse> read_synapses(table_reader& in, std::string_view key,
                                         const about& what) {
  std::vector<apps::synapse> out;
  uniqueness<mote_address> listed;
  in.tables(key, "synapses", what, [&](table_reader& x) {
    apps::synapse end;
    x.all(end);
    if (end.other != mote_address{})
      listed.add(end.other, "the channel with " + to_string(end.other), x.at("node"), x.problems(),
                 "is already listed");
    out.push_back(end);
  });
  if (out.size() > synapses_max)
    in.problems().add(in.at(key), '`' + std::string(key) + "` must not have more than " +
                                      std::to_string(synapses_max) + " channels");
  return out;
}

placed_program read_stream_writer(table_reader& in) {
  apps::stream_writer_config app;
  in.all(app);
  return {app, {in.at("transducer")}};
}

placed_program read_stream_reader(table_reader& in) {
  apps::stream_reader_config app;
  in.all(app);
  return {app, {}};
}

/// Transducers of a reservoir, with the places that checks need.
struct sensed_quantities {
  std::vector<located<device::quantity>> transducers;
};

auto sensed_quantity_keys() {
  return keys::of(keys::optional("transducers", &sensed_quantities::transducers,
                                 list_of<quantity_name>{{}, 0, 8},
                                 {"on a mote only; each is scaled by its range so far", "none",
                                  "array of up to 8 quantities"}));
}

placed_program read_reservoir(table_reader& in, bool senses) {
  apps::reservoir_config app;
  placed_program out;
  if (senses) {
    sensed_quantities sensed;
    in.all(sensed, sensed_quantity_keys());
    auto& found = sensed.transducers;
    for (const auto& each : found)
      out.needs_at.push_back(each.at);
    app.transducers = values_of(std::move(found));
  }
  app.from = read_synapses(in, "from", {"incoming channels", "none"});
  app.to = read_synapses(
      in, "to",
      {"outgoing channels: the first transducer, if there is one, then the units", "none"});
  in.all(app);
  out.app = std::move(app);
  return out;
}

placed_program read_readout(table_reader& in) {
  apps::readout_config app;
  app.from = read_synapses(in, "from", "incoming channels, at least 1");
  if (in.sound() && app.from.empty())
    in.problems().add(in.at("app"), "a readout needs at least one channel in `from`");
  in.all(app);
  return {std::move(app), {}};
}

/// Streams that end at a program, with the places that checks need.
struct stream_list {
  std::vector<located<std::uint16_t>> streams;
};

auto stream_list_keys() {
  return keys::of(keys::required("streams", &stream_list::streams,
                                 list_of<whole<std::uint16_t>>{{}, 1, streams_max},
                                 {"symbolic names of the streams that end here", "",
                                  "array of 1 to 32 numbers from 0 to 65535"}));
}

std::vector<std::uint16_t> read_streams(table_reader& in) {
  stream_list list;
  in.all(list, stream_list_keys());
  auto& found = list.streams;
  uniqueness<std::uint16_t> listed;
  for (const auto& each : found)
    listed.add(each.value, "stream " + std::to_string(each.value), each.at, in.problems(),
               "is already listed");
  return values_of(std::move(found));
}

auto record_file_keys() {
  return keys::of(
      keys::required("file", &apps::recorder_config::file, text{},
                     "relative to the working directory of the run; no other recorder writes it"));
}

placed_program read_average(table_reader& in) {
  apps::average_config app;
  app.streams = read_streams(in);
  in.all(app);
  uniqueness<std::uint16_t> listed;
  in.tables(
      "outputs", "outputs of an average", "receivers of the mean",
      [&](table_reader& x) {
        apps::stream_output to;
        x.all(to);
        if (std::ranges::find(app.streams, to.stream) != app.streams.end())
          x.problems().add(x.at("stream"),
                           "stream " + std::to_string(to.stream) + " is read by this average");
        listed.add(to.stream, "stream " + std::to_string(to.stream), x.at("stream"), x.problems(),
                   "is already listed");
        app.outputs.push_back(to);
      },
      1);
  return {std::move(app), {}};
}

placed_program read_stream_switch(table_reader& in) {
  apps::stream_switch_config app;
  in.all(app);
  if (in.sound() && app.on_at == app.off_at)
    in.problems().add(in.at("off_at"), "`off_at` must not be equal to `on_at`");
  return {app, {}};
}

placed_program read_recorder(table_reader& in, uniqueness<std::string>& files) {
  apps::recorder_config app;
  app.streams = read_streams(in);
  in.all(app);
  in.all(app, record_file_keys());
  if (in.is_good("file"))
    files.add(app.file, "file `" + app.file + '`', in.at("file"), in.problems(),
              "is already written by the recorder");
  return {std::move(app), {}};
}

/// Reads one key as its description has it.
struct setting_reader {
  table_reader& in;
  const apps::setting_key& key;

  std::optional<apps::setting> operator()(double) const {
    return take(real{key.min, key.max}, 0.0);
  }
  std::optional<apps::setting> operator()(bool) const { return take(flag{}, false); }
  std::optional<apps::setting> operator()(const std::string&) const {
    return take(text{}, std::string());
  }
  std::optional<apps::setting> operator()(duration) const { return take(time_span{}, 0ns); }

  template <class Kind, class Value>
  std::optional<apps::setting> take(const Kind& kind, Value value) const {
    struct holder {
      Value value;
    };
    auto one = keys::optional(key.name, &holder::value, kind, key.meaning.c_str());
    one.is_required = key.required;
    holder x{std::move(value)};
    in.all(x, keys::of(one));
    return in.is_good(key.name) ? std::optional<apps::setting>(x.value) : std::nullopt;
  }
};

placed_program read_custom(table_reader& in,
                           const std::shared_ptr<const apps::application_kind>& kind) {
  apps::custom_config app{kind, {}};
  for (const auto& key : kind->keys)
    app.values.set(key.name,
                   std::visit(setting_reader{in, key}, key.otherwise).value_or(key.otherwise));
  return {std::move(app), {}};
}

std::vector<program_kind> with_custom(std::vector<program_kind> out, const table_reader& in) {
  if (const auto* files = in.shared().files)
    for (const auto& [name, kind] : files->known.applications.all())
      out.emplace_back(name, [x = kind](table_reader& y) { return read_custom(y, x); });
  return out;
}

} // namespace

std::vector<program_kind> mote_programs(const table_reader& in) {
  return with_custom({{"stream_writer", [&](table_reader& x) { return read_stream_writer(x); }},
                      {"stream_reader", read_stream_reader},
                      {"reservoir", [&](table_reader& x) { return read_reservoir(x, true); }},
                      {"readout", [&](table_reader& x) { return read_readout(x); }},
                      {"average", [&](table_reader& x) { return read_average(x); }},
                      {"stream_switch", [&](table_reader& x) { return read_stream_switch(x); }},
                      {"lua", read_lua}},
                     in);
}

std::vector<program_kind> pc_programs(const table_reader& in, uniqueness<std::string>& files) {
  return with_custom({{"stream_reader", read_stream_reader},
                      {"reservoir", [&](table_reader& x) { return read_reservoir(x, false); }},
                      {"readout", [&](table_reader& x) { return read_readout(x); }},
                      {"average", [&](table_reader& x) { return read_average(x); }},
                      {"stream_switch", [&](table_reader& x) { return read_stream_switch(x); }},
                      {"recorder", [&](table_reader& x) { return read_recorder(x, files); }},
                      {"lua", read_lua}},
                     in);
}

std::vector<apps::app_config> read_pc_programs(table_reader& in, std::string_view key,
                                               const std::string& title,
                                               uniqueness<std::string>& files) {
  std::vector<apps::app_config> out;
  end_uniqueness ends;
  in.tables(key, title,
            {"programs of its PC; they are notified of each mote that joins the island; only if it "
             "is the island's only gateway",
             "none"},
            [&](table_reader& x) {
              std::vector<std::pair<std::string_view, table_reader::part_reader>> choices;
              for (const auto& [word, read] : pc_programs(in, files))
                choices.emplace_back(word, [&, read = read](table_reader& y) {
                  out.push_back(read(y).app);
                  ends.add(out.back(), y.at("app"), y.problems());
                });
              x.one_of("app", "which program", choices);
            });
  return out;
}

std::vector<device::quantity> needs(const apps::app_config& x) {
  if (const auto* writer = std::get_if<apps::stream_writer_config>(&x))
    return {writer->transducer};
  if (const auto* units = std::get_if<apps::reservoir_config>(&x))
    return units->transducers;
  return {};
}

} // namespace rubicon::config
