#include "config/outside_readers.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "config/document.hpp"
#include "core/host_port.hpp"
#include "core/ipv4_network.hpp"
#include "gateway/plain_keys.hpp"
#include "serial/line_keys.hpp"
#include "serial/recording.hpp"

namespace rubicon::config {

namespace {

void need_wall_time(table_reader& in, const surroundings& with, const char* key) {
  if (in.has(key) && with.mode != run_mode::wall)
    in.problems().add(in.at(key), '`' + std::string(key) +
                                      "` needs mode = \"wall\": in virtual time nobody outside can "
                                      "keep pace");
}

/// What the sink of an island has once said.
void read_replay(table_reader& in, const std::string& island, serial::outside_config& out) {
  const auto* files = in.shared().files;
  if (out.replay.empty() || files == nullptr)
    return;
  const auto path = (std::filesystem::path(files->toml).parent_path() / out.replay).string();
  const auto file = files->read(path, serial::recording_octets_max);
  if (!file.text) {
    in.problems().add(in.at("replay"), config::quoted(path) + ' ' + file.reason);
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
    in.problems().add(in.at("replay"), config::quoted(path) +
                                           " has nothing of an island with the name `" + island +
                                           '`');
  out.recorded = std::make_shared<const std::vector<serial::recorded_frame>>(std::move(frames));
}

} // namespace

void read_outside(table_reader& in, const surroundings& with, const std::string& island,
                  serial::outside_config& out) {
  in.all(out);
  std::string first;
  for (const auto* key : {"device", "forwarder", "replay", "pty"}) {
    if (!in.has(key))
      continue;
    if (!first.empty())
      in.problems().add(in.at(key), '`' + std::string(key) + "` means nothing with `" + first +
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
    in.problems().add(in.at("speed"), "`speed` means nothing without `replay`");
  if (in.has("payload") && !out.has_sink())
    in.problems().add(in.at("payload"), "`payload` means nothing without a real sink");
  if (in.has("octet_error") && out.has_sink())
    in.problems().add(in.at("octet_error"), "`octet_error` means nothing with `" + first +
                                                "`: a real cable makes errors of its own");
}

void read_export(table_reader& island, const surroundings& with, island_description& out) {
  island.table("export", "[island.export]",
               {"TinyOS's programs find the sink here, too", "they do not"}, [&](table_reader& in) {
                 in.all(out.exported);
                 need_wall_time(in, with, "forwarder");
                 const auto& where = out.exported.forwarder;
                 const auto found = parse_host_port(where);
                 if (!where.empty() && (!found || !parse_ipv4_address(found->host)))
                   in.problems().add(in.at("forwarder"),
                                     "expected ADDRESS:PORT with an IPv4 address of this computer, "
                                     "as in \"127.0.0.1:9002\"");
               });
}

void read_plain(table_reader& island, island_description& out) {
  island.tables("plain", "[[island.plain]]",
                {"which motes run plain programs of TinyOS, and are devices all the same", "none"},
                [&out](table_reader& in) {
                  gateway::plain_rule x;
                  in.all(x);
                  if (in.sound() && x.last < x.first)
                    in.problems().add(in.at("last"), "`last` must not be below `first`, which is " +
                                                         std::to_string(x.first));
                  out.plain.push_back(x);
                });
  if (!out.plain.empty() && !out.outside.has_sink())
    island.problems().add(island.at("plain"), "`plain` means nothing without a real sink");
}

void refuse_gateway(table_reader& in) {
  for (const auto* key : {"gateway", "alias", "export", "plain"}) {
    in.expect(key);
    if (in.has(key))
      in.problems().add(in.at(key), '`' + std::string(key) +
                                        "` means nothing with `pty`: the gateway is the program's "
                                        "that opens it");
  }
}

void refuse_simulated(table_reader& in) {
  for (const auto* key : {"alias", "duty_cycle"})
    if (in.has(key))
      in.problems().add(in.at(key),
                        '`' + std::string(key) + "` means nothing in an island with a real sink");
}

} // namespace rubicon::config
