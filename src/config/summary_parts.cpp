#include "config/summary_parts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "config/plan/debug_selection.hpp"
#include "config/run/change_text.hpp"
#include "config/toml/document.hpp"
#include "core/overloads.hpp"

namespace rubicon::config {

namespace {

std::string mote_text(const ecology_description& x, const mote_address& address) {
  for (const auto& island : x.islands) {
    for (const auto& mote : island.motes) {
      if (mote_address{island.id, mote.id} == address)
        return island.name + '/' + mote.name;
    }
  }
  return to_string(address);
}

struct fault_cells {
  const ecology_description& all;

  row operator()(const battery_end_fault& x) const { return {"battery_end", mote(x.mote)}; }
  row operator()(const crash_fault& x) const {
    return {"crash",
            mote(x.mote) + outage(x.length) + (x.becomes ? " and then of the type " + x.type : "")};
  }
  row operator()(const sink_crash_fault& x) const {
    return {"crash", sink(x.island) + outage(x.length)};
  }
  row operator()(const crystal_step_fault& x) const {
    return {"clock_step", mote(x.mote) + " by " + step(x.by)};
  }
  row operator()(const sink_step_fault& x) const {
    return {"clock_step", sink(x.island) + " by " + step(x.by)};
  }
  row operator()(const noise_fault& x) const {
    return {"noise", island_names(all, {x.island}) + " at " + place_text(x.place) + ", " +
                         shown(x.transmit_dbm) + " dBm" +
                         (x.channel ? " on channel " + std::to_string(*x.channel) : "") +
                         (x.duty < 1 ? ", " + percent(x.duty) + " of the time in bursts of " +
                                           to_text(x.burst)
                                     : "") +
                         lasting(x.length)};
  }
  row operator()(const radio_loss_fault& x) const {
    return {"radio_loss",
            percent(x.loss) + (x.island ? " in " + island(*x.island) : "") + lasting(x.length)};
  }
  row operator()(const mote_double_fault& x) const {
    return {"duplicate_id", mote(x.mote) + " at " + place_text(x.place) + lasting(x.length)};
  }
  row operator()(const move_island_fault& x) const {
    return {"move", mote(x.mote) + " to " + island_names(all, {x.to}) + " at " +
                        place_text(x.place) + ", off" + lasting(x.length)};
  }
  row operator()(const unplug_fault& x) const {
    if (x.further_sink)
      return {"unplug", "backbone of " + mote(*x.further_sink) + lasting(x.length)};
    return {"unplug", (x.gateway ? peer(*x.gateway) : island(x.island)) + lasting(x.length)};
  }
  row operator()(const kill_fault& x) const { return {"kill", peer(x.peer) + lasting(x.length)}; }
  row operator()(const power_off_fault& x) const {
    return {"power_off", peer(x.peer) + lasting(x.length)};
  }
  row operator()(const pause_fault& x) const { return {"pause", peer(x.peer) + lasting(x.length)}; }
  row operator()(const partition_fault& x) const {
    std::vector<std::string> groups;
    for (const auto& each : x.groups)
      groups.push_back(peers(each));
    return {"partition", joined(groups, " | ") + lasting(x.length)};
  }
  row operator()(const link_loss_fault& x) const {
    return {"link_loss", percent(x.loss) + (x.peers.empty() ? "" : " between " + peers(x.peers)) +
                             lasting(x.length)};
  }
  row operator()(const duplicate_id_fault& x) const {
    return {"duplicate_id", peer(x.peer) + lasting(x.length)};
  }
  row operator()(const clock_step_fault& x) const {
    return {"clock_step", peer(x.peer) + " by " + step(x.by)};
  }
  row operator()(const move_fault& x) const {
    return {"move", peer(x.peer) + " to " + place_text(x.to)};
  }

  row operator()(const change& x) const {
    return std::visit(
        overloads{
            [](const debug_change& y) {
              return row{"debug", "of " + debug_selection(y.of).text()};
            },
            [this](const program_change& y) {
              return row{"program", mote(y.mote) + ' ' + program_text(y) + ' ' + settings_text(y)};
            },
            [this](const link_change& y) {
              return row{"link", radio(y.from) + " to " + radio(y.to) + ", " + link_text(y)};
            },
            [](const proxy::class_change& y) {
              return row{"proxy_class", y.class_name + ": " + proxy::to_text(y)};
            },
            [this](const network_keys_change& y) {
              std::string motes;
              for (const auto& each : y.motes)
                motes += (motes.empty() ? "of " : ", ") + mote(each);
              return row{"network_keys", motes.empty() ? "of all members" : motes};
            },
        },
        x);
  }

  static std::string place_text(const position& x) {
    return '[' + shown(x.x_m) + ", " + shown(x.y_m) + (x.z_m == 0 ? "" : ", " + shown(x.z_m)) + ']';
  }
  static std::string outage(duration length) {
    return length == crash_fault{}.length ? std::string() : lasting(length);
  }
  static std::string step(duration by) { return by < 0s ? "-" + to_text(-by) : to_text(by); }
  [[nodiscard]] std::string island(island_id id) const {
    return id == any_island ? "any island" : island_names(all, {id});
  }
  [[nodiscard]] std::string sink(island_id id) const {
    return id == any_island ? "any sink" : island(id) + "/sink";
  }
  static std::string lasting(std::optional<duration> length) {
    return length ? " for " + to_text(*length) : std::string();
  }
  [[nodiscard]] std::string mote(const mote_address& x) const {
    return x == any_mote ? "any mote" : mote_text(all, x);
  }
  [[nodiscard]] std::string radio(const mote_address& x) const {
    for (const auto& each : all.islands)
      if (each.id == x.island && each.sink.id == x.mote)
        return each.name + "/sink";
    return mote(x);
  }
  [[nodiscard]] std::string peer(peer_id id) const {
    if (id == any_peer)
      return "any peer";
    for (const auto& each : all.peers) {
      if (each.id == id)
        return each.name;
    }
    return island_of_gateway(id);
  }
  [[nodiscard]] std::string island_of_gateway(peer_id id) const {
    for (const auto& each : all.islands) {
      if (gateway_of(each.id) == id)
        return each.gateway_name;
      for (const auto& alias : each.aliases) {
        if (alias.id == id)
          return alias.name;
      }
    }
    return to_string(id);
  }
  [[nodiscard]] std::string peers(const std::vector<peer_id>& ids) const {
    constexpr std::size_t peers_shown_max = 4;
    if (ids.size() > peers_shown_max)
      return counted(ids.size(), "peer");
    std::vector<std::string> names;
    for (const auto id : ids)
      names.push_back(peer(id));
    return joined(names);
  }
};

/// `8 min`, `every 30 s from 1 min to 5 min`, `3 times`
std::string time_text(const fault_description& x) {
  if (!x.repeated)
    return to_text(x.at);
  const auto& times = *x.repeated;
  return (times.every > 0s
              ? "every " + to_text(times.every)
              : std::to_string(times.count) + (times.count == 1 ? " time" : " times")) +
         (times.from > 0s || times.until ? " from " + to_text(times.from) : "") +
         (times.until ? " to " + to_text(*times.until) : "");
}

} // namespace

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const auto& each : words)
    text += (text.empty() ? std::string() : std::string(between)) + each;
  return text;
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

std::string percent(double ratio) {
  return shown(std::round(ratio * 1e6) / 1e4) + " %"; // 0.07 * 100 is not 7
}

std::string island_names(const ecology_description& x, const std::vector<island_id>& ids) {
  std::vector<std::string> names;
  for (const auto& island : x.islands) {
    if (std::find(ids.begin(), ids.end(), island.id) != ids.end())
      names.push_back(island.name);
  }
  return joined(names);
}

std::string fault_text(const row& x) {
  std::string text;
  for (std::size_t i = 1; i < x.size(); ++i)
    text += (text.empty() ? "" : " ") + x[i];
  return text;
}

std::vector<row> fault_rows(const ecology_description& x) {
  std::vector<row> rows;
  for (const auto& each : x.faults) {
    auto cells = std::visit(fault_cells{x}, each.what);
    cells.insert(cells.begin(), time_text(each));
    rows.push_back(std::move(cells));
  }
  return rows;
}

} // namespace rubicon::config
