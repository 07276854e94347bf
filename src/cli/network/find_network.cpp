#include "cli/network/find_network.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "cli/run/running_note.hpp"
#include "config/summary_parts.hpp"
#include "io/process/machine.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/link_url.hpp"

namespace rubicon::cli {

namespace {

using steady = std::chrono::steady_clock;

constexpr std::size_t urls_tried_max = 16; ///< tried of one network that announces itself
constexpr std::size_t networks_max = 64;

/// Where networks are said to be, by their names.
using places = std::map<std::string, std::vector<std::string>>;

void add(places& to, const std::string& network, const std::string& url) {
  if (to.size() >= networks_max && !to.contains(network))
    return;
  auto& urls = to[network];
  if (urls.size() < urls_tried_max && std::ranges::find(urls, url) == urls.end())
    urls.push_back(url);
}

std::optional<joined_network> attempt(io::loop& where, network_options with, const std::string& url,
                                      const search_area& area) {
  with.peer = url;
  with.timeout = std::min(with.timeout, area.try_max);
  auto joined = temporary_peer::join(where, with);
  if (auto* self = std::get_if<std::unique_ptr<temporary_peer>>(&joined))
    return joined_network{std::move(with), std::move(*self)};
  return std::nullopt;
}

/// @returns the first that can be joined, with the timeout of `options`
std::optional<joined_network> first_of(io::loop& where, const network_options& options,
                                       const std::string& network,
                                       const std::vector<std::string>& urls,
                                       const search_area& area) {
  auto with = options;
  with.network = network;
  for (const auto& url : urls)
    if (auto joined = attempt(where, with, url, area)) {
      joined->with.timeout = options.timeout;
      return joined;
    }
  return std::nullopt;
}

std::vector<std::string> default_urls(const search_area& area) {
  std::vector<std::string> urls;
  for (std::uint16_t i = 0; i < area.ports; ++i)
    urls.push_back("tcp://127.0.0.1:" + std::to_string(area.first_port + i));
  return urls;
}

/// Whose announcements come, until nothing new may.
places announced(io::loop& where, const network_options& options, const search_area& area) {
  places found;
  auto group = io::udp_group::join(where, area.group, [&](byte_view datagram, const ipv4_address&) {
    const auto news = peis::decode_announcement(datagram);
    if (!news || (options.network_given && news->network != options.network))
      return;
    const bool is_here = news->sender.host_name == io::machine_name();
    for (const auto& address : news->sender.addresses)
      if (address.type == peis::low_level_address::kind::tcp_ipv4 && (is_here || !address.loopback))
        add(found, news->network, to_string(peis::url_of(address)));
  });
  if (std::holds_alternative<std::string>(group) ||
      !std::get<io::udp_group>(group).trouble().empty())
    return found;                           // this computer has no such network
  constexpr duration others_within = 300ms; // of a second network
  auto end = steady::now() + area.listen_for;
  while (steady::now() < end) {
    const bool was_empty = found.empty();
    where.wait_until(end);
    if (was_empty && !found.empty())
      end = std::min(end, steady::now() + others_within);
  }
  return found;
}

/// `several networks are there: home, lab; say which with --network NAME`
std::string several(const std::set<std::string>& names) {
  return "there are several networks: " +
         config::joined(std::vector<std::string>(names.begin(), names.end()), ", ") +
         "; choose one with --network NAME";
}

std::set<std::string> names_of(const places& x) {
  std::set<std::string> names;
  for (const auto& [network, urls] : x)
    names.insert(network);
  return names;
}

void add(places& to, const network_options& options, const std::vector<running_ecology>& runs) {
  for (const auto& run : runs) {
    if (options.network_given && run.network != options.network)
      continue;
    to[run.network]; // also if its peers chose their ports
    for (const auto& url : run.urls)
      add(to, run.network, url);
  }
}

places places_of(const network_options& options, const std::vector<running_ecology>& runs) {
  places found;
  add(found, options, runs);
  return found;
}

/// At the place that is given; of the networks that this user runs or has deployed, if no name is
/// given and the default is not that of the peer there.
std::variant<joined_network, std::string> join_there(io::loop& where, network_options options,
                                                     const search_area& area) {
  auto joined = temporary_peer::join(where, options);
  if (auto* self = std::get_if<std::unique_ptr<temporary_peer>>(&joined))
    return joined_network{std::move(options), std::move(*self)};
  auto why = std::get<std::string>(std::move(joined));
  if (why.ends_with("Connection refused"))
    return why +
           "; nobody listens there: a peer accepts links in wall time if its file has tcp = true";
  if (options.network_given || why.find(other_network) == std::string::npos)
    return why;
  places known;
  add(known, options, running_ecologies());
  add(known, options, deployed_ecologies());
  for (const auto& [network, urls] : known)
    if (auto found = first_of(where, options, network, {options.peer}, area))
      return *std::move(found);
  return why;
}

std::string nobody(const network_options& options, const search_area& area) {
  const auto last = area.first_port + area.ports - 1;
  return "found no running ecology" +
         (options.network_given ? " of the network `" + options.network + '`' : std::string()) +
         ": no run on this computer accepts links, no peer answered at 127.0.0.1, ports " +
         std::to_string(area.first_port) + " to " + std::to_string(last) +
         ", and no peer announced itself; a peer accepts links in wall time if its file has tcp = "
         "true; give its address with --connect HOST:PORT" +
         (options.lan ? "" : ", or search the local network with --lan");
}

} // namespace

std::variant<joined_network, std::string> join_network(io::loop& where, network_options options,
                                                       search_area area) {
  if (!options.peer.empty())
    return join_there(where, std::move(options), area);
  if (options.lan)
    area.group.interfaces.clear();
  auto noted = places_of(options, running_ecologies());
  if (noted.size() > 1)
    return several(names_of(noted));
  if (noted.empty()) { // notes of deployments may be of earlier ones: what answers counts
    for (const auto& [network, urls] : places_of(options, deployed_ecologies()))
      if (auto joined = first_of(where, options, network, urls, area))
        return *std::move(joined);
    noted[options.network];
  }
  for (const auto& [network, urls] : noted) {
    if (auto joined = first_of(where, options, network, urls, area))
      return *std::move(joined);
    if (auto joined = first_of(where, options, network, default_urls(area), area))
      return *std::move(joined);
  }
  const auto found = announced(where, options, area);
  if (found.size() > 1)
    return several(names_of(found));
  for (const auto& [network, urls] : found)
    if (auto joined = first_of(where, options, network, urls, area))
      return *std::move(joined);
  if (!found.empty())
    return "a peer of the network `" + found.begin()->first + "` announced itself at " +
           config::joined(found.begin()->second, ", ") + ", but does not answer there";
  return nobody(options, area);
}

} // namespace rubicon::cli
