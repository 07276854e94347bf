#include "config/island/model_readers.hpp"
#include "config/toml/values.hpp"

namespace rubicon::config {

namespace {

/// Waypoints as the file has them.
struct path_points {
  way::type points;
};

auto path_keys() {
  return keys::of(keys::optional(
      "path", &path_points::points, way{},
      {"times since the start, in increasing order, and positions; in between it "
       "moves in straight lines, after the last one it stays. It begins at `\"0s\"`, "
       "or at `position_m` if given",
       "it does not move"}));
}

} // namespace

void read_path(table_reader& in, bool has_place, position& place,
               std::vector<device::waypoint>& out) {
  path_points given;
  in.all(given, path_keys());
  const auto& points = given.points;
  if (!in.is_good("path"))
    return;
  if (has_place && points.front().first == 0s)
    in.problems().add(in.at("path"),
                      "`path` begins at 0 s, for which there is `position_m` already");
  if (!in.has("position_m") && points.front().first > 0s)
    in.problems().add(in.at("path"),
                      "`path` must begin at \"0s\", or there must be a `position_m`");
  if (has_place)
    out.push_back({0s, place});
  else
    place = points.front().second;
  for (const auto& [at, where] : points)
    out.push_back({at, where});
}

} // namespace rubicon::config
