#include "view/ecology_json.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "config/summary_parts.hpp"
#include "core/text/json.hpp"
#include "report/fault_plan.hpp"

namespace rubicon::view {

namespace {

using json = nlohmann::ordered_json;

constexpr std::size_t faults_max = 10'000;

using label_kind = config::label_table::kind;

/// Beside the name, if there is one.
void add_label(json& to, const std::string& label) {
  if (!label.empty())
    to["label"] = label;
}

/// `mote_labels` of an island: by the names of motes.
void add_mote_label(json& island, const std::string& mote, const std::string& label) {
  if (!label.empty())
    island["mote_labels"][mote] = label;
}

json island_json(const config::ecology_description& all, const config::island_description& x) {
  json y = {{"id", x.id.value}, {"name", x.name}};
  add_label(y, all.labels.of(label_kind::island, x.name));
  const auto air = std::ranges::find_if(all.airs, [&x](const config::air_description& each) {
    return std::ranges::find(each.islands, x.id) != each.islands.end();
  });
  y["air"] = air - all.airs.begin();
  if (x.stack != config::stack::full) // no mote joins it
    y["mac"] = true;
  y["sink"] = {{"id", x.sink.id.value}, {"x", x.sink.place.x_m}, {"y", x.sink.place.y_m}};
  auto& gateways = y["gateways"] = json::array();
  if (config::has_line(x.stack))
    gateways.push_back(x.gateway_name);
  for (const auto& each : x.aliases)
    gateways.push_back(each.name);
  auto& motes = y["motes"] = json::array();
  for (const auto& each : x.motes)
    motes.push_back(
        json::array({each.id.value, each.name, each.place.x_m, each.place.y_m, each.type_name}));
  for (const auto& each : x.motes)
    add_mote_label(y, each.name, all.labels.of(label_kind::mote, x.name + '/' + each.name));
  return y;
}

/// Of motes that are carried, by their index.
json paths_json(const config::ecology_description& x) {
  json paths = json::object();
  std::size_t index = 0;
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes) {
      if (!mote.path.empty()) {
        auto& path = paths[std::to_string(index)] = json::array();
        for (const auto& each : mote.path)
          path.push_back(json::array({seconds(each.at), each.place.x_m, each.place.y_m}));
      }
      ++index;
    }
  return paths;
}

json peers_json(const config::ecology_description& x, json& links) {
  auto peers = json::array();
  const auto add = [&](const std::string& name, std::int32_t id, const char* kind,
                       const std::string& host, const std::vector<std::string>& to) {
    peers.push_back({{"name", name}, {"id", id}, {"kind", kind}, {"host", host}});
    add_label(peers.back(), x.labels.of(label_kind::peer, name));
    for (const auto& each : to)
      links.push_back(json::array({name, each}));
  };
  for (const auto& island : x.islands) {
    if (!config::has_line(island.stack))
      continue;
    add(island.gateway_name, gateway_of(island.id).value, "gateway", island.host,
        island.gateway_links);
    for (const auto& each : island.aliases)
      add(each.name, each.id.value, "gateway", island.host, each.links);
  }
  for (const auto& peer : x.peers)
    add(peer.name, peer.id.value, "peer", peer.host, peer.links);
  return peers;
}

} // namespace

std::vector<listed_event> planned_faults(const config::ecology_description& x) {
  if (x.faults.empty())
    return {};
  const auto rows = config::fault_rows(x);
  std::vector<listed_event> all;
  for (const auto& each : report::plan_faults(x)) {
    if (all.size() >= faults_max)
      break;
    all.push_back({instant(each.at), "fault", config::fault_text(rows.at(each.index)), "fault"});
  }
  return all;
}

std::vector<listed_event> planned_faults(const std::string& ecology) {
  const auto x = try_parse_ordered_json(ecology);
  std::vector<listed_event> all;
  if (!x.is_object() || !x.contains("faults") || !x["faults"].is_array())
    return all;
  for (const auto& each : x["faults"]) {
    const bool is_one =
        each.is_array() && each.size() == 2 && each[0].is_number_integer() && each[1].is_string();
    if (is_one)
      all.push_back({instant(duration(each[0].get<std::int64_t>())), "fault",
                     each[1].get<std::string>(), "fault"});
  }
  return all;
}

std::string ecology_json(const config::ecology_description& x) {
  json y = {{"kind", "ecology"},
            {"name", x.name},
            {"seed", x.seed},
            {"mode", x.mode == config::run_mode::wall ? "wall" : "virtual"},
            {"length_s", seconds(x.length)}};
  if (x.day_begins != duration{})
    y["start_s"] = seconds(x.day_begins);
  if (x.plan)
    y["plan"] = {{"x_m", x.plan->corner.x_m},
                 {"y_m", x.plan->corner.y_m},
                 {"width_m", x.plan->width_m},
                 {"picture", x.plan->picture}};
  auto& islands = y["islands"] = json::array();
  for (const auto& each : x.islands)
    islands.push_back(island_json(x, each));
  y["paths"] = paths_json(x);
  json links = json::array();
  y["peers"] = peers_json(x, links);
  y["peis_links"] = std::move(links);
  auto& faults = y["faults"] = json::array();
  for (const auto& each : planned_faults(x))
    faults.push_back(json::array({each.at.time_since_epoch().count(), each.what}));
  return json_line(y);
}

std::string plan_picture(const std::string& ecology) {
  const auto x = try_parse_ordered_json(ecology);
  if (!x.is_object() || !x.contains("plan") || !x["plan"].is_object())
    return {};
  const auto picture = x["plan"].find("picture");
  return picture != x["plan"].end() && picture->is_string() ? picture->get<std::string>()
                                                            : std::string();
}

std::string with_facts(const std::string& ecology, const run_facts& facts,
                       const std::string& mode) {
  auto x = try_parse_ordered_json(ecology);
  if (!x.is_object())
    return {};
  if (!mode.empty())
    x["mode"] = mode;
  x["file"] = facts.file;
  x["command"] = facts.command;
  x["control"] = facts.controls;
  x["messages"] = facts.messages;
  return json_line(x);
}

} // namespace rubicon::view
