#include "view/sample_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"

namespace rubicon::view {

namespace {

using json = nlohmann::ordered_json;
using report::mote_sample;

/// An infinite one is null, as is what is unset.
json written(double x) {
  return std::isfinite(x) ? json(std::round(x * 1e6) / 1e6) : json();
}
json written(bool x) {
  return x ? 1 : 0;
}
template <std::unsigned_integral Number>
json written(Number x) {
  return x;
}
json written(mote_id x) {
  return x.value;
}
template <class T>
json written(const std::optional<T>& x) {
  if constexpr (std::is_same_v<T, int>)
    return x ? json(*x) : json();
  else
    return x ? written(*x) : json();
}

void take(const json& from, double& x) {
  x = from.is_null() ? std::numeric_limits<double>::infinity() : from.get<double>();
}
void take(const json& from, bool& x) {
  x = from.get<int>() != 0;
}
template <std::unsigned_integral Number>
void take(const json& from, Number& x) {
  const auto number = from.get<std::uint64_t>();
  if (!std::in_range<Number>(number))
    throw std::out_of_range("a number does not fit");
  x = static_cast<Number>(number);
}
void take(const json& from, mote_id& x) {
  std::uint16_t number = 0;
  take(from, number);
  x = mote_id(number);
}
template <class T>
void take(const json& from, std::optional<T>& x) {
  if (from.is_null())
    x.reset();
  else
    x = from.get<T>();
}

/// Each column once: f(name, field of a mote).
template <class Mote, class F>
void for_each_column(Mote& x, const F& f) {
  f("mote", x.address.mote);
  f("alive", x.alive);
  f("flat", x.flat);
  f("joined", x.joined);
  f("radio_on", x.radio_on);
  f("used_mah", x.used_mah);
  f("battery_mah", x.battery_mah);
  f("parent", x.parent);
  f("hops", x.hops);
  f("signal_dbm", x.signal_dbm);
  f("etx", x.etx);
  f("queued", x.queued);
  f("originated", x.originated);
  f("forwarded", x.forwarded);
  f("delivery", x.delivery);
  f("radio_off", x.energy.radio_off);
  f("radio_listen", x.energy.radio_listen);
  f("radio_receive", x.energy.radio_receive);
  f("radio_transmit", x.energy.radio_transmit);
  f("processor", x.energy.processor);
}

report::peer_sample peer_of(const std::string& name, const json& from) {
  report::peer_sample x;
  x.name = name;
  take(from.at("runs"), x.runs);
  if (!from.at("to_sink").is_null())
    take(from.at("to_sink"), x.to_sink.emplace());
  for (const auto& each : from.at("links")) {
    auto& link = x.links.emplace_back();
    link.to = peer_id(each.at(0).get<std::int32_t>());
    take(each.at(1), link.queued);
  }
  return x;
}

json written(const report::peer_sample& x) {
  auto links = json::array();
  for (const auto& each : x.links)
    links.push_back(json::array({each.to.value, each.queued}));
  return {{"runs", written(x.runs)},
          {"to_sink", x.to_sink ? json(*x.to_sink) : json()},
          {"links", std::move(links)}};
}

report::run_sample sample_of(const json& from) {
  report::run_sample x;
  x.at = instant(duration(from.at("at_ns").get<std::int64_t>()));
  for (const auto& [island, lost] : from.at("lost").items()) {
    report::island_sample each;
    each.island = island_id(static_cast<std::uint32_t>(std::stoul(island)));
    lost.get_to(each.lost);
    x.islands.push_back(std::move(each));
  }
  const auto& islands = from.at("islands");
  const auto& columns = from.at("motes");
  x.motes.resize(islands.size());
  for (std::size_t i = 0; i < x.motes.size(); ++i) {
    auto& mote = x.motes[i];
    mote.address.island = island_id(islands[i].get<std::uint32_t>());
    for_each_column(mote,
                    [&](const char* name, auto& field) { take(columns.at(name).at(i), field); });
  }
  if (const auto found = from.find("neighbours"); found != from.end())
    for (std::size_t i = 0; i < x.motes.size(); ++i)
      for (const auto& each : found->at(i)) {
        report::neighbour_sample y;
        take(each.at(0), y.mote);
        take(each.at(1), y.etx);
        x.motes[i].neighbours.push_back(y);
      }
  std::ranges::sort(x.motes, {}, &mote_sample::address);
  if (const auto found = from.find("peers"); found != from.end())
    for (const auto& [name, each] : found->items())
      x.peers.push_back(peer_of(name, each));
  std::ranges::sort(x.peers, {}, &report::peer_sample::name);
  return x;
}

} // namespace

std::string encode(const report::run_sample& x) {
  json y = {{"at_ns", x.at.time_since_epoch().count()}, {"lost", json::object()}};
  for (const auto& island : x.islands)
    y["lost"][std::to_string(island.island.value)] = island.lost;
  auto& islands = y["islands"] = json::array();
  auto& columns = y["motes"] = json::object();
  for_each_column(static_cast<const mote_sample&>(mote_sample{}),
                  [&](const char* name, const auto& /*field*/) { columns[name] = json::array(); });
  for (const auto& mote : x.motes) {
    islands.push_back(mote.address.island.value);
    for_each_column(mote, [&](const char* name, const auto& field) {
      columns[name].push_back(written(field));
    });
  }
  if (x.motes.size() <= motes_with_neighbours_max) {
    auto& all = y["neighbours"] = json::array();
    for (const auto& mote : x.motes) {
      auto list = json::array();
      for (const auto& each : mote.neighbours)
        list.push_back(json::array({each.mote.value, written(each.etx)}));
      all.push_back(std::move(list));
    }
  }
  if (x.peers.size() <= peers_listed_max)
    for (const auto& peer : x.peers)
      y["peers"][peer.name] = written(peer);
  return json_line(y);
}

std::optional<report::run_sample> decode_sample(std::string_view text) {
  try {
    return sample_of(parse_ordered_json(text));
  } catch (const json::exception&) {
    return std::nullopt;
  } catch (const std::logic_error&) { // an island that is no number
    return std::nullopt;
  }
}

} // namespace rubicon::view
