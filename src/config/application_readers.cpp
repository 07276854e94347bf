#include "config/application_readers.hpp"

#include <utility>

#include "config/mote_readers.hpp"
#include "config/values.hpp"

namespace rubicon::config {

namespace {

constexpr duration every_min = 10ms;
constexpr duration every_max = 24h;
constexpr std::size_t synapses_max = 64;
constexpr std::uint8_t vector_max = 64;

std::vector<apps::synapse> read_synapses(table_reader& in, std::string_view key,
                                         const directory& names) {
  std::vector<apps::synapse> out;
  claims<mote_address> listed;
  in.tables(key, "synapses", [&](table_reader& x) {
    apps::synapse end;
    if (x.required("node", node_name{names}, end.other))
      listed.claim(end.other, "the channel with " + to_string(end.other), x.at("node"),
                   x.problems(), "is already listed");
    x.optional("size", whole<std::uint8_t>{1, vector_max}, end.size);
    out.push_back(end);
  });
  if (out.size() > synapses_max)
    in.problems().add(in.at(key), '`' + std::string(key) + "` must not have more than " +
                                      std::to_string(synapses_max) + " channels");
  return out;
}

bool is_gateway(const directory& names, peer_id id) {
  const auto* island = names.find(island_id(static_cast<std::uint32_t>(id.value)));
  return island != nullptr && island->has_gateway;
}

} // namespace

std::optional<mote_address> node_name::read(const node& x, const asker& who) const {
  const auto* text = x.as<std::string>();
  if (text != nullptr && text->find('/') != std::string::npos)
    return mote_name{names}.read(x, who);
  const auto peer = peer_name{names}.read(x, who);
  if (!peer)
    return std::nullopt;
  if (is_gateway(names, *peer)) {
    who.complain(x, '`' + *text + "` is a gateway, on which no programs run");
    return std::nullopt;
  }
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

placed_program read_stream_writer(table_reader& in, const directory& names) {
  apps::stream_writer_config app;
  in.required("transducer", word<mote::quantity>{quantities()}, app.transducer);
  in.required("to", node_name{names}, app.to);
  in.optional("every", time_span{every_min, every_max}, app.every);
  in.optional("stream", whole<std::uint16_t>{}, app.stream);
  return {app, {in.at("transducer")}};
}

placed_program read_stream_reader(table_reader& in) {
  apps::stream_reader_config app;
  in.optional("every", time_span{every_min, every_max}, app.every);
  in.optional("stream", whole<std::uint16_t>{}, app.stream);
  return {app, {}};
}

placed_program read_reservoir(table_reader& in, const directory& names, bool senses) {
  apps::reservoir_config app;
  placed_program out;
  if (senses) {
    std::vector<located<mote::quantity>> found;
    in.optional("transducers", list_of<word<mote::quantity>>{{quantities()}, 0, 8}, found);
    for (const auto& each : found)
      out.needs_at.push_back(each.at);
    app.transducers = values_of(std::move(found));
  }
  app.from = read_synapses(in, "from", names);
  app.to = read_synapses(in, "to", names);
  in.optional("units", whole<std::uint8_t>{1, vector_max}, app.units);
  in.optional("leak", ratio{}, app.leak);
  in.optional("radius", ratio{}, app.radius);
  out.app = std::move(app);
  return out;
}

placed_program read_readout(table_reader& in, const directory& names) {
  apps::readout_config app;
  app.from = read_synapses(in, "from", names);
  if (in.sound() && app.from.empty())
    in.problems().add(in.at("app"), "a readout needs at least one channel in `from`");
  in.optional("warm_up", whole<std::uint32_t>{}, app.warm_up);
  in.optional("forgetting", real{0.5, 1}, app.forgetting);
  return {std::move(app), {}};
}

std::vector<mote::quantity> needs(const apps::app_config& x) {
  if (const auto* writer = std::get_if<apps::stream_writer_config>(&x))
    return {writer->transducer};
  if (const auto* units = std::get_if<apps::reservoir_config>(&x))
    return units->transducers;
  return {};
}

} // namespace rubicon::config
