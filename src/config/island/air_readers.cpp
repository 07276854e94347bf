#include <algorithm>
#include <utility>

#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

/// The islands of a file, and which of them have an air.
class island_airs {
public:
  explicit island_airs(const std::vector<island_description>& islands) : islands_(islands) {}

  /// One medium cannot be in two places: islands that share an air share a host.
  void place(const std::vector<located<island_id>>& members, complaints& problems) {
    const island_description* first = nullptr;
    for (const auto& each : members) {
      const auto* island = find(each.value);
      if (island == nullptr)
        continue; // its own table has no good id
      if (island->outside.has_sink())
        problems.add(each.at,
                     "island `" + island->name + "` has a real sink: its motes use real radios");
      placed_.add(each.value, "island `" + island->name + '`', each.at, problems,
                  "already belongs to a radio medium");
      if (first == nullptr)
        first = island;
      if (island->host != first->host)
        problems.add(each.at, "islands `" + first->name + "` and `" + island->name +
                                  "` share a radio medium, so they must be on one host");
    }
  }

private:
  [[nodiscard]] const island_description* find(island_id id) const {
    const auto found =
        std::find_if(islands_.begin(), islands_.end(), [id](const auto& x) { return x.id == id; });
    return found == islands_.end() ? nullptr : &*found;
  }

  const std::vector<island_description>& islands_;
  uniqueness<island_id> placed_;
};

bool holds(const air_description& air, island_id island) {
  return std::find(air.islands.begin(), air.islands.end(), island) != air.islands.end();
}

auto air_keys() {
  return keys::of(keys::required("name", &air_description::name, name_text{},
                                 "unique among radio media and the islands outside it"));
}

/// Islands of an air, with the places that checks need.
struct air_members {
  std::vector<located<island_id>> islands;
};

auto air_member_keys() {
  return keys::of(keys::required("islands", &air_members::islands, list_of<island_name>{{}, 1},
                                 "each island belongs to at most one radio medium"));
}

} // namespace

std::vector<air_description> read_airs(table_reader& root,
                                       const std::vector<island_description>& islands) {
  std::vector<air_description> out;
  name_uniqueness air_names;
  island_airs placed(islands);
  root.tables("air", "[[air]]", "islands that share a place", [&](table_reader& in) {
    air_description air;
    air_members found;
    in.all(air, air_keys());
    in.all(found, air_member_keys());
    auto& members = found.islands;
    if (in.is_good("name"))
      air_names.add(air.name, "air name", in.at("name"), in.problems());
    placed.place(members, in.problems());
    air.islands = values_of(std::move(members));
    for (const auto& island : islands) {
      if (!air.name.empty() && island.name == air.name && !holds(air, island.id))
        in.problems().add(in.at("name"),
                          "air `" + air.name + "` has the name of an island that is not in it");
    }
    out.push_back(std::move(air));
  });
  for (const auto& island : islands) {
    const auto has_it = [&island](const auto& air) { return holds(air, island.id); };
    if (!island.outside.has_sink() && std::none_of(out.begin(), out.end(), has_it))
      out.push_back({island.name, {island.id}});
  }
  return out;
}

} // namespace rubicon::config
