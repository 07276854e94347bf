#include "exports/mote_places.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"

namespace rubicon::exports {

namespace {

using nlohmann::json;

constexpr double latest_s = 1e9;

/// Of fields that are absent or no numbers: nothing.
double number_of(const json& x) {
  return x.is_number() ? x.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

const json& member(const json& x, const char* key) {
  static const json none;
  const auto found = x.is_object() ? x.find(key) : x.end();
  return found == x.end() ? none : *found;
}

const json& item(const json& x, std::size_t index) {
  static const json none;
  return x.is_array() && index < x.size() ? x[index] : none;
}

/// @param path waypoints: seconds and two coordinates; none: it stands at `place`
std::vector<device::waypoint> waypoints_of(const json& path, position place) {
  std::vector<device::waypoint> all;
  if (path.is_array())
    for (const auto& each : path) {
      const auto at_s = number_of(item(each, 0));
      const auto at = duration(
          static_cast<duration::rep>(at_s >= 0 && at_s < latest_s ? std::llround(at_s * 1e9) : 0));
      if (all.empty() || all.back().at < at)
        all.push_back({at, {number_of(item(each, 1)), number_of(item(each, 2))}});
    }
  if (all.empty())
    all.push_back({duration{}, place});
  return all;
}

std::optional<mote_address> address_of(const json& island, const json& mote) {
  if (!island.is_number_unsigned() || !mote.is_number_unsigned())
    return std::nullopt;
  const auto i = island.get<std::uint64_t>();
  const auto m = mote.get<std::uint64_t>();
  if (!std::in_range<island_id::rep>(i) || !std::in_range<mote_id::rep>(m))
    return std::nullopt;
  return mote_address{island_id(static_cast<island_id::rep>(i)),
                      mote_id(static_cast<mote_id::rep>(m))};
}

} // namespace

std::vector<mote_place> places_of(const std::string& ecology) {
  const auto x = try_parse_json(ecology);
  const auto& paths = member(x, "paths");
  std::vector<mote_place> all;
  std::size_t index = 0;
  for (const auto& island : member(x, "islands")) {
    const auto& id = member(island, "id");
    const auto& sink = member(island, "sink");
    const auto add = [&](const json& mote, const json& path, position place) {
      if (const auto who = address_of(id, mote))
        all.push_back({*who, device::walk(waypoints_of(path, place), 1s)});
    };
    add(member(sink, "id"), {}, {number_of(member(sink, "x")), number_of(member(sink, "y"))});
    for (const auto& mote : member(island, "motes"))
      add(item(mote, 0), member(paths, std::to_string(index++).c_str()),
          {number_of(item(mote, 2)), number_of(item(mote, 3))});
  }
  return all;
}

} // namespace rubicon::exports
