#include "config/listing.hpp"

#include <algorithm>
#include <vector>

#include "config/checks/tuple_keys.hpp"
#include "core/text/printable.hpp"

namespace rubicon::config {

namespace {

using rows = std::vector<std::vector<std::string>>;

std::string section(const char* heading, rows all) {
  if (all.empty())
    return {};
  std::vector<std::size_t> widths;
  for (auto& cells : all) {
    widths.resize(std::max(widths.size(), cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i] = printable(cells[i]);
      widths[i] = std::max(widths[i], cells[i].size());
    }
  }
  std::string text = std::string(heading) + '\n';
  for (const auto& cells : all) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i)
      line += "  " + cells[i] + std::string(widths[i] - cells[i].size(), ' ');
    text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  }
  return text;
}

using kind = label_table::kind;

rows motes(const ecology_description& x) {
  rows all;
  for (const auto& island : x.islands) {
    all.push_back({island.name + "/sink", to_string(mote_address{island.id, island.sink.id}), ""});
    for (const auto& mote : island.motes) {
      const auto* what = class_of(x, island.id, mote);
      const auto name = island.name + '/' + mote.name;
      all.push_back({name, to_string(mote_address{island.id, mote.id}),
                     "type " + std::to_string(mote.type) +
                         (mote.type_name.empty() ? "" : " (" + mote.type_name + ')') +
                         (what == nullptr ? "" : ", proxy " + what->name),
                     x.labels.of(kind::mote, name)});
    }
    for (const auto& [id, own] : island.real.names) {
      const auto name = island.name + '/' + own;
      all.push_back(
          {name, to_string(mote_address{island.id, id}), "real", x.labels.of(kind::mote, name)});
    }
  }
  return all;
}

rows peers(const ecology_description& x) {
  rows all;
  const auto add = [&](const std::string& name, peer_id id, const std::string& what) {
    all.push_back({name, to_string(id), what, x.labels.of(kind::peer, name)});
  };
  for (const auto& island : x.islands) {
    if (!has_line(island.stack) || island.outside.has_gateway())
      continue;
    add(island.gateway_name, gateway_of(island.id), "gateway of " + island.name);
    for (const auto& alias : island.aliases)
      add(alias.name, alias.id, "gateway of " + island.name);
  }
  for (const auto& peer : x.peers)
    add(peer.name, peer.id, "");
  return all;
}

rows tuples(const ecology_description& x) {
  rows all;
  for (const auto& each : tuple_keys(x))
    all.push_back({each.pattern, each.owner});
  return all;
}

} // namespace

std::string listing(const ecology_description& x) {
  std::string text;
  for (const auto& part :
       {section("motes", motes(x)), section("peers", peers(x)), section("tuples", tuples(x))})
    text += (text.empty() || part.empty() ? "" : "\n") + part;
  return text;
}

} // namespace rubicon::config
