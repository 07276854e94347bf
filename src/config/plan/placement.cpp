#include "config/plan/placement.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include "core/overloads.hpp"
#include "device/walk.hpp"

namespace rubicon::config {

namespace {

std::string ticked(const std::string& x) {
  return '`' + x + '`';
}

/// Where everything is that others refer to.
struct places {
  explicit places(const ecology_description& all) {
    for (const auto& island : all.islands) {
      const auto host = host_of(all, island);
      islands[island.id] = host;
      for (const auto id : gateways_of(island))
        peers[id] = host;
      names[island.gateway_name] = host;
      for (const auto& alias : island.aliases)
        names[alias.name] = host;
    }
    for (const auto& peer : all.peers) {
      peers[peer.id] = host_of(all, peer);
      names[peer.name] = host_of(all, peer);
    }
    for (const auto& host : used_hosts(all))
      hosts.push_back(host.name);
  }

  [[nodiscard]] std::vector<std::string> of(const std::vector<peer_id>& all) const {
    std::set<std::string> found;
    for (const auto id : all)
      found.insert(peers.at(id));
    return in_order(found);
  }

  [[nodiscard]] std::vector<std::string> of(peer_id x) const {
    return x == any_peer ? hosts : of(std::vector{x});
  }
  [[nodiscard]] std::vector<std::string> of(island_id x) const {
    return x == any_island ? hosts : std::vector{islands.at(x)};
  }
  [[nodiscard]] std::vector<std::string> of(const mote_address& x) const {
    return x == any_mote ? hosts : of(x.island);
  }

  [[nodiscard]] std::vector<std::string> in_order(const std::set<std::string>& some) const {
    std::vector<std::string> found;
    std::ranges::copy_if(hosts, std::back_inserter(found),
                         [&some](const auto& x) { return some.contains(x); });
    return found;
  }

  std::map<island_id, std::string> islands;
  std::map<peer_id, std::string> peers;
  std::map<std::string, std::string> names; ///< of peers and gateways
  std::vector<std::string> hosts;           ///< that run something
};

std::vector<std::string> hosts_of_change(const places& where, const change& x) {
  return std::visit(overloads{
                        [&](const program_change& y) { return where.of(y.mote); },
                        [&](const link_change& y) { return where.of(y.from); },
                        [&](const auto& /*of all*/) { return where.hosts; },
                    },
                    x);
}

std::vector<std::string> hosts_of(const places& where, const fault& x) {
  return std::visit(
      overloads{
          [&](const partition_fault& y) {
            std::vector<peer_id> all;
            for (const auto& group : y.groups)
              all.insert(all.end(), group.begin(), group.end());
            return where.of(all);
          },
          [&](const link_loss_fault& y) {
            return y.peers.empty() ? where.hosts : where.of(y.peers);
          },
          [&](const radio_loss_fault& y) { return y.island ? where.of(*y.island) : where.hosts; },
          [&](const move_island_fault& y) {
            return where.in_order({where.islands.at(y.mote.island), where.islands.at(y.to)});
          },
          [&](const change& y) { return hosts_of_change(where, y); },
          [&](const noise_fault& y) { return where.of(y.island); },
          [&](const unplug_fault& y) { return where.of(y.island); },
          [&](const sink_crash_fault& y) { return where.of(y.island); },
          [&](const sink_step_fault& y) { return where.of(y.island); },
          [&](const auto& y) {
            if constexpr (requires { y.mote; })
              return where.of(y.mote);
            else
              return where.of(y.peer);
          },
      },
      x);
}

/// Whether it can happen on several hosts, to each of them alone.
bool may_be_divided(const fault& x) {
  const auto* loss = std::get_if<link_loss_fault>(&x);
  return !std::holds_alternative<partition_fault>(x) &&
         !std::holds_alternative<move_island_fault>(x) && (loss == nullptr || loss->peers.empty());
}

std::string listed(const std::vector<std::string>& all) {
  std::string text;
  for (const auto& x : all)
    text += (text.empty() ? "" : ", ") + ticked(x);
  return text;
}

void check_peers(const ecology_description& all, const places& where,
                 std::vector<std::string>& out) {
  std::set<std::string> with_bluetooth;
  std::map<std::pair<std::string, std::uint16_t>, std::string> ports;
  for (const auto& peer : all.peers) {
    const auto& host = where.peers.at(peer.id);
    if (!peer.bluetooth.empty())
      with_bluetooth.insert(host);
    if (peer.tcp && peer.tcp->port)
      ports[{host, *peer.tcp->port}] = peer.name;
  }
  if (with_bluetooth.size() > 1)
    out.push_back("peers with `bluetooth` are on different hosts, " +
                  listed(where.in_order(with_bluetooth)) +
                  ": simulated Bluetooth works within one host only");
  for (const auto& host : used_hosts(all))
    for (const auto port : {host.control_port, host.peis_port})
      if (const auto found = ports.find({host.name, port}); found != ports.end())
        out.push_back("port " + std::to_string(port) + " of host " + ticked(host.name) +
                      " is also that of peer " + ticked(found->second) +
                      ": give one of them another");
}

void check_hosts(const ecology_description& all, std::vector<std::string>& out) {
  std::map<std::pair<std::string, std::uint16_t>, std::string> ports;
  for (const auto& host : used_hosts(all)) {
    if (host.listen.empty())
      out.push_back("host " + ticked(host.name) + " has a name as address, " +
                    ticked(host.address) + ": set `listen` to the IPv4 address of that computer");
    for (const auto port : {host.control_port, host.peis_port}) {
      const auto [first, fresh] = ports.try_emplace({host.address, port}, host.name);
      if (!fresh)
        out.push_back("hosts " + ticked(first->second) + " and " + ticked(host.name) +
                      " both have port " + std::to_string(port) + " of " + host.address +
                      ": give one of them another `control_port` or `peis_port`");
    }
  }
}

void check_faults(const ecology_description& all, const places& where,
                  std::vector<std::string>& out) {
  for (const auto& each : all.faults) {
    const auto hosts = hosts_of(where, each.what);
    if (hosts.size() > 1 && !may_be_divided(each.what))
      out.push_back("the fault at " + to_text(each.at) + " affects several hosts, " +
                    listed(hosts) + ": a fault can affect only one");
  }
}

/// Motes of an island that is here, or of any.
bool is_here(const ecology_description& part, const mote_scope& x) {
  return std::ranges::any_of(part.islands, [&x](const auto& island) {
    return (x.island == island_id{} || x.island == island.id) && !island.motes.empty();
  });
}

/// Whether what is here is all that the expectation watches while it runs. What is found in the
/// report is for who has all reports.
bool is_judged_here(const ecology_description& part, const expectation& x) {
  return std::visit(overloads{
                        [&](const clock_expectation& y) { return is_here(part, y.of); },
                        [&](const joined_expectation& y) { return is_here(part, y.of); },
                        [&](const vectors_expectation& y) {
                          const auto name = y.node.substr(0, y.node.find('/'));
                          const auto has_name = [&](const auto& z) { return z.name == name; };
                          return name == "*" || std::ranges::any_of(part.islands, has_name) ||
                                 std::ranges::any_of(part.peers, has_name);
                        },
                        [](const auto& /*others*/) { return false; },
                    },
                    x);
}

/// PEIS ids of the hosts' own peers: the highest free ones, in the order of the file.
std::vector<peer_id> host_peer_ids(const ecology_description& all, const places& where) {
  std::vector<peer_id> ids;
  for (auto id = peer_id_max; ids.size() < all.hosts.size(); --id)
    if (!where.peers.contains(peer_id(id)))
      ids.emplace_back(id);
  return ids;
}

peer_description host_peer_of(const ecology_description& all, const places& where,
                              const std::string& host) {
  const auto ids = host_peer_ids(all, where);
  const auto number = static_cast<std::size_t>(find_host(all, host) - all.hosts.data());
  const auto& own = all.hosts[number];
  peer_description x;
  x.id = ids[number];
  x.name = where.names.contains(host) ? "host-" + host : host;
  x.host = host;
  x.tcp = tcp_listener{own.peis_port, own.listen, own.networks};
  for (const auto& other : used_hosts(all)) {
    if (other.name == host)
      break; // those behind connect to us
    x.connect.push_back("tcp://" + other.address + ':' + std::to_string(other.peis_port));
  }
  return x;
}

/// Links to peers of other hosts lead to the host's own peer.
void redirect(std::vector<std::string>& links, const places& where, const std::string& host,
              const std::string& to) {
  const auto before = std::exchange(links, {});
  for (const auto& name : before) {
    const auto& end = where.names.at(name) == host ? name : to;
    if (std::ranges::find(links, end) == links.end())
      links.push_back(end);
  }
}

/// Of a mote or a tag.
template <class Moving>
void move_on(Moving& x, duration elapsed) {
  if (x.path.empty())
    return;
  x.place = device::walk(x.path, 1s).at(instant(elapsed));
  for (auto& each : x.path)
    each.at -= elapsed;
}

void let_world_go_on(mote_description& x, duration elapsed) {
  move_on(x, elapsed);
  for (auto& each : x.transducers.edit())
    each.elapsed = elapsed;
}

void let_world_go_on(ecology_description& part, duration elapsed) {
  for (auto& island : part.islands)
    for (auto& mote : island.motes)
      let_world_go_on(mote, elapsed);
  for (auto& tag : part.tags)
    move_on(tag, elapsed);
  for (auto& each : part.faults)
    if (auto* crash = std::get_if<crash_fault>(&each.what); crash != nullptr && crash->becomes)
      let_world_go_on(*crash->becomes, elapsed);
}

} // namespace

std::string host_of(const ecology_description& all, const std::string& host) {
  return host.empty() && !all.hosts.empty() ? all.hosts.front().name : host;
}

std::vector<host_description> used_hosts(const ecology_description& all) {
  std::vector<host_description> found;
  for (const auto& host : all.hosts) {
    const auto is_of = [&](const auto& x) { return host_of(all, x) == host.name; };
    if (std::ranges::any_of(all.islands, is_of) || std::ranges::any_of(all.peers, is_of))
      found.push_back(host);
  }
  return found;
}

const host_description* find_host(const ecology_description& all, std::string_view name) {
  const auto found = std::ranges::find(all.hosts, name, &host_description::name);
  return found == all.hosts.end() ? nullptr : &*found;
}

std::vector<std::string> placement_problems(const ecology_description& all) {
  std::vector<std::string> out;
  const places where(all);
  if (where.hosts.size() < 2)
    return out;
  check_hosts(all, out);
  check_peers(all, where, out);
  check_faults(all, where, out);
  return out;
}

std::vector<std::string> hosts_of(const ecology_description& all, const fault& x) {
  return hosts_of(places(all), x);
}

ecology_description part_of(const ecology_description& all, const std::string& host) {
  auto out = all;
  out.mode = run_mode::wall;
  const places where(all);
  if (where.hosts.size() < 2)
    return out;
  const auto is_elsewhere = [&](const auto& x) { return host_of(all, x) != host; };
  auto& part = out.part.emplace();
  part.host = host;
  std::ranges::copy_if(all.islands, std::back_inserter(part.others), is_elsewhere);
  for (const auto& peer : all.peers)
    if (is_elsewhere(peer))
      part.other_peers[peer.id] = peer.name;
  std::erase_if(out.islands, is_elsewhere);
  std::erase_if(out.peers, is_elsewhere);
  std::erase_if(out.airs,
                [&](const auto& x) { return where.islands.at(x.islands.front()) != host; });
  const auto has_not = [&](const fault_description& x) {
    const auto hosts = hosts_of(where, x.what);
    return std::ranges::find(hosts, host) == hosts.end();
  };
  std::erase_if(out.faults, has_not);
  std::erase_if(out.expectations, [&](const auto& x) { return !is_judged_here(out, x); });
  auto own = host_peer_of(all, where, host);
  for (auto& island : out.islands) {
    redirect(island.gateway_links, where, host, own.name);
    for (auto& alias : island.aliases)
      redirect(alias.links, where, host, own.name);
  }
  for (auto& peer : out.peers)
    redirect(peer.links, where, host, own.name);
  out.peers.push_back(std::move(own));
  std::ranges::sort(out.peers, {}, &peer_description::id);
  return out;
}

const peer_description* host_peer(const ecology_description& part) {
  if (!part.part)
    return nullptr;
  const auto found = std::ranges::find_if(part.peers, [&](const auto& x) {
    return x.host == part.part->host && x.tcp &&
           x.tcp->port == find_host(part, part.part->host)->peis_port;
  });
  return found == part.peers.end() ? nullptr : &*found;
}

/// Times of day count from the start of the run.
void begin_later(proxy::rules_config& x, duration elapsed) {
  for (auto& rule : x.rules)
    if (rule.daily)
      rule.daily = ((*rule.daily - elapsed) % duration(24h) + 24h) % duration(24h);
  for (auto& each : x.clock_changes)
    each.at -= elapsed;
}

void begin_later(ecology_description& part, duration elapsed) {
  for (auto& peer : part.peers)
    for (auto& app : peer.apps)
      if (auto* const rules = std::get_if<proxy::rules_config>(&app))
        begin_later(*rules, elapsed);
  let_world_go_on(part, elapsed);
  part.length -= elapsed;
  part.day_begins = (part.day_begins + elapsed) % duration(24h);
  const auto shift = [elapsed](duration& x) { x = std::max(x - elapsed, duration{}); };
  std::erase_if(part.faults, [&](const auto& x) {
    if (!x.repeated)
      return x.at < elapsed;
    const auto until = x.repeated->until;
    return until && *until < elapsed;
  });
  for (auto& each : part.faults) {
    if (!each.repeated) {
      shift(each.at);
      continue;
    }
    auto& times = *each.repeated;
    if (times.every > 0s && times.from < elapsed) // the next of its times
      times.from += (elapsed - times.from + times.every - duration(1)) / times.every * times.every;
    shift(times.from);
    if (times.until)
      shift(*times.until);
    each.at = times.from;
  }
  sort_plan(part.faults);
}

} // namespace rubicon::config
