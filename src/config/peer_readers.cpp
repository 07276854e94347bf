#include <algorithm>
#include <utility>

#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t links_max = 16;

/// What the apps of all peers need.
struct peer_apps {
  const directory& names;
  const std::vector<island_description>& islands;
  claims<island_id> managed; ///< proxies map one-to-one to motes, so managers to islands (PXY-15)
};

proxy_manager_app read_manager(table_reader& in, peer_apps& with) {
  std::vector<located<island_id>> found;
  in.optional("islands", list_of<island_name>{{with.names}, 1}, found);
  if (!in.has("islands")) {
    for (const auto& each : with.islands)
      if (each.stack == stack::full)
        found.push_back({each.id, in.at("islands")});
  }
  for (const auto& each : found) {
    const auto island = std::find_if(with.islands.begin(), with.islands.end(),
                                     [&each](const auto& x) { return x.id == each.value; });
    if (island != with.islands.end() && island->stack == stack::mac)
      in.problems().add(each.at,
                        "island `" + island->name + "` has no gateway, since its stack is \"mac\"");
    else if (island != with.islands.end() && each.value.value != 0)
      with.managed.claim(each.value, "island `" + island->name + '`', each.at, in.problems(),
                         "already has a proxy manager");
  }
  return {values_of(std::move(found))};
}

rule read_rule(table_reader& in) {
  rule out;
  in.required("when", tuple_key{}, out.when);
  in.optional("above", real{}, out.above);
  in.optional("below", real{}, out.below);
  in.required("write", tuple_key{}, out.write);
  in.optional("then", text{}, out.then);
  in.optional("otherwise", text{}, out.otherwise);
  if (!in.has("above") && !in.has("below"))
    in.problems().add(in.at(), "a rule needs `above`, `below` or both");
  if (!in.has("then") && !in.has("otherwise"))
    in.problems().add(in.at(), "a rule needs `then`, `otherwise` or both");
  if (out.above && out.below && *out.below > *out.above)
    in.problems().add(in.at("below"),
                      "`below` must not be more than `above`, which is " + shown(*out.above));
  return out;
}

rules_app read_rules(table_reader& in) {
  rules_app out;
  in.tables(
      "rules", "rules", [&out](table_reader& x) { out.rules.push_back(read_rule(x)); }, 1);
  return out;
}

collector_app read_collector(table_reader& in) {
  std::vector<located<std::string>> keys;
  in.required("keys", list_of<tuple_key>{{true}, 1}, keys);
  return {values_of(std::move(keys))};
}

peer_description read_peer(table_reader& in, surroundings& with, peer_apps& apps) {
  peer_description out;
  if (in.required("id", whole<std::int32_t>{1, peer_id_max}, out.id))
    with.end_ids.claim(out.id.value, "PEIS id " + to_string(out.id), in.at("id"), in.problems());
  if (in.required("name", name_text{}, out.name))
    with.end_names.claim(out.name, "peer or gateway name", in.at("name"), in.problems());
  in.optional("host", host_name{with.names}, out.host);
  out.links = read_links(in, with.names, out.name);
  in.tables("apps", "apps of a peer", [&](table_reader& x) {
    const auto add = [&out](peer_app app) { out.apps.push_back(std::move(app)); };
    x.one_of("app", {{"proxy_manager", [&](table_reader& y) { add(read_manager(y, apps)); }},
                     {"rules", [&](table_reader& y) { add(read_rules(y)); }},
                     {"collector", [&](table_reader& y) { add(read_collector(y)); }}});
  });
  return out;
}

} // namespace

std::vector<std::string> read_links(table_reader& in, const directory& names,
                                    const std::string& own_name) {
  std::vector<located<std::string>> found;
  in.optional("links", list_of<link_end>{{names}, 0, links_max}, found);
  claims<std::string> listed;
  for (const auto& each : found) {
    if (each.value == own_name)
      in.problems().add(each.at, "`" + own_name + "` cannot have a link to itself");
    listed.claim(each.value, "the link to `" + each.value + '`', each.at, in.problems(),
                 "is already listed");
  }
  return values_of(std::move(found));
}

std::vector<peer_description> read_peers(table_reader& root, surroundings& with,
                                         const std::vector<island_description>& islands) {
  std::vector<peer_description> out;
  peer_apps apps{with.names, islands, {}};
  root.tables("peer", "[[peer]]",
              [&](table_reader& x) { out.push_back(read_peer(x, with, apps)); });
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return out;
}

} // namespace rubicon::config
