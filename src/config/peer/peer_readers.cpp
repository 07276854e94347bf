#include <algorithm>
#include <utility>

#include "config/file_readers.hpp"
#include "config/island/application_readers.hpp"
#include "config/island/size_check.hpp"
#include "config/label_keys.hpp"
#include "config/peer/component_readers.hpp"
#include "config/peer/peer_keys.hpp"
#include "core/tuples/device_keys.hpp"

namespace rubicon::config {

namespace {

/// What all peers have in common.
struct peer_surroundings {
  const std::vector<island_description>& islands;
  uniqueness<island_id>
      managed; ///< proxies map one-to-one to motes, so managers to islands (PXY-15)
  uniqueness<std::string> object_managers{}; ///< "objects": a tagged object has one proxy as well
  name_uniqueness readers{};
  name_uniqueness pursuers{};
  uniqueness<std::pair<std::string, std::uint32_t>> ports{}; ///< by host
  machine_places places{};
  std::vector<placed_init> inits{};
};

proxy_manager_app read_manager(table_reader& in, peer_surroundings& with) {
  proxy_manager_app out;
  managed_islands found;
  in.all(out, object_manager_keys());
  if (out.objects)
    with.object_managers.add("objects", "the proxy manager of tagged objects", in.at("objects"),
                             in.problems());
  in.all(found, managed_island_keys(out.objects || in.walks() ? 0 : 1));
  if (!in.has("islands")) {
    for (const auto& each : with.islands)
      if (has_line(each.stack))
        found.islands.push_back({each.id, in.at("islands")});
  }
  for (const auto& each : found.islands) {
    const auto island = std::find_if(with.islands.begin(), with.islands.end(),
                                     [&each](const auto& x) { return x.id == each.value; });
    if (island != with.islands.end() && island->stack == stack::mac)
      in.problems().add(each.at,
                        "island `" + island->name + "` has no gateway, since its stack is \"mac\"");
    else if (island != with.islands.end() && each.value.value != 0)
      with.managed.add(each.value, "island `" + island->name + '`', each.at, in.problems(),
                       "already has a proxy manager");
  }
  out.islands = values_of(std::move(found.islands));
  return out;
}

bool names_output_channel(const std::string& key) {
  const auto pattern = parse_output_pattern(key);
  return pattern && pattern->channel;
}

collector_app read_collector(table_reader& in) {
  collector_app app;
  in.all(app);
  if (in.is_good("every") && std::ranges::none_of(app.keys, names_output_channel))
    in.problems().add(in.at("every"), "`every` needs a key that names an output channel of motes, "
                                      "such as `devices.*.output.1`");
  auto& seen = in.shared().seen;
  for (auto& [key, at] : texts_at(in, "keys", app.keys))
    seen.uses.push_back({"the collector of " + seen.peer + " reads", std::move(key), at});
  return app;
}

/// The peers of one table.
struct peer_table {
  std::uint32_t count = 1;
  bool counted = false; ///< the names have numbers
  peer_description like;

  [[nodiscard]] std::string name(std::uint32_t i) const {
    return counted ? counted_peer_name(like.name, i + 1) : like.name;
  }
  [[nodiscard]] peer_id id(std::uint32_t i) const {
    return peer_id(like.id.value + static_cast<std::int32_t>(i));
  }
};

/// id, name and count: who they are. Of a table that is not good no more than one peer is left.
void read_identity(table_reader& in, surroundings& with, peer_table& out) {
  peer_count number;
  in.all(out.like, peer_identity_keys());
  in.all(number);
  const bool has_id = in.is_good("id");
  const bool has_name = in.is_good("name");
  out.counted = in.is_good("count");
  out.count = number.count;
  if (out.id(out.count - 1).value > peer_id_max) {
    in.problems().add(in.at("count"), "PEIS ids from " + to_string(out.like.id) + " to " +
                                          to_string(out.id(out.count - 1)) + " are more than " +
                                          std::to_string(peer_id_max));
    out.count = 1;
  }
  if (has_name && !is_name(out.name(out.count - 1))) {
    in.problems().add(in.at("name"),
                      "`" + out.name(out.count - 1) + "` would be longer than 32 characters");
    out.count = 1;
  }
  bool free = true;
  for (std::uint32_t i = 0; i < out.count && free; ++i) { // the first mistake will do
    free = !has_id || with.end_ids.add(out.id(i).value, "PEIS id " + to_string(out.id(i)),
                                       in.at("id"), in.problems());
    free = (!has_name || with.end_names.add(out.name(i), "peer or gateway name", in.at("name"),
                                            in.problems())) &&
           free;
  }
}

/// tcp = true, or tcp = { port = 8000 }
void read_tcp(table_reader& in, const peer_table& peers, peer_surroundings& all,
              std::optional<tcp_listener>& out) {
  const auto* given = in.content().find("tcp");
  if (given != nullptr && given->as<node_table>() == nullptr) {
    in.expect("tcp");
    const auto* on = given->as<bool>();
    if (on == nullptr)
      asker{"tcp", in.shared()}.refuse(*given, "true, false or a table, as in { port = 8000 }");
    else if (*on)
      out.emplace();
    return;
  }
  in.table(
      "tcp", "[peer.tcp]",
      {"accepts links from the real network, on this computer's loopback address unless `address` "
       "or `lan` sets another; needs `mode = \"wall\"`",
       "`false`"},
      [&](table_reader& x) {
        first_port first;
        x.all(out.emplace(), listener_keys());
        x.all(first);
        if (!x.is_good("port"))
          return;
        const auto port = first.port;
        out->port = port;
        if (port + peers.count - 1 > 65535) {
          x.problems().add(x.at("port"), "ports from " + std::to_string(port) +
                                             " on are too few for " + std::to_string(peers.count) +
                                             " peers");
          return;
        }
        bool free = true;
        for (std::uint32_t i = 0; i < peers.count && free; ++i)
          free = all.ports.add({peers.like.host, port + i}, "TCP port " + std::to_string(port + i),
                               x.at("port"), x.problems());
      });
  in.instead_of_table("tcp", flag{});
}

/// What only the real network has.
void refuse_in_virtual_time(const table_reader& in, std::string_view key, bool used) {
  if (used)
    in.problems().add(in.at(key), '`' + std::string(key) +
                                      "` needs mode = \"wall\": in virtual time there is no real "
                                      "network");
}

/// Links over UDP are asked for, and have something to be for.
void check_udp(const table_reader& in, const peer_description& x) {
  const auto found =
      std::ranges::find_if(x.connect, [](const auto& each) { return each.starts_with("udp://"); });
  if (!x.udp && found != x.connect.end())
    in.problems().add(in.at("connect"), '`' + *found + "` needs `udp = true`");
  if (x.udp && !x.tcp && !x.lan && found == x.connect.end())
    in.problems().add(in.at("udp"), "`udp` needs `tcp`, `lan` or a `udp://` address in `connect`");
}

/// How the peers meet others.
void read_connections(table_reader& in, surroundings& with, const peer_table& peers,
                      peer_surroundings& all, peer_description& out) {
  std::vector<std::string> own;
  for (std::uint32_t i = 0; i < peers.count; ++i)
    own.push_back(peers.name(i));
  out.links =
      read_links(in, own, "peers to which it always keeps a link, over the simulated network");
  in.all(out, peer_address_keys());
  read_tcp(in, peers, all, out.tcp);
  in.all(out, peer_network_keys());
  if (with.mode == run_mode::virtual_time) {
    refuse_in_virtual_time(in, "udp", out.udp);
    refuse_in_virtual_time(in, "connect", !out.connect.empty());
    refuse_in_virtual_time(in, "tcp", out.tcp.has_value());
    refuse_in_virtual_time(in, "lan", out.lan);
  } else {
    check_udp(in, out);
  }
  in.all(out, peer_link_keys());
  out.discovery = out.links.empty() && out.connect.empty();
  in.all(out, peer_clock_keys());
}

/// Readers have names of their own, by default that of their peer.
rfid::reader_config read_reader(table_reader& in, const peer_table& peers, peer_surroundings& all) {
  auto out = read_rfid_reader(in, peers.like.name);
  if (peers.count > 1)
    in.problems().add(in.at("app"), "a place has one reader, not " + std::to_string(peers.count));
  else if (!out.name.empty())
    all.readers.add(out.name, "reader", in.has("name") ? in.at("name") : in.at("app"),
                    in.problems());
  return out;
}

/// A pursuer without a name has that of its peer, so peers with a `count` have one each.
void add_pursuer(const table_reader& in, const peer_table& peers, peer_surroundings& all,
                 const std::string& name) {
  const auto at = in.has("name") ? in.at("name") : in.at("app");
  for (std::uint32_t i = 0; i < peers.count; ++i) { // the first mistake will do
    const auto& own = name.empty() ? peers.name(i) : name;
    if (!own.empty() && !all.pursuers.add(own, "pursuer", at, in.problems()))
      return;
  }
}

void read_peer(table_reader& in, surroundings& with, peer_surroundings& apps,
               std::vector<peer_description>& out) {
  peer_table peers;
  read_identity(in, with, peers);
  auto& like = peers.like;
  const auto label = read_label(in);
  for (std::uint32_t i = 0; i < peers.count; ++i)
    with.labels.add(label_table::kind::peer, peers.name(i), label);
  in.all(like, peer_host_keys());
  read_connections(in, with, peers, apps, like);
  read_adapters(in, with.mode, apps.places, like);
  end_uniqueness ends;
  in.shared().seen.peer = like.name;
  in.tables("apps", "apps of a peer", {"its programs", "none"}, [&](table_reader& x) {
    const auto add = [&like](peer_app app) { like.apps.push_back(std::move(app)); };
    std::vector<std::pair<std::string_view, table_reader::part_reader>> choices{
        {"proxy_manager",
         [&](table_reader& y) {
           if (peers.count > 1)
             y.problems().add(y.at("app"), "an island has one proxy manager, not " +
                                               std::to_string(peers.count));
           add(read_manager(y, apps));
         }},
        {"rules", [&](table_reader& y) { add(read_rules(y, with)); }},
        {"collector", [&](table_reader& y) { add(read_collector(y)); }},
        {"translate", [&](table_reader& y) { add(read_translate(y)); }},
        {"rfid_reader", [&](table_reader& y) { add(read_reader(y, peers, apps)); }},
        {"goal",
         [&](table_reader& y) {
           auto app = read_pursuer(y);
           add_pursuer(y, peers, apps, app.name);
           add(std::move(app));
         }},
        {"init", [&](table_reader& y) {
           if (peers.count > 1)
             y.problems().add(y.at("app"),
                              "a host has one init, not " + std::to_string(peers.count));
           if (std::any_of(like.apps.begin(), like.apps.end(),
                           [](const auto& app) { return std::holds_alternative<init_app>(app); }))
             y.problems().add(y.at("app"), "the peer already has an init");
           add(read_init(y, with, peers.like.id, apps.inits));
         }}};
    for (const auto& [word, read] : pc_programs(in, with.files))
      choices.emplace_back(word, [&, word = word, read = read](table_reader& y) {
        if (peers.count > 1 && word == "recorder")
          y.problems().add(y.at("app"),
                           "a file has one recorder, not " + std::to_string(peers.count));
        auto program = read(y).app;
        ends.add(program, y.at("app"), y.problems());
        add(std::move(program));
      });
    x.one_of("app", "which program", choices);
  });
  for (std::uint32_t i = 0; i < peers.count; ++i) {
    auto peer = like;
    peer.id = peers.id(i);
    peer.name = peers.name(i);
    peer.table = peers.counted ? peers.like.name : std::string();
    for (auto& app : peer.apps) {
      auto* const pursuer = std::get_if<goal::pursuer_config>(&app);
      if (pursuer != nullptr && pursuer->name.empty())
        pursuer->name = peer.name;
    }
    if (peer.tcp && peer.tcp->port)
      peer.tcp->port = static_cast<std::uint16_t>(*peer.tcp->port + i);
    out.push_back(std::move(peer));
  }
}

} // namespace

std::vector<std::string> read_links(table_reader& in, const std::vector<std::string>& own_names,
                                    const char* whom) {
  link_list found;
  in.all(found, peer_links_keys(whom));
  uniqueness<std::string> listed;
  for (const auto& each : found.links) {
    if (std::find(own_names.begin(), own_names.end(), each.value) != own_names.end())
      in.problems().add(each.at, "`" + each.value + "` cannot have a link to itself");
    listed.add(each.value, "the link to `" + each.value + '`', each.at, in.problems(),
               "is already listed");
  }
  return values_of(std::move(found.links));
}

peis_description read_peis(table_reader& root) {
  peis_description out;
  root.table("peis", "[peis]", "the network between the hosts of peers", [&out](table_reader& in) {
    in.all(out);
    read_bluetooth(in, out.bluetooth);
  });
  return out;
}

std::vector<peer_description> read_peers(table_reader& root, surroundings& with,
                                         const std::vector<island_description>& islands) {
  std::vector<peer_description> out;
  peer_surroundings apps{.islands = islands, .managed = {}};
  root.tables("peer", "[[peer]]", "PCs and robots",
              [&](table_reader& x) { read_peer(x, with, apps, out); });
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  settle_inits(std::move(apps.inits), out, with);
  return out;
}

} // namespace rubicon::config
