#include "peis/overlay/connection_manager.hpp"

#include <algorithm>

#include "peis/link/link.hpp"
#include "peis/wire/link_url.hpp"

namespace rubicon::peis {

namespace {

constexpr int value_per_metric = 100; // D1.1 3.1.6.4
constexpr std::uint64_t random_values = 100;

using kind = low_level_address::kind;

bool is_network(const low_level_address& x) {
  return x.type == kind::tcp_ipv4 && !x.loopback;
}

bool has_udp(const host_record& x) {
  return std::any_of(x.addresses.begin(), x.addresses.end(),
                     [](const auto& each) { return each.type == kind::udp_ipv4; });
}

bool same_process(const host_record& self, const low_level_address& x) {
  return std::any_of(self.addresses.begin(), self.addresses.end(), [&](const auto& own) {
    return own.type == kind::inproc &&
           std::equal(own.address.begin(), own.address.begin() + 4, x.address.begin());
  });
}

} // namespace

int value_of(const host_option& x, const connection_config& config, random_stream& rng) {
  const auto gain = static_cast<int>(x.metric) - static_cast<int>(x.direct);
  const auto crowd = static_cast<int>(std::max(x.connections, config.links_min) - config.links_min);
  return value_per_metric * (gain - crowd) + static_cast<int>(rng.below(random_values));
}

int value_of(const link_option& x) {
  return value_per_metric * static_cast<int>(*x.loss);
}

std::optional<link_option> worst_of(std::span<const link_option> links) {
  std::optional<link_option> worst;
  for (const auto& x : links) {
    if (!x.loss)
      continue;
    const bool missed_less = worst && *x.loss == *worst->loss && x.connections > worst->connections;
    if (!worst || *x.loss < *worst->loss || missed_less)
      worst = x;
  }
  return worst;
}

link_decision decide(std::span<const link_option> links, std::span<const host_option> hosts,
                     const connection_config& config, random_stream& rng) {
  const auto worst = worst_of(links);
  if (links.size() > config.links_suitable) {
    if (worst)
      return close_worst{worst->link};
    return {};
  }
  if (links.size() == config.links_suitable)
    return {};
  std::optional<peer_id> best;
  int best_value = 0;
  const bool lacks_links = links.size() < config.links_min;
  for (const auto& x : hosts) {
    if (!lacks_links && x.connections >= config.links_suitable)
      continue; // it would close another for ours, whose far end would look for one (CM-01)
    const auto value = value_of(x, config, rng);
    if (!best || value > best_value) {
      best = x.host;
      best_value = value;
    }
  }
  const bool wanted = lacks_links || (worst && best_value > value_of(*worst));
  if (best && wanted)
    return open_link_to{*best};
  return {};
}

admission admit(std::uint32_t request_flags, std::span<const link_option> links,
                const connection_config& config) {
  if ((request_flags & connect_request::for_merge) != 0)
    return admission::accept;
  if ((request_flags & connect_request::for_bandwidth) != 0 && links.size() >= config.links_ceiling)
    return worst_of(links) ? admission::replace_worst : admission::refuse;
  if ((request_flags & connect_request::for_bandwidth) == 0 &&
      links.size() >= config.links_suitable + config.links_min)
    return admission::refuse;
  return admission::accept;
}

std::vector<std::string> connectable_urls(const host_record& self, const host_record& other,
                                          const bluetooth& near) {
  const bool same_host = self.host_name == other.host_name;
  const bool networked = std::any_of(self.addresses.begin(), self.addresses.end(), is_network);
  const bool over_udp = has_udp(self);
  std::vector<std::string> urls;
  for (const auto& x : other.addresses) {
    const bool ip = x.type == kind::tcp_ipv4 || (x.type == kind::udp_ipv4 && over_udp);
    const bool local = ip && x.loopback && same_host;
    const bool remote = ip && !x.loopback && networked && !same_host;
    if (local || remote || (x.type == kind::inproc && same_process(self, x)))
      urls.push_back(to_string(url_of(x)));
  }
  if (!urls.empty())
    return urls;
  for (const auto& x : other.addresses) {
    if (x.type == kind::bluetooth && near.is_connectable(bluetooth_address_of(x)))
      urls.push_back(to_string(url_of(x)));
  }
  return urls;
}

} // namespace rubicon::peis
