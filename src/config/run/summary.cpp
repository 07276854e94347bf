#include "config/run/summary.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "bridge/mqtt/mqtt_settings.hpp"
#include "bridge/ros2/ros2_settings.hpp"
#include "config/summary_parts.hpp"
#include "config/toml/document.hpp"
#include "core/text/printable.hpp"
#include "radio/medium/noise.hpp"
#include "radio/medium/tossim_files.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t rows_max = 20; ///< of one section: the whole stays on a screen

/// A heading and its rows in columns; nothing without rows.
std::string section(const std::string& heading, std::vector<row> rows) {
  if (rows.empty())
    return {};
  const auto left_out = rows.size() - std::min(rows.size(), rows_max);
  rows.resize(rows.size() - left_out);
  std::vector<std::size_t> widths;
  for (auto& cells : rows) {
    for (auto& cell : cells)
      cell = printable(cell);
    widths.resize(std::max(widths.size(), cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i)
      widths[i] = std::max(widths[i], cells[i].size());
  }
  auto text = '\n' + heading + '\n';
  for (const auto& cells : rows) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i)
      line += "  " + cells[i] + std::string(widths[i] - cells[i].size(), ' ');
    text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  }
  return left_out == 0 ? text : text + "  ... and " + std::to_string(left_out) + " more\n";
}

std::string kind_of(const mote_description& x) {
  if (x.type_name.empty())
    return x.type == 0 ? "untyped" : "type " + std::to_string(x.type);
  return x.type_name;
}

/// `4 climate, 1 fan`, in order of the first mote of each.
std::string motes_by_type(const std::vector<mote_description>& motes) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const auto& mote : motes) {
    const auto kind = kind_of(mote);
    const auto found = std::find_if(counts.begin(), counts.end(),
                                    [&kind](const auto& x) { return x.first == kind; });
    if (found == counts.end())
      counts.emplace_back(kind, 1);
    else
      ++found->second;
  }
  std::vector<std::string> words;
  for (const auto& [kind, count] : counts)
    words.push_back(std::to_string(count) + ' ' + kind);
  return joined(words);
}

std::string arrow(const std::vector<std::string>& links) {
  return links.empty() ? "" : "-> " + joined(links);
}

/// `-> pc, tcp://10.0.0.7:8000; leaf`: whom a peer has links to, and what is unusual about it.
std::string connections(const peer_description& x) {
  auto ends = x.links;
  ends.insert(ends.end(), x.connect.begin(), x.connect.end());
  std::vector<std::string> words;
  if (!ends.empty())
    words.push_back(arrow(ends));
  if (x.tcp)
    words.push_back("tcp " +
                    (x.tcp->port ? std::to_string(*x.tcp->port) : std::string("8000 or above")));
  if (x.lan)
    words.emplace_back("lan");
  if (x.udp)
    words.emplace_back("udp");
  if (!x.bluetooth.empty())
    words.push_back("bluetooth " + joined(x.bluetooth));
  if (!x.adapter.empty())
    words.push_back("real bluetooth " + x.adapter);
  if (!x.wired)
    words.emplace_back("not wired");
  if (x.leaf)
    words.emplace_back("leaf");
  if (!x.manager)
    words.emplace_back("no manager");
  if (x.wired && x.discovery != ends.empty())
    words.emplace_back(x.discovery ? "discovery" : "no discovery");
  if (x.time_master)
    words.emplace_back("time master");
  return joined(words, "; ");
}

std::string placed(const std::string& host) {
  return host.empty() ? "" : "on " + host;
}

std::string sink_text(const island_description& x) {
  const auto baud = ", " + std::to_string(x.serial.baud) + " baud";
  const auto& outside = x.outside;
  if (!outside.device.empty())
    return "real sink at " + outside.device + baud;
  if (!outside.forwarder.empty())
    return "real sink behind serial forwarder " + outside.forwarder;
  if (!outside.replay.empty())
    return "sink replayed from " + outside.replay;
  return "sink " + to_string(x.sink.id) + ", " + std::string(x.sink.platform->name) +
         (x.stack == stack::mac     ? ", mac only"
          : x.stack == stack::plain ? ", base station" + baud
                                    : baud) +
         (x.channel == radio::default_channel ? "" : ", channel " + std::to_string(x.channel)) +
         (outside.has_gateway() ? " at pty " + outside.pty : "");
}

/// `; real motes 100 to 199 at /dev/ttyUSB0`
std::string real_text(const real_line_description& x) {
  if (!x.is_there())
    return {};
  const auto& outside = x.outside;
  const auto where = !outside.device.empty()      ? "at " + outside.device
                     : !outside.forwarder.empty() ? "behind serial forwarder " + outside.forwarder
                                                  : "replayed from " + outside.replay;
  return "; real motes " + std::to_string(x.motes.first) + " to " + std::to_string(x.motes.last) +
         ' ' + where;
}

std::vector<row> island_rows(const ecology_description& x) {
  std::vector<row> rows;
  for (const auto& each : x.islands) {
    const auto kinds = motes_by_type(each.motes);
    rows.push_back(
        {to_string(each.id), each.name,
         counted(each.motes.size(), "mote") + (kinds.empty() ? "" : ": " + kinds),
         sink_text(each) +
             (each.aliases.empty() ? "" : ", " + counted(each.aliases.size() + 1, "gateway")) +
             real_text(each.real),
         placed(each.host)});
  }
  return rows;
}

std::vector<row> air_rows(const ecology_description& x) {
  std::vector<row> rows;
  for (const auto& air : x.airs) {
    std::vector<std::string> names;
    for (const auto& island : x.islands) {
      if (std::find(air.islands.begin(), air.islands.end(), island.id) != air.islands.end())
        names.push_back(island.name);
    }
    if (names.size() > 1)
      rows.push_back({air.name, joined(names)});
  }
  return rows;
}

struct app_text {
  const ecology_description& all;

  std::string operator()(const proxy_manager_app& x) const {
    std::vector<std::string> whose;
    if (!x.islands.empty())
      whose.push_back(island_names(all, x.islands));
    if (x.objects)
      whose.emplace_back("tagged objects");
    return "proxy manager (" + joined(whose) + ')';
  }
  std::string operator()(const proxy::rules_config& x) const {
    return counted(x.rules.size(), "rule");
  }
  std::string operator()(const collector_app& x) const {
    constexpr std::size_t keys_shown_max = 3;
    return "collector (" +
           (x.keys.size() > keys_shown_max ? counted(x.keys.size(), "key") : joined(x.keys)) + ')';
  }
  std::string operator()(const rfid::reader_config& x) const { return "reader " + x.name; }
  std::string operator()(const goal::pursuer_config& x) const {
    return x.name + " (" + counted(x.goals.size(), "goal") + ')';
  }
  std::string operator()(const apps::app_config& x) const { return std::string(kind_of(x)); }
  std::string operator()(const translate_app& x) const {
    return "translate (" + counted(x.rules.size(), "rule") + ')';
  }
  std::string operator()(const mqtt_app& x) const {
    return "MQTT bridge (" +
           (all.mode == run_mode::wall ? x.settings->broker.address : "simulated broker") + ')';
  }
  std::string operator()(const ros2_app& x) const {
    return "ROS 2 bridge (" +
           (all.mode == run_mode::wall ? x.settings->server : "simulated rosbridge") + ')';
  }
  std::string operator()(const init_app& x) const {
    std::vector<std::string> names;
    for (const auto& each : x.components)
      names.push_back(each.name);
    return names.empty() ? "init" : "init (" + joined(names) + ')';
  }
};

/// Peers and gateways: every PEIS kernel, ascending by id.
std::vector<row> peer_rows(const ecology_description& x) {
  std::vector<std::pair<std::int64_t, row>> found;
  for (const auto& each : x.islands) {
    if (!has_line(each.stack) || each.outside.has_gateway())
      continue;
    std::vector<std::string> apps{"gateway of " + each.name};
    for (const auto& app : each.gateway_apps)
      apps.emplace_back(kind_of(app));
    found.push_back({each.id.value,
                     {to_string(each.id), each.gateway_name, arrow(each.gateway_links),
                      placed(each.host), joined(apps)}});
    for (const auto& alias : each.aliases)
      found.push_back({alias.id.value,
                       {to_string(alias.id), alias.name, arrow(alias.links), placed(each.host),
                        "alias gateway of " + each.name}});
  }
  for (const auto& each : x.peers) {
    std::vector<std::string> apps;
    for (const auto& app : each.apps)
      apps.push_back(std::visit(app_text{x}, app));
    found.push_back(
        {each.id.value,
         {to_string(each.id), each.name, connections(each), placed(each.host), joined(apps)}});
  }
  std::sort(found.begin(), found.end());
  std::vector<row> rows;
  for (auto& [id, cells] : found)
    rows.push_back(std::move(cells));
  return rows;
}

std::vector<row> proxy_rows(const ecology_description& x) {
  std::vector<row> rows;
  for (const auto& each : x.proxies) {
    std::vector<std::string> claimed;
    for (const auto& [first, last, mask] : each.types)
      claimed.push_back(std::to_string(first) + (mask != 0       ? '/' + std::to_string(mask)
                                                 : first == last ? ""
                                                                 : ".." + std::to_string(last)));
    for (const auto& [channel, prefix] : each.ids)
      claimed.push_back(channel + '/' + prefix + '*');
    std::vector<std::string> names;
    for (const auto& field : each.fields)
      names.push_back(field.name);
    for (const auto& input : each.inputs)
      names.push_back(input.name + " (input)");
    rows.push_back({each.name, (each.ids.empty() ? "types " : "ids ") + joined(claimed),
                    each.prefix, joined(names)});
  }
  return rows;
}

std::vector<row> tag_rows(const ecology_description& x) {
  std::vector<row> rows;
  for (const auto& each : x.tags)
    rows.push_back({each.id, counted(each.memory.size(), "octet"),
                    each.path.empty() ? "stays" : "is carried"});
  return rows;
}

std::vector<row> host_rows(const ecology_description& x) {
  std::vector<row> rows;
  for (const auto& each : x.hosts)
    rows.push_back({each.name, each.address, "PEIS port " + std::to_string(each.peis_port)});
  return rows;
}

struct propagation_text {
  std::string operator()(const radio::unit_disk& x) const {
    return "unit disk of " + shown(x.range_m) + " m";
  }
  std::string operator()(const radio::log_distance& x) const {
    auto text =
        "log distance, exponent " + shown(x.exponent) + ", " + shown(x.reference_db) + " dB at 1 m";
    if (x.shadowing_db > 0)
      text += ", shadowing " + shown(x.shadowing_db) + " dB";
    if (x.asymmetry_db > 0)
      text += ", asymmetry " + shown(x.asymmetry_db) + " dB";
    return text;
  }
  std::string operator()(const radio::friis& x) const {
    return "free space at " + shown(x.frequency_mhz) + " MHz";
  }
  std::string operator()(const radio::gain_matrix& x) const {
    return counted(x.table->gains.size(), "gain") + " of a topology, node 0 is mote " +
           std::to_string(x.first_mote);
  }
};

struct noise_text {
  std::string operator()(const radio::no_noise&) const { return "no noise"; }
  std::string operator()(const radio::constant_noise& x) const {
    return "noise of " + shown(x.floor_dbm) + " dBm";
  }
  std::string operator()(const radio::table_noise&) const { return "noise of the topology"; }
  std::string operator()(const radio::traced_noise& x) const {
    return "noise like " + counted(x.trace->readings().size(), "reading");
  }
};

std::string limit(const char* name, const std::optional<double>& dbm) {
  return dbm ? std::string(", ") + name + ' ' + shown(*dbm) + " dBm" : "";
}

std::string radio_line(const radio::channel_config& x) {
  auto text = "radio: " + std::visit(propagation_text{}, x.propagation) + "; " +
              std::visit(noise_text{}, x.noise) + "; collisions " +
              (x.collisions == radio::collision_rule::strict ? "strict" : "by SINR");
  if (x.capture)
    text += ", capture";
  if (x.curve == radio::error_curve::tossim)
    text += ", TOSSIM's curve";
  text += limit("sensitivity", x.sensitivity_dbm);
  if (x.edge == radio::sensitivity_edge::noise)
    text += ", fading out below the sensitivity";
  text += "; loss " + percent(x.loss);
  if (!x.links.empty())
    text += "; " + counted(x.links.size(), "link") + " as listed";
  return text + '\n';
}

/// Names of the platforms in use, in the order of radio::platforms().
std::vector<std::string_view> platforms_of(const ecology_description& x) {
  std::vector<std::string_view> names;
  for (const auto& platform : radio::platforms()) {
    const auto is_it = [&platform](const auto& radio) { return radio.platform == &platform; };
    if (std::any_of(x.islands.begin(), x.islands.end(), [&](const auto& island) {
          return is_it(island.sink) || std::any_of(island.motes.begin(), island.motes.end(), is_it);
        }))
      names.push_back(platform.name);
  }
  return names;
}

std::string mac_line(const ecology_description& x) {
  constexpr const char* senses[] = {"energy", "carrier", "energy or carrier"};
  std::vector<std::string> macs;
  for (const auto name : platforms_of(x)) {
    const auto found = std::find_if(x.radio.macs.begin(), x.radio.macs.end(),
                                    [name](const auto& each) { return each.first == name; });
    macs.push_back(std::string(name) + ' ' +
                   (found == x.radio.macs.end() ? "standard" : found->second));
  }
  if (macs.empty())
    return {};
  return "mac: " + joined(macs) + "; senses " + senses[static_cast<std::size_t>(x.radio.sensing)] +
         (x.radio.window == radio::sensing_window::end ? " at the end" : "") +
         limit("threshold", x.radio.cca_dbm) +
         (x.radio.retries_max ? "; " + std::to_string(*x.radio.retries_max) +
                                    (*x.radio.retries_max == 1 ? " retry" : " retries")
                              : std::string()) +
         "; queue of " + std::to_string(x.radio.queue) + '\n';
}

/// Measuring apps by kind.
struct flow_counts {
  std::size_t senders[3] = {}; ///< by traffic::arrivals
  std::size_t relays = 0;
  std::size_t receivers = 0;

  void operator()(const traffic::sender_config& x) {
    ++senders[static_cast<std::size_t>(x.pattern)];
  }
  void operator()(const traffic::relay_config&) { ++relays; }
  void operator()(const traffic::receiver_config&) { ++receivers; }
  template <class App>
  void operator()(const App&) {}
};

std::string flows_line(const ecology_description& x) {
  constexpr const char* patterns[] = {" periodic", " Poisson", " saturated"};
  flow_counts counts;
  const auto count = [&counts](const auto& apps) {
    for (const auto& each : apps)
      std::visit(counts, each);
  };
  for (const auto& island : x.islands) {
    count(island.sink.apps);
    for (const auto& mote : island.motes)
      count(mote.apps);
  }
  std::vector<std::string> kinds;
  std::size_t senders = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    senders += counts.senders[i];
    if (counts.senders[i] > 0)
      kinds.push_back(std::to_string(counts.senders[i]) + patterns[i]);
  }
  if (senders + counts.relays + counts.receivers == 0)
    return {};
  return "flows: " + counted(senders, "sender") +
         (kinds.empty() ? "" : " (" + joined(kinds) + ')') + ", " +
         counted(counts.relays, "relay") + ", " + counted(counts.receivers, "receiver") + '\n';
}

/// Bluetooth, if any peer has it.
std::string bluetooth_line(const ecology_description& x) {
  const auto& given = x.peis.bluetooth;
  if (std::all_of(x.peers.begin(), x.peers.end(),
                  [](const auto& each) { return each.bluetooth.empty(); }))
    return {};
  return "bluetooth: range " + shown(given.range_m) + " m; " +
         (given.rate_bps == 0 ? std::string("no limit")
                              : shown(static_cast<double>(given.rate_bps) / 1e3) + " kbit/s") +
         "; scan every " + to_text(given.scan_period) + "; links from " +
         shown(given.threshold_dbm) + " dBm" + (given.takeover ? "; takeover" : "") +
         (x.bluetooth_devices.empty()
              ? ""
              : "; " + counted(x.bluetooth_devices.size(), "other device")) +
         '\n';
}

/// The network between the hosts of peers, where it is unlike a plain LAN.
std::string peis_line(const peis_description& x) {
  const peis_description plain;
  if (x.delay == plain.delay && x.loss == plain.loss && x.bandwidth_bps == plain.bandwidth_bps)
    return {};
  return "peers: delay " + to_text(x.delay) + "; loss " + percent(x.loss) +
         (x.bandwidth_bps == 0
              ? std::string()
              : "; " + shown(static_cast<double>(x.bandwidth_bps) / 1e6) + " Mbit/s") +
         '\n';
}

std::string first_lines(const ecology_description& x) {
  std::size_t motes = 0;
  for (const auto& island : x.islands)
    motes += island.motes.size();
  return printable(x.name) + ": " +
         (x.until == run_end::first_flat_battery ? "until the first flat battery, at most " : "") +
         to_text(x.length) + " of " + (x.mode == run_mode::wall ? "wall time" : "virtual time") +
         ", seed " + std::to_string(x.seed) + ", network " + printable(x.network) + '\n' +
         counted(x.islands.size(), "island") + ", " + counted(motes, "mote") + ", " +
         counted(x.peers.size(), "peer") + '\n' +
         (x.islands.empty() ? "" : radio_line(x.radio) + mac_line(x) + flows_line(x)) +
         peis_line(x.peis) + bluetooth_line(x);
}

} // namespace

std::string summary(const ecology_description& x) {
  return first_lines(x) + section("islands", island_rows(x)) + section("shared airs", air_rows(x)) +
         section("peers and gateways", peer_rows(x)) + section("hosts", host_rows(x)) +
         section("proxies", proxy_rows(x)) + section("tags", tag_rows(x)) +
         section("faults", fault_rows(x));
}

} // namespace rubicon::config
