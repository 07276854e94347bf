#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "config/file_readers.hpp"
#include "core/math.hpp"

namespace rubicon::config {

namespace {

/// The `type` of a mote: a number, or the name of a mote type.
struct mote_kind {
  struct type {
    std::uint32_t number = 0;
    std::string name;
  };
  const directory& names;

  [[nodiscard]] std::optional<type> read(const node& x, const asker& who) const {
    const auto* name = x.as<std::string>();
    if (name == nullptr) {
      const auto number = whole<std::uint32_t>{1}.read(x, who);
      return number ? std::optional(type{*number, {}}) : std::nullopt;
    }
    if (names.mote_types.contains(*name))
      return type{0, *name};
    who.complain(x, "no mote type is called `" + *name + '`' +
                        suggestion(*name, {names.mote_types.begin(), names.mote_types.end()}));
    return std::nullopt;
  }
};

void read_sink(table_reader& in, sink_description& out) {
  in.optional("id", whole<std::uint16_t>{1, mote_id_max}, out.id);
  in.optional("platform", platform_name{}, out.platform);
  in.optional("position_m", place{}, out.place);
}

void read_serial(table_reader& in, serial::line_config& out) {
  in.optional("baud", baud{}, out.baud);
  in.optional("latency", time_span{0s, 10s}, out.latency);
  in.optional("octet_error", ratio{}, out.octet_error);
  in.optional("buffer", whole<std::size_t>{64, 1U << 24U}, out.buffer);
}

void read_gateway(table_reader& in, surroundings& with, island_description& out) {
  in.optional("name", name_text{}, out.gateway_name);
  out.gateway_links = read_links(in, with.names, out.gateway_name);
}

std::string metres_text(double x) {
  return shown(std::ceil(x * 100) / 100) + " m"; // upwards: 30.001 m is more than 30 m
}

/// An island is a star: its sink must hear every mote, and be heard.
void check_range(const mote_description& x, const sink_description& sink, double range_m, mark at,
                 complaints& problems) {
  const auto distance = math::length(x.place.x_m - sink.place.x_m, x.place.y_m - sink.place.y_m,
                                     x.place.z_m - sink.place.z_m);
  if (distance > range_m)
    problems.add(at, "mote `" + x.name + "` is " + metres_text(distance) +
                         " from its sink, but a radio reaches only " + metres_text(range_m));
}

/// What the motes of an island must not share, and how far they may be from its sink.
struct mote_limits {
  claims<std::uint16_t> ids;
  name_claims names;
  double range_m = 0;
};

/// Starts from what the mote's type says.
mote_profile profile_of(const mote_kind::type& kind, surroundings& with) {
  mote_profile profile;
  profile.platform = radio::find_platform("micaz");
  profile.type = kind.number;
  if (const auto found = with.types.find(kind.name); found != with.types.end()) {
    profile = found->second;
    with.types_used.insert(kind.name);
  }
  return profile;
}

mote_description read_mote(table_reader& in, surroundings& with, const sink_description& sink,
                           mote_limits& limits) {
  mote_description out;
  mote_kind::type kind;
  const bool has_id = in.required("id", whole<std::uint16_t>{1, mote_id_max}, out.id);
  in.required("type", mote_kind{with.names}, kind);
  out.type_name = kind.name;
  out.name = default_mote_name(kind.name, out.id);
  in.optional("name", name_text{}, out.name);
  const bool has_place = in.required("position_m", place{}, out.place);
  auto profile = profile_of(kind, with);
  read_profile(in, with.names, profile);
  check_profile(profile, with.shared);
  if (has_id) {
    if (out.id == sink.id)
      in.problems().add(in.at("id"), "mote id " + to_string(out.id) + " is the sink's");
    const bool id_is_free =
        limits.ids.claim(out.id.value, "mote id " + to_string(out.id), in.at("id"), in.problems());
    if (id_is_free || in.has("name")) // a default name is taken together with its id
      limits.names.claim(out.name, "mote name", in.at("name"), in.problems());
  }
  if (has_place)
    check_range(out, sink, limits.range_m, in.at("position_m"), in.problems());
  out.type = profile.type;
  out.platform = profile.platform;
  out.battery_mah = profile.battery_mah;
  out.transducers = std::move(profile.transducers);
  out.actuators = std::move(profile.actuators);
  for (auto& each : profile.apps)
    out.apps.push_back(std::move(each.app));
  return out;
}

/// The cable and the gateway of an island.
void read_parts(table_reader& in, surroundings& with, bool name_is_free, island_description& out) {
  out.serial.baud = out.sink.platform->serial_baud;
  in.table("serial", "[island.serial]", [&out](table_reader& x) { read_serial(x, out.serial); });
  out.gateway_name = default_gateway_name(out.name);
  mark name_at = in.at("name");
  bool claims_name = name_is_free; // a default name is taken together with the island's
  in.table("gateway", "[island.gateway]", [&](table_reader& x) {
    read_gateway(x, with, out);
    if (x.has("name")) {
      name_at = x.at("name");
      claims_name = true;
    }
  });
  if (claims_name)
    with.end_names.claim(out.gateway_name, "peer or gateway name", name_at, in.problems());
}

island_description read_island(table_reader& in, surroundings& with, name_claims& names) {
  island_description out;
  if (in.required("id", whole<std::uint32_t>{1, island_id_max}, out.id))
    with.end_ids.claim(out.id.value, "PEIS id " + to_string(out.id), in.at("id"), in.problems());
  const bool name_is_free = in.required("name", name_text{}, out.name) &&
                            names.claim(out.name, "island name", in.at("name"), in.problems());
  in.optional("host", host_name{with.names}, out.host);
  in.optional("keep_alive", time_span{1s, 24h}, out.keep_alive);
  mote_limits limits;
  const auto before_sink = in.problems().size();
  out.sink.platform = radio::find_platform("micaz");
  in.table("sink", "[island.sink]", [&out](table_reader& x) { read_sink(x, out.sink); });
  const bool sink_is_good = in.problems().size() == before_sink;
  limits.range_m = sink_is_good ? with.range_m : std::numeric_limits<double>::infinity();
  read_parts(in, with, name_is_free, out);
  in.tables("mote", "[[island.mote]]",
            [&](table_reader& x) { out.motes.push_back(read_mote(x, with, out.sink, limits)); });
  std::sort(out.motes.begin(), out.motes.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  return out;
}

} // namespace

std::vector<island_description> read_islands(table_reader& root, surroundings& with) {
  std::vector<island_description> out;
  name_claims names;
  root.tables("island", "[[island]]",
              [&](table_reader& x) { out.push_back(read_island(x, with, names)); });
  for (const auto& [name, profile] : with.types) {
    if (!with.types_used.contains(name))
      check_profile(profile, with.shared);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return out;
}

} // namespace rubicon::config
