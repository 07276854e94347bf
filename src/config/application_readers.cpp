#include "config/application_readers.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "config/file_readers.hpp"
#include "config/mote_readers.hpp"
#include "config/size_check.hpp"
#include "config/values.hpp"

namespace rubicon::config {

namespace {

constexpr duration every_min = 10ms;
constexpr duration every_max = 24h;
constexpr std::size_t synapses_max = 64;
constexpr std::size_t streams_max = 32;
constexpr std::uint8_t vector_max = 64;

std::vector<apps::synapse> read_synapses(table_reader& in, std::string_view key,
                                         const directory& names, const about& what) {
  std::vector<apps::synapse> out;
  claims<mote_address> listed;
  in.tables(key, "synapses", what, [&](table_reader& x) {
    apps::synapse end;
    if (x.required("node", node_name{names}, end.other, "who has the other end"))
      listed.claim(end.other, "the channel with " + to_string(end.other), x.at("node"),
                   x.problems(), "is already listed");
    x.optional("size", whole<std::uint8_t>{1, vector_max}, end.size, "elements");
    out.push_back(end);
  });
  if (out.size() > synapses_max)
    in.problems().add(in.at(key), '`' + std::string(key) + "` must not have more than " +
                                      std::to_string(synapses_max) + " channels");
  return out;
}

placed_program read_stream_writer(table_reader& in, const directory& names) {
  apps::stream_writer_config app;
  in.required("transducer", word<mote::quantity>{quantities()}, app.transducer,
              {"a transducer of the mote", "", "quantity"});
  in.required("to", node_name{names}, app.to, "where the read end is");
  in.optional("every", time_span{every_min, every_max}, app.every, "from one record to the next");
  in.optional("stream", whole<std::uint16_t>{}, app.stream, "symbolic name, the same at both ends");
  return {app, {in.at("transducer")}};
}

placed_program read_stream_reader(table_reader& in) {
  apps::stream_reader_config app;
  in.optional("every", time_span{every_min, every_max}, app.every, "as the writer's");
  in.optional("stream", whole<std::uint16_t>{}, app.stream, "symbolic name");
  return {app, {}};
}

placed_program read_reservoir(table_reader& in, const directory& names, bool senses) {
  apps::reservoir_config app;
  placed_program out;
  if (senses) {
    std::vector<located<mote::quantity>> found;
    in.optional("transducers", list_of<word<mote::quantity>>{{quantities()}, 0, 8}, found,
                {"on a mote only; each is scaled by its range so far", "none",
                 "array of up to 8 quantities"});
    for (const auto& each : found)
      out.needs_at.push_back(each.at);
    app.transducers = values_of(std::move(found));
  }
  app.from = read_synapses(in, "from", names, {"channels that come in", "none"});
  app.to = read_synapses(
      in, "to", names,
      {"channels that go out: the first transducer, if there is one, then the units", "none"});
  in.optional("units", whole<std::uint8_t>{1, vector_max}, app.units, "how many it has");
  in.optional("leak", ratio{}, app.leak, "share of the new in a unit's next state");
  in.optional("radius", ratio{}, app.radius,
              "bound of the spectral radius of the units' own weights");
  out.app = std::move(app);
  return out;
}

placed_program read_readout(table_reader& in, const directory& names) {
  apps::readout_config app;
  app.from = read_synapses(in, "from", names, "channels that come in, at least 1");
  if (in.sound() && app.from.empty())
    in.problems().add(in.at("app"), "a readout needs at least one channel in `from`");
  in.optional("warm_up", whole<std::uint32_t>{}, app.warm_up, "ticks before errors count");
  in.optional("forgetting", real{0.5, 1}, app.forgetting, "weight of the past, per tick");
  return {std::move(app), {}};
}

std::vector<std::uint16_t> read_streams(table_reader& in) {
  std::vector<located<std::uint16_t>> found;
  in.required("streams", list_of<whole<std::uint16_t>>{{}, 1, streams_max}, found,
              {"symbolic names of the streams that end here", "",
               "array of 1 to 32 numbers from 0 to 65535"});
  claims<std::uint16_t> listed;
  for (const auto& each : found)
    listed.claim(each.value, "stream " + std::to_string(each.value), each.at, in.problems(),
                 "is already listed");
  return values_of(std::move(found));
}

placed_program read_average(table_reader& in, const directory& names) {
  apps::average_config app;
  app.streams = read_streams(in);
  in.optional("every", time_span{every_min, every_max}, app.every,
              "from one mean to the next, and as the writers'");
  claims<std::uint16_t> listed;
  in.tables(
      "outputs", "outputs of an average", "where the mean goes",
      [&](table_reader& x) {
        apps::stream_output to;
        x.required("to", node_name{names}, to.to,
                   "where the read end is; it may be the node of the average itself");
        x.optional("stream", whole<std::uint16_t>{}, to.stream,
                   "symbolic name; no other output has it, nor is it among `streams`");
        if (std::ranges::find(app.streams, to.stream) != app.streams.end())
          x.problems().add(x.at("stream"),
                           "stream " + std::to_string(to.stream) + " is read by this average");
        listed.claim(to.stream, "stream " + std::to_string(to.stream), x.at("stream"), x.problems(),
                     "is already listed");
        app.outputs.push_back(to);
      },
      1);
  return {std::move(app), {}};
}

placed_program read_stream_switch(table_reader& in, const directory& names) {
  apps::stream_switch_config app;
  in.optional("stream", whole<std::uint16_t>{}, app.stream,
              "symbolic name of the stream that ends here");
  in.optional("every", time_span{every_min, every_max}, app.every, "as the writer's");
  in.required("on_at", real{}, app.on_at, "in counts of the stream");
  in.required("off_at", real{}, app.off_at, "the same; not equal to `on_at`");
  in.required("to", mote_name{names}, app.to, "whose actuator it is");
  in.optional("channel", whole<std::uint8_t>{}, app.channel, "channel of its app `actuator`");
  if (in.sound() && app.on_at == app.off_at)
    in.problems().add(in.at("off_at"), "`off_at` must not be equal to `on_at`");
  return {app, {}};
}

placed_program read_recorder(table_reader& in, claims<std::string>& files) {
  apps::recorder_config app;
  app.streams = read_streams(in);
  in.optional("every", time_span{every_min, every_max}, app.every, "as the writers'");
  if (in.required("file", text{}, app.file,
                  "relative to the folder where the run is started; no other recorder writes it"))
    files.claim(app.file, "file `" + app.file + '`', in.at("file"), in.problems(),
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
    const bool found = key.required ? in.required(key.name, kind, value, key.meaning.c_str())
                                    : in.optional(key.name, kind, value, key.meaning.c_str());
    return found ? std::optional<apps::setting>(value) : std::nullopt;
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

std::optional<mote_address> node_name::read(const node& x, const asker& who) const {
  const auto* text = x.as<std::string>();
  if (text != nullptr && text->find('/') != std::string::npos)
    return mote_name{names}.read(x, who);
  const auto peer = peer_name{names}.read(x, who);
  if (!peer)
    return std::nullopt;
  if (peer->value > static_cast<std::int32_t>(island_id_max)) {
    who.complain(x, "peer `" + *text + "` has the id " + to_string(*peer) +
                        ", but motes and programs address peers up to 254");
    return std::nullopt;
  }
  return mote_address{island_id(static_cast<std::uint32_t>(peer->value)), no_mote};
}

std::vector<std::pair<std::string_view, mote::quantity>> quantities() {
  std::vector<std::pair<std::string_view, mote::quantity>> words;
  for (unsigned i = 0; i <= static_cast<unsigned>(mote::quantity::sound); ++i)
    words.emplace_back(word_of(static_cast<mote::quantity>(i)), static_cast<mote::quantity>(i));
  return words;
}

std::vector<std::pair<std::string_view, mote::quantity>> sampled_quantities() {
  auto words = quantities();
  words.emplace_back(word_of(mote::quantity::signal), mote::quantity::signal);
  return words;
}

std::vector<program_kind> mote_programs(const table_reader& in, const directory& names) {
  return with_custom(
      {{"stream_writer", [&](table_reader& x) { return read_stream_writer(x, names); }},
       {"stream_reader", read_stream_reader},
       {"reservoir", [&](table_reader& x) { return read_reservoir(x, names, true); }},
       {"readout", [&](table_reader& x) { return read_readout(x, names); }},
       {"average", [&](table_reader& x) { return read_average(x, names); }},
       {"stream_switch", [&](table_reader& x) { return read_stream_switch(x, names); }}},
      in);
}

std::vector<program_kind> pc_programs(const table_reader& in, const directory& names,
                                      claims<std::string>& files) {
  return with_custom(
      {{"stream_reader", read_stream_reader},
       {"reservoir", [&](table_reader& x) { return read_reservoir(x, names, false); }},
       {"readout", [&](table_reader& x) { return read_readout(x, names); }},
       {"average", [&](table_reader& x) { return read_average(x, names); }},
       {"stream_switch", [&](table_reader& x) { return read_stream_switch(x, names); }},
       {"recorder", [&](table_reader& x) { return read_recorder(x, files); }}},
      in);
}

std::vector<apps::app_config> read_pc_programs(table_reader& in, std::string_view key,
                                               const std::string& title, const directory& names,
                                               claims<std::string>& files) {
  std::vector<apps::app_config> out;
  end_claims ends;
  in.tables(
      key, title,
      {"programs of its PC; they hear of each mote that joins the island; only where it is the "
       "island's only gateway",
       "none"},
      [&](table_reader& x) {
        std::vector<std::pair<std::string_view, table_reader::part_reader>> choices;
        for (const auto& [word, read] : pc_programs(in, names, files))
          choices.emplace_back(word, [&, read = read](table_reader& y) {
            out.push_back(read(y).app);
            ends.claim(out.back(), y.at("app"), y.problems());
          });
        x.one_of("app", "which program", choices);
      });
  return out;
}

std::vector<mote::quantity> needs(const apps::app_config& x) {
  if (const auto* writer = std::get_if<apps::stream_writer_config>(&x))
    return {writer->transducer};
  if (const auto* units = std::get_if<apps::reservoir_config>(&x))
    return units->transducers;
  return {};
}

} // namespace rubicon::config
