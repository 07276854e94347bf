#include "peis/media/simulated_bluetooth.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/hash.hpp"
#include "core/numbers/math.hpp"

namespace rubicon::peis {

namespace {

double distance_m(position a, position b) {
  return math::length(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

} // namespace

bluetooth_address address_of_adapter(const std::string& machine, const std::string& adapter) {
  auto bits = fold64().add(machine).add(adapter).value();
  bluetooth_address x;
  for (auto& octet : x.octets) {
    octet = static_cast<std::uint8_t>(bits);
    bits >>= 8;
  }
  x.octets[0] = 0x02; // administered locally, no group
  return x;
}

std::uint16_t bluetooth_port(std::size_t n) {
  constexpr std::size_t first = 0x2001; // hello_port is not among them
  constexpr std::size_t odd_octets = 128;
  return static_cast<std::uint16_t>(first + n % odd_octets * 2 + n / odd_octets * 0x200);
}

/// Both on, and near enough.
bool simulated_bluetooth::hear(const adapter& a, const adapter& b) const {
  return a.dark.empty() && b.dark.empty() && distance_m(a.place, b.place) <= medium_.range_m;
}

/// In whole dBm, as adapters report it.
int simulated_bluetooth::strength_dbm(const adapter& a, const adapter& b) const {
  const auto metres = std::max(distance_m(a.place, b.place), 1.0);
  const auto loss_db = medium_.reference_db + 10 * medium_.exponent * math::log10(metres);
  return static_cast<int>(std::lround(-loss_db));
}

/// Links whose ends are out of range, or one of which has ended, are closed.
simulated_bluetooth::outputs simulated_bluetooth::settle_links() {
  outputs out;
  std::erase_if(links_, [&](const auto& entry) {
    const auto& [number, x] = entry;
    const bool both = stations_.contains(x.initiator) && stations_.contains(x.acceptor);
    if (both && hear(adapters_.at(x.from), adapters_.at(x.to)))
      return false;
    for (const auto end : {x.initiator, x.acceptor}) {
      if (stations_.contains(end))
        out.emplace_back(link_reset{end, number});
    }
    return true;
  });
  return out;
}

void simulated_bluetooth::add_device(const bluetooth_address& address, position place) {
  adapters_[address].place = place;
}

void simulated_bluetooth::join(station_id station, const std::string& machine,
                               const std::vector<std::string>& adapters, position place,
                               std::uint16_t port) {
  process joined{{}, port};
  for (const auto& name : adapters) {
    const auto address = address_of_adapter(machine, name);
    joined.adapters[name] = address;
    auto& opened = adapters_[address];
    if (opened.machine.empty()) {
      opened.machine = machine;
      opened.place = place;
    }
    opened.stations.push_back(station);
    if (!opened.announcer)
      opened.announcer = station;
  }
  stations_[station] = std::move(joined);
}

simulated_bluetooth::outputs simulated_bluetooth::end(station_id station) {
  const auto gone = stations_.find(station);
  if (gone == stations_.end())
    return {};
  for (const auto& [name, address] : gone->second.adapters) {
    auto& opened = adapters_.at(address);
    std::erase(opened.stations, station);
    if (opened.announcer != station)
      continue;
    opened.announcer.reset();
    if (medium_.takeover && !opened.stations.empty())
      opened.announcer = opened.stations.front();
  }
  stations_.erase(gone);
  return settle_links();
}

/// The station's adapter of that name; nullptr if it has none.
const simulated_bluetooth::adapter* simulated_bluetooth::adapter_of(station_id station,
                                                                    const std::string& name) const {
  const auto from = stations_.find(station);
  if (from == stations_.end())
    return nullptr;
  const auto found = from->second.adapters.find(name);
  return found == from->second.adapters.end() ? nullptr : &adapters_.at(found->second);
}

simulated_bluetooth::outputs simulated_bluetooth::scan(station_id station,
                                                       const std::string& name) const {
  const auto* from = adapter_of(station, name);
  if (from == nullptr)
    return {};
  devices_seen seen{station, name, {}};
  for (const auto& [address, other] : adapters_) {
    if (&other != from && hear(*from, other))
      seen.devices.push_back({address, strength_dbm(*from, other)});
  }
  return {std::move(seen)};
}

/// An adapter in the range of another, with a station that announces; nullptr if it is not so.
const simulated_bluetooth::adapter*
simulated_bluetooth::announced(const adapter& from, const bluetooth_address& address) const {
  const auto to = adapters_.find(address);
  const bool answers = to != adapters_.end() && to->second.announcer && hear(from, to->second);
  return answers ? &to->second : nullptr;
}

simulated_bluetooth::outputs simulated_bluetooth::hello(station_id station,
                                                        const say_hello& question) const {
  const auto* from = adapter_of(station, question.adapter);
  if (from == nullptr)
    return {};
  const auto* to = announced(*from, question.to);
  if (to == nullptr)
    return {hello_unheard{station, question}};
  outputs out;
  for (const auto each : to->stations)
    out.emplace_back(hello_heard{each, station, question});
  return out;
}

/// Who takes links at a port of an adapter.
std::optional<station_id> simulated_bluetooth::listener(const adapter& at,
                                                        std::uint16_t port) const {
  const auto found = std::ranges::find_if(
      at.stations, [&](station_id each) { return stations_.at(each).port == port; });
  return found == at.stations.end() ? std::nullopt : std::optional(*found);
}

simulated_bluetooth::outputs simulated_bluetooth::connect(station_id station, attempt_id attempt,
                                                          const bluetooth_address& to,
                                                          std::uint16_t port) {
  const auto asker = stations_.find(station);
  if (asker == stations_.end())
    return {};
  for (const auto& [name, address] : asker->second.adapters) {
    const auto* at = announced(adapters_.at(address), to);
    const auto acceptor = at == nullptr ? std::nullopt : listener(*at, port);
    if (!acceptor || *acceptor == station)
      continue;
    const link_id link{next_link_++};
    links_[link] = {station, *acceptor, address, to};
    return {link_made{*acceptor, station, link, link_role::acceptor, {}},
            link_made{station, *acceptor, link, link_role::initiator, attempt}};
  }
  return {link_refused{station, attempt}};
}

simulated_bluetooth::outputs simulated_bluetooth::set_power(station_id station, bool on) {
  for (auto& [address, each] : adapters_) {
    if (on)
      each.dark.erase(station);
    else if (std::ranges::find(each.stations, station) != each.stations.end())
      each.dark.insert(station);
  }
  return settle_links();
}

simulated_bluetooth::outputs simulated_bluetooth::move(const std::string& machine, position place) {
  for (auto& [address, each] : adapters_) {
    if (each.machine == machine)
      each.place = place;
  }
  return settle_links();
}

} // namespace rubicon::peis
