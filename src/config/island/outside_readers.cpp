#include "config/island/outside_readers.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "config/label_keys.hpp"
#include "config/toml/document.hpp"
#include "core/text/host_port.hpp"
#include "core/text/ipv4_network.hpp"
#include "gateway/plain/plain_keys.hpp"
#include "serial/cable/line_keys.hpp"
#include "serial/recording.hpp"

namespace rubicon::config {

namespace {

void need_wall_time(table_reader& in, const surroundings& with, const char* key) {
  if (in.has(key) && with.mode != run_mode::wall)
    in.problems().add(
        in.at(key),
        '`' + std::string(key) +
            "` needs mode = \"wall\": in virtual time external programs cannot keep pace");
}

/// What the sink of an island has once said.
void read_replay(table_reader& in, const std::string& island, serial::outside_config& out) {
  const auto* files = in.shared().files;
  if (out.replay.empty() || files == nullptr)
    return;
  const auto path = (std::filesystem::path(files->toml).parent_path() / out.replay).string();
  const auto file = files->read(path, serial::recording_octets_max);
  if (!file.text) {
    in.problems().add(in.at("replay"), in_quotes(path) + ' ' + file.reason);
    return;
  }
  auto found = serial::read_recording(*file.text, island);
  if (auto* wrong = std::get_if<serial::recording_problem>(&found)) {
    in.problems().add(
        problem{path, static_cast<unsigned>(wrong->line), 0, std::move(wrong->message)});
    return;
  }
  auto& frames = std::get<0>(found);
  if (frames.empty())
    in.problems().add(in.at("replay"),
                      in_quotes(path) + " has no recording of an island named `" + island + '`');
  out.recorded = std::make_shared<const std::vector<serial::recorded_frame>>(std::move(frames));
}

/// Complains about what does not go together. @pre `out` is read
void check_outside(table_reader& in, const surroundings& with, const std::string& island,
                   serial::outside_config& out) {
  std::string first;
  for (const auto* key : {"device", "forwarder", "replay", "pty"}) {
    if (!in.has(key))
      continue;
    if (!first.empty())
      in.problems().add(in.at(key), '`' + std::string(key) + "` has no effect with `" + first +
                                        "`: a cable has one sink and one gateway");
    first = first.empty() ? key : first;
  }
  for (const auto* key : {"device", "forwarder", "pty"})
    need_wall_time(in, with, key);
  const auto forwarder = parse_host_port(out.forwarder);
  if (in.has("forwarder") && !out.forwarder.empty() && (!forwarder || forwarder->host.empty()))
    in.problems().add(in.at("forwarder"),
                      "expected HOST:PORT with a port from 1 to 65535, as in \"localhost:9002\"");
  read_replay(in, island, out);
  if (in.has("speed") && !in.has("replay"))
    in.problems().add(in.at("speed"), "`speed` has no effect without `replay`");
  if (in.has("payload") && !out.has_sink())
    in.problems().add(in.at("payload"), "`payload` has no effect without a real sink");
  if (in.has("octet_error") && out.has_sink())
    in.problems().add(in.at("octet_error"), "`octet_error` has no effect with `" + first +
                                                "`: a real cable makes errors of its own");
}

} // namespace

void read_outside(table_reader& in, const surroundings& with, const std::string& island,
                  serial::outside_config& out) {
  in.all(out);
  check_outside(in, with, island, out);
}

namespace {

auto export_network_keys() {
  return keys::of(keys::optional(
      "networks", &serial::export_config::networks, list_of<network_text>{{}, 0, networks_max},
      {"networks that programs may connect from; others are closed at once", "anywhere"}));
}

/// Name of a mote behind a real line.
struct real_mote {
  mote_id id;
  std::string name;
};

auto real_mote_keys() {
  return keys::of(
      keys::required("id", &real_mote::id, whole<std::uint16_t>{0, mote_id_max}, "its address"),
      keys::required("name", &real_mote::name, labelled_name{}, "unique within the island"));
}

} // namespace

void read_export(table_reader& island, const surroundings& with, island_description& out) {
  island.table(
      "export", "[island.export]", {"TinyOS's programs also reach the sink here", "they do not"},
      [&](table_reader& in) {
        in.all(out.exported);
        need_wall_time(in, with, "forwarder");
        const auto& where = out.exported.forwarder;
        const auto found = parse_host_port(where);
        if (!where.empty() && (!found || !parse_ipv4_address(found->host)))
          in.problems().add(in.at("forwarder"),
                            "expected ADDRESS:PORT with an IPv4 address of this computer, "
                            "as in \"127.0.0.1:9002\"");
        in.all(out.exported, export_network_keys());
        const auto address = found ? parse_ipv4_address(found->host) : errc::bad_value;
        if (address && address->at(0) != 127 && out.exported.networks.empty())
          in.problems().warn(in.at("forwarder"),
                             where + " is reachable from other computers: anyone who can connect "
                                     "controls the motes; restrict it with `networks`");
      });
}

namespace {

void check_order(const table_reader& in, std::uint16_t first, std::uint16_t last) {
  if (in.sound() && last < first)
    in.problems().add(in.at("last"),
                      "`last` must not be below `first`, which is " + std::to_string(first));
}

gateway::plain_rule read_rule(table_reader& in, const island_description& island) {
  gateway::plain_rule x;
  in.all(x);
  const auto& range = island.real.motes;
  if (island.real.is_there()) {
    x.first = in.has("first") ? x.first : range.first;
    x.last = in.has("last") ? x.last : range.last;
  }
  if (in.has("first") || in.has("last"))
    check_order(in, x.first, x.last);
  for (const auto& [key, id] : {std::pair("first", x.first), std::pair("last", x.last)})
    if (island.real.is_there() && in.has(key) && in.sound() && !range.has(mote_id(id)))
      in.problems().add(in.at(key),
                        "mote " + std::to_string(id) + " is not in the range of `real`, which is " +
                            std::to_string(range.first) + " to " + std::to_string(range.last));
  if (!in.walks() && !in.has("am_type") && !in.has("pattern"))
    in.problems().add(in.at("type"), "`am_type` or `pattern` is missing in [[island.plain]]");
  if (in.has("pattern_offset") && !in.has("pattern"))
    in.problems().add(in.at("pattern_offset"), "`pattern_offset` has no effect without `pattern`");
  if (in.has("input") && !in.has("input_am_type") && !in.has("am_type"))
    in.problems().add(in.at("input"), "`input` needs `input_am_type` where `am_type` is missing");
  if (!in.has("input_am_type"))
    x.input_am_type = x.am_type.value_or(0);
  for (const auto* key : {"input_am_type", "input_form"})
    if (in.has(key) && !in.has("input"))
      in.problems().add(in.at(key), '`' + std::string(key) + "` has no effect without `input`");
  return x;
}

} // namespace

real_names read_real(table_reader& island, surroundings& with, island_description& out) {
  real_names names;
  auto& real = out.real;
  const auto read = [&](table_reader& in) {
    in.all(real.motes);
    in.all(real.outside, real_line_keys(&real.outside));
    in.all(real.serial, real_line_keys(&real.serial));
    check_outside(in, with, out.name + std::string(serial::real_line_suffix), real.outside);
    check_order(in, real.motes.first, real.motes.last);
    if (!in.walks() && !real.is_there())
      in.problems().add(island.at("real"),
                        "`device`, `forwarder` or `replay` is missing in [island.real]");
    if (in.sound() && real.motes.has(out.sink.id))
      in.problems().add(in.at("first"), "the range of `real` has mote " + to_string(out.sink.id) +
                                            ", which is the simulated sink");
    in.tables("mote", "[[island.real.mote]]", {"names for motes behind it", "their addresses"},
              [&](table_reader& mote) {
                real_mote found;
                mote.all(found, real_mote_keys());
                const auto& [id, name] = found;
                with.labels.add(label_table::kind::mote, out.name + '/' + name, read_label(mote));
                if (mote.sound() && !real.motes.has(id))
                  mote.problems().add(mote.at("id"),
                                      "mote " + to_string(id) + " is not in the range of `real`");
                real.names.emplace_back(id, name);
                names.emplace_back(mote.at("name"), name);
              });
  };
  island.table("real", "[island.real]",
               {"a line to a real base station in addition to the simulated sink: motes behind it "
                "with plain programs of TinyOS are devices of the island like simulated ones",
                "none"},
               read);
  if (real.is_there() && out.outside.has_sink())
    island.problems().add(island.at("real"), "`real` has no effect in an island with a real sink");
  return names;
}

void read_plain(table_reader& island, island_description& out) {
  island.tables("plain", "[[island.plain]]",
                {"motes that run plain programs of TinyOS but are devices of the island", "none"},
                [&out](table_reader& in) { out.plain.push_back(read_rule(in, out)); });
  if (!out.plain.empty() && !has_plain_sink(out) && !island.has("real"))
    island.problems().add(island.at("plain"),
                          "`plain` has no effect without a real sink, a base station or `real`");
  if (out.plain.empty() && out.real.is_there())
    island.problems().add(
        island.at("real"),
        "`real` has no effect without `plain`, which describes what its motes send");
}

void refuse_gateway(table_reader& in) {
  for (const auto* key : {"gateway", "alias", "export", "plain", "real"}) {
    in.expect(key);
    if (in.has(key))
      in.problems().add(in.at(key),
                        '`' + std::string(key) +
                            "` has no effect with `pty`: the program that opens it is the gateway");
  }
}

void refuse_simulated(table_reader& in) {
  for (const auto* key : {"alias", "duty_cycle", "low_power_listening"})
    if (in.has(key))
      in.problems().add(in.at(key),
                        '`' + std::string(key) + "` has no effect in an island with a real sink");
}

} // namespace rubicon::config
