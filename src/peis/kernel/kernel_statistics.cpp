#include "peis/kernel/kernel_statistics.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::size_t links_per_line = 5;
constexpr std::size_t list_max = std::size_t{4} << 20U; ///< octets; what is left out: `...`
/// A list that others make long is written no faster than this, in octets a second, nor for each
/// look at it once it is longer than `short_list`.
constexpr std::size_t list_rate = std::size_t{256} << 10U;
constexpr std::size_t short_list = std::size_t{64} << 10U;

/// As printf's %.Nf does, whatever the locale.
std::string fixed(double x, int decimals) {
  std::array<char, 64> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), x, std::chars_format::fixed, decimals);
  return error == std::errc() ? std::string(text.data(), end) : "0";
}

/// Right-aligned, as printf's %Nd.
std::string padded(std::int64_t x, std::size_t width) {
  auto text = std::to_string(x);
  if (text.size() < width)
    text.insert(0, width - text.size(), ' ');
  return text;
}

double per_second(std::uint64_t now, std::uint64_t before, double seconds) {
  return now < before || seconds <= 0 ? 0 : static_cast<double>(now - before) / seconds;
}

std::string neighbour_text(const std::optional<peer_id>& neighbour) {
  return to_string(neighbour.value_or(any_peer));
}

std::string routes_text(const p2p& network) {
  const auto self = network.view().own.config.id;
  std::map<peer_id, std::string> lines;
  const auto add = [&](peer_id host, unsigned hops, peer_id via) {
    lines[host] =
        " (" + padded(host.value, 4) + ' ' + padded(hops, 2) + ' ' + padded(via.value, 4) + ")\n";
  };
  std::map<link_id, peer_id> neighbours;
  for (const auto& x : network.view().links.views())
    neighbours[x.link] = x.neighbour.value_or(any_peer);
  for (const auto& [host, way] : network.view().routes.routes().routes()) {
    const auto at = way.via ? neighbours.find(*way.via) : neighbours.end();
    add(host, way.hops, at == neighbours.end() ? any_peer : at->second);
  }
  add(self, 0, any_peer);
  std::string text = "(\n";
  for (const auto& [host, line] : lines)
    text += line;
  return text + ")\n";
}

std::string subscribers_text(const tuple_space& tuples) {
  std::string text = "(\n";
  for (const auto& [host, wanted] : tuples.audience().subscribers()) {
    if (text.size() > list_max) {
      text += "  ...\n";
      break;
    }
    text += "  ( " + to_string(host) + ' ' + to_string(wanted.owner) + '.' + wanted.name.text() +
            " )\n";
  }
  return text + ")\n";
}

std::string all_keys_text(const tuple_space& tuples, peer_id self) {
  std::string text = "(";
  std::string after;
  static_cast<void>(tuples.stored().walk_on(self, key(), after, [&](const auto& x) {
    const bool room = text.size() <= list_max;
    text += room ? x.content->name.text() + ' ' : "... ";
    return room;
  }));
  if (text.size() > 1)
    text.pop_back();
  return text + ')';
}

} // namespace

kernel_statistics::kernel_statistics(instant now) {
  const std::pair<std::string_view, duration> known[] = {
      {"kernel.step-time", 5s},     {"kernel.traffic", 5s},     {"kernel.connections", 5s},
      {"kernel.routingTable", 10s}, {"kernel.subscribers", 1s}, {"kernel.all-keys", 1s}};
  for (std::size_t i = 0; i < items_.size(); ++i)
    items_[i] = {*key::parse(known[i].first), known[i].second, now, 0, false};
}

void kernel_statistics::follow(const tuple_space& tuples) {
  const auto audience = tuples.audience();
  if (std::exchange(followed_version_, audience.version()) == audience.version())
    return;
  for (auto& x : items_)
    x.watched = audience.is_watched(x.name);
}

/// Zero for those that are computed periodically.
std::uint64_t kernel_statistics::version_of(kind which, const tuple_space& tuples) {
  if (which == kind::subscribers)
    return tuples.audience().version();
  return which == kind::all_keys ? tuples.own_keys_version() : 0;
}

/// Also for those that are not watched.
std::optional<instant> kernel_statistics::due_at(kind which, const tuple_space& tuples) const {
  const auto& x = items_[static_cast<std::size_t>(which)];
  const bool when_changed = which == kind::subscribers || which == kind::all_keys;
  if (when_changed && x.version == version_of(which, tuples))
    return std::nullopt;
  return x.computed + x.period + std::chrono::milliseconds(1000 * x.size / list_rate);
}

kernel_statistics::texts kernel_statistics::initial(const p2p& network, const tuple_space& tuples,
                                                    instant now) {
  texts out;
  for (std::size_t i = 0; i < items_.size(); ++i)
    out.emplace_back(items_[i].name, compute(static_cast<kind>(i), network, tuples, now));
  return out;
}

kernel_statistics::texts kernel_statistics::due(const p2p& network, const tuple_space& tuples,
                                                instant now) {
  texts out;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const auto which = static_cast<kind>(i);
    const auto when = items_[i].watched ? due_at(which, tuples) : std::nullopt;
    if (when && *when <= now)
      out.emplace_back(items_[i].name, compute(which, network, tuples, now));
  }
  return out;
}

kernel_statistics::texts kernel_statistics::stale(const key& pattern, const p2p& network,
                                                  const tuple_space& tuples, instant now) {
  texts out;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const auto which = static_cast<kind>(i);
    const auto when = due_at(which, tuples);
    const bool by_change =
        version_of(which, tuples) != items_[i].version && items_[i].size <= short_list;
    if (!items_[i].watched && when && (by_change || *when <= now) &&
        pattern.matches(items_[i].name))
      out.emplace_back(items_[i].name, compute(which, network, tuples, now));
  }
  return out;
}

std::optional<instant> kernel_statistics::deadline(const tuple_space& tuples) const {
  std::optional<instant> next;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (items_[i].watched)
      next = earliest(next, due_at(static_cast<kind>(i), tuples));
  }
  return next;
}

std::string kernel_statistics::compute(kind which, const p2p& network, const tuple_space& tuples,
                                       instant now) {
  auto& x = items_[static_cast<std::size_t>(which)];
  const auto seconds = std::chrono::duration<double>(now - x.computed).count();
  x.computed = now;
  x.version = version_of(which, tuples);
  auto text = text_of(which, network, tuples, seconds);
  x.size = text.size();
  return text;
}

std::string kernel_statistics::text_of(kind which, const p2p& network, const tuple_space& tuples,
                                       double seconds) {
  switch (which) {
  case kind::step_time:
    return fixed(step_seconds_, 4);
  case kind::traffic:
    return traffic(network, seconds);
  case kind::connections:
    return connections(network, seconds);
  case kind::routes:
    return routes_text(network);
  case kind::subscribers:
    return subscribers_text(tuples);
  case kind::all_keys:
    return all_keys_text(tuples, network.view().own.config.id);
  }
  return {};
}

/// Octets in 5 s, halved, as real kernels show them.
std::string kernel_statistics::traffic(const p2p& network, double seconds) {
  const auto& counted = network.view().own.counters;
  const auto shown = [&](std::uint64_t now, std::uint64_t before) {
    return fixed(per_second(now, before, seconds) * 2.5, 1);
  };
  auto text = '(' + shown(counted.octets_received, traffic_before_.in) + ' ' +
              shown(counted.octets_sent, traffic_before_.out) + ')';
  traffic_before_ = {counted.octets_received, counted.octets_sent};
  return text;
}

std::string kernel_statistics::connections(const p2p& network, double seconds) {
  std::map<link_id, octets> counted;
  std::string text = "(";
  std::size_t shown = 0;
  const auto rate = [&](std::uint64_t now, std::uint64_t before) {
    return std::to_string(static_cast<std::uint64_t>(per_second(now, before, seconds)));
  };
  for (const auto& x : network.view().links.views()) {
    const auto before = links_before_[x.link];
    counted[x.link] = {x.octets_in, x.octets_out};
    text += '(' + neighbour_text(x.neighbour) + ' ' + rate(x.octets_in, before.in) + ' ' +
            rate(x.octets_out, before.out) + " 0 " + fixed(x.loss, 2) + ')';
    text += ++shown % links_per_line == 0 ? "\n" : "";
  }
  links_before_ = std::move(counted);
  return text + ')';
}

} // namespace rubicon::peis
