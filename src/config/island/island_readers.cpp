#include <algorithm>
#include <limits>
#include <utility>

#include "config/checks/listening_check.hpp"
#include "config/checks/window_room.hpp"
#include "config/file_readers.hpp"
#include "config/island/application_readers.hpp"
#include "config/island/island_motes.hpp"
#include "config/island/outside_readers.hpp"
#include "config/label_keys.hpp"
#include "mote/duty_keys.hpp"
#include "radio/medium/tossim_files.hpp"
#include "radio/parameter_keys.hpp"
#include "serial/cable/line_keys.hpp"

namespace rubicon::config {

namespace {

/// The largest PAN id of a radio network; the next one is that of all (IEEE 802.15.4-2006 7.5.6.2).
constexpr std::uint32_t pan_id_max = 0xfffe;

auto sink_role_keys() {
  return keys::of(keys::optional(
      "role", &island_description::stack,
      word<stack>{{{"root", stack::full}, {"base_station", stack::plain}}},
      {"`\"root\"`: its motes join it. `\"base_station\"`: it is a BaseStation of TinyOS, "
       "which forwards the frames that it receives, and its motes run plain programs",
       "`\"root\"`"}));
}

auto sink_keys() {
  using x = sink_description;
  return keys::of(
      keys::optional("id", &x::id, whole<std::uint16_t>{1, mote_id_max},
                     "its mote id; no other mote of the island has it"),
      keys::optional("platform", &x::platform, platform_name(), "as of a mote"),
      keys::optional("position_m", &x::place, place{},
                     "in a unit disk, every mote of an island with the full stack must be within "
                     "`range` of it"),
      keys::optional(
          "power", &x::transmit_dbm, power_level{-100, 30},
          {"transmit power, as of a mote", "the platform's maximum", "power, as of a mote"}),
      keys::optional("promiscuous", &x::promiscuous, flag{},
                     "it also accepts frames of other islands and frames addressed to other "
                     "motes, as a base station always does"));
}

auto gateway_name_keys() {
  return keys::of(
      keys::optional("name", &island_description::gateway_name, labelled_name{},
                     {"its PEIS name, unique among peers", "the island's followed by `-gateway`"}));
}

auto gateway_wire_keys() {
  return keys::of(keys::optional(
      "wire", &island_description::gateway_wire,
      word<wire_form>{{{"segment", wire_form::segment}, {"strict54", wire_form::strict54}}},
      "what follows the header of D1.1 5.4 in packages between gateways: the sender of the "
      "message and whether it is to be acknowledged, or the payload alone. The strict form "
      "is always used with a gateway whose announcement on port 20 differs from ours; it "
      "cannot express reliable messages, streams and synaptic channels"));
}

auto alias_keys() {
  using x = alias_description;
  return keys::of(
      keys::required(
          "id", &x::id, whole<std::int32_t>{1, island_id_max},
          "its PEIS id, which also addresses the island; unique among peers, islands and gateways"),
      keys::optional("name", &x::name, labelled_name{},
                     {"its PEIS name, unique among peers",
                      "the island's followed by `-gateway-2`, `-3` or `-4`"}));
}

auto island_keys() {
  using x = island_description;
  return keys::of(
      keys::required("id", &x::id, whole<std::uint32_t>{1, pan_id_max},
                     "address of the island and PEIS id of its gateway, up to 254, unique among "
                     "peers; with `stack = \"mac\"` its PAN id alone"),
      keys::required("name", &x::name, labelled_name{}, "first part of the names of its motes"),
      keys::optional("host", &x::host, host_name{},
                     {"host on which the island runs", "host on which the run is started"}),
      keys::optional("stack", &x::stack, word<stack>{{{"full", stack::full}, {"mac", stack::mac}}},
                     "`\"mac\"`: radios and medium access only, see below"),
      keys::optional(
          "channel", &x::channel, radio_channel,
          "channel of the radios of its sink and motes, unless they have their own; in a radio "
          "medium only radios of the same channel receive and disturb each other"));
}

auto keep_alive_keys() {
  return keys::of(keys::optional(
      "keep_alive", &island_description::keep_alive, time_span{1s, 24h},
      "a mote that is silent for this time is removed; motes that report less often get "
      "three of their periods; with sleeping radios the minimum is three periods of the "
      "windows, or sixty intervals of low-power listening"));
}

auto crystal_keys() {
  using x = island_description;
  return keys::of(
      keys::optional(
          "crystal_ppm", &x::crystal_ppm, real{0, 100},
          "each mote's crystal, and the sink's, runs too fast or too slow by up to this many "
          "parts per million, drawn from the seed. Each life of a mote begins with another time "
          "on its clock"),
      keys::optional("crystal_wander_ppm", &x::crystal_wander_ppm, real{0, 20},
                     "in addition, its rate varies by up to this much with temperature,"),
      keys::optional("crystal_wander_period", &x::crystal_wander_period,
                     time_span{10min, 365 * 24h}, "with this period, each with another phase"));
}

/// @returns the sink's programs
std::vector<placed_app> read_sink(table_reader& in, const surroundings& with,
                                  island_description& island) {
  auto& out = island.sink;
  const bool is_mac = island.stack == stack::mac;
  in.all(island, sink_role_keys());
  if (is_mac && in.has("role")) {
    in.problems().add(in.at("role"), "`role` has no effect in an island with stack = \"mac\"");
    island.stack = stack::mac;
  }
  in.all(out, sink_keys());
  check_power(*out.platform, out.transmit_dbm, in.at("power"), in.problems());
  mark access_at;
  read_access(in, out.access, access_at);
  check_access(out.access, access_at, in.problems());
  if (with.radio_is_known)
    check_rules(with.radio, *out.platform, out.access, access_at, in.problems());
  if (island.stack == stack::plain) {
    if (in.has("promiscuous") && !out.promiscuous)
      in.problems().add(in.at("promiscuous"),
                        "a base station accepts every frame that it receives");
    out.promiscuous = true;
  }
  auto apps = read_mote_apps(in);
  mote_profile as_mote;
  as_mote.like.platform = out.platform;
  for (const auto& each : apps) {
    if (island.stack == stack::plain)
      in.problems().add(each.channel_at, "a base station has no apps");
    else if (is_flow_app(each.app))
      as_mote.apps.push_back(each);
    else
      in.problems().add(each.channel_at,
                        "a sink has no other apps than sender, relay and receiver");
  }
  check_profile(as_mote, in.shared());
  return as_mote.apps;
}

/// @returns where the window is
mark read_duty_cycle(table_reader& island, mote::duty_config& out) {
  mark window_at;
  island.table("duty_cycle", "[island.duty_cycle]",
               {"lets radios sleep", "none: radios are always on"},
               [&out, &window_at](table_reader& in) {
                 out.enabled = true;
                 window_at = in.at(in.has("window") ? "window" : "period");
                 in.all(out);
                 if (in.sound() && 2 * out.window > out.period)
                   in.problems().add(in.at("window"),
                                     "`window` must not be longer than half the `period`, which "
                                     "is " +
                                         to_text(out.period));
               });
  return window_at;
}

/// @returns where the interval is
mark read_listening(table_reader& island, radio::listening_config& out) {
  mark interval_at = island.at("low_power_listening");
  island.table("low_power_listening", "[island.low_power_listening]",
               {"lets radios sleep except for short checks of the channel; not with `duty_cycle`",
                "none: radios are always on"},
               [&out, &interval_at](table_reader& in) {
                 out.interval = 512ms;
                 in.all(out);
                 if (in.has("interval"))
                   interval_at = in.at("interval");
                 if (in.sound() && 2 * out.check > out.interval)
                   in.problems().add(in.at("check"),
                                     "`check` must not be longer than half the `interval`, which "
                                     "is " +
                                         to_text(out.interval));
               });
  if (island.has("low_power_listening") && island.has("duty_cycle"))
    island.problems().add(island.at("low_power_listening"),
                          "`low_power_listening` and `duty_cycle` exclude each other: an island "
                          "has at most one of them");
  return interval_at;
}

/// A mote whose radio sleeps is heard once in a period.
void warn_of_keep_alive(table_reader& in, const island_description& x) {
  const auto least = x.duty.silence_min();
  const bool says_so = in.has("keep_alive");
  if (says_so ? x.keep_alive >= least : x.keep_alive > x.duty.period || !x.duty.enabled)
    return;
  in.problems().warn(in.at(says_so ? "keep_alive" : "duty_cycle"),
                     "`keep_alive` is " + to_text(x.keep_alive) +
                         ", but motes whose radios sleep are received once in a period of " +
                         to_text(x.duty.period) + ": they are removed after three of these, " +
                         to_text(least));
}

/// Keep-alives of motes whose radios listen at low power occupy the air.
void warn_of_slow_signs(table_reader& in, const island_description& x) {
  const auto least = x.listening.silence_min();
  if (in.has("keep_alive") && x.keep_alive < least)
    in.problems().warn(
        in.at("keep_alive"),
        "`keep_alive` is " + to_text(x.keep_alive) +
            ", but a mote is removed after sixty intervals of low-power listening, " +
            to_text(least) +
            ", at the earliest: otherwise keep-alive messages would saturate the channel");
}

void read_gateway(table_reader& in, surroundings& with, island_description& out) {
  in.all(out, gateway_name_keys());
  with.labels.add(label_table::kind::peer, out.gateway_name, read_label(in));
  out.gateway_links = read_links(
      in, {out.gateway_name},
      "peers that it connects to; a link works in both directions, and rings are allowed");
  in.all(out, gateway_wire_keys());
  out.gateway_apps = read_pc_programs(in, "apps", "apps of a gateway", with.files);
}

alias_description read_alias(table_reader& in, surroundings& with, const island_description& of) {
  alias_description out;
  out.serial.baud = of.sink.platform->serial_baud;
  out.name = default_alias_name(of.name, of.aliases.size() + 2);
  if (of.aliases.size() == aliases_max)
    in.problems().add(in.at("id"),
                      "an island has at most " + std::to_string(aliases_max + 1) + " gateways");
  in.all(out, alias_keys());
  with.labels.add(label_table::kind::peer, out.name, read_label(in));
  if (in.is_good("id") &&
      with.end_ids.add(out.id.value, "PEIS id " + to_string(out.id), in.at("id"), in.problems()))
    with.island_ids.add(static_cast<std::uint32_t>(out.id.value), "island id " + to_string(out.id),
                        in.at("id"), in.problems());
  if (!of.name.empty() || in.has("name"))
    with.end_names.add(out.name, "peer or gateway name", in.at(in.has("name") ? "name" : "id"),
                       in.problems());
  out.links = read_links(in, {out.name}, "peers that it connects to");
  in.table("serial", "[island.alias.serial]", "its cable",
           [&out](table_reader& x) { x.all(out.serial); });
  return out;
}

/// Programs of a PC are not handed over from gateway to gateway.
void check_aliases(const table_reader& in, const island_description& x) {
  if (!x.aliases.empty() && !x.gateway_apps.empty())
    in.problems().add(in.at("gateway"),
                      "a gateway has apps only where it is the island's only one; "
                      "a peer may have them");
  if (!x.aliases.empty() && x.real.is_there())
    in.problems().add(
        in.at("real"),
        "`real` has no effect in an island with several gateways: it belongs to one gateway");
}

/// The cable and the gateway of an island, and its further ones.
/// @returns the names of its real motes
real_names read_parts(table_reader& in, surroundings& with, bool name_is_free,
                      island_description& out) {
  out.serial.baud = out.sink.platform->serial_baud;
  in.table("serial", "[island.serial]", "the cable between sink and gateway", [&](table_reader& x) {
    x.all(out.serial);
    read_outside(x, with, out.name, out.outside);
  });
  out.gateway_name = default_gateway_name(out.name);
  if (out.outside.has_gateway()) {
    refuse_gateway(in);
    return {};
  }
  if (out.outside.has_sink())
    refuse_simulated(in);
  read_export(in, with, out);
  auto names = read_real(in, with, out);
  read_plain(in, out);
  mark name_at = in.at("name");
  bool adds_name = name_is_free; // a default name is taken together with the island's
  in.table("gateway", "[island.gateway]", "connection of the island to the PEIS network",
           [&](table_reader& x) {
             read_gateway(x, with, out);
             if (x.has("name")) {
               name_at = x.at("name");
               adds_name = true;
             }
           });
  if (adds_name)
    with.end_names.add(out.gateway_name, "peer or gateway name", name_at, in.problems());
  in.tables("alias", "[[island.alias]]", {"further gateways, at most 3", "none"},
            [&](table_reader& x) { out.aliases.push_back(read_alias(x, with, out)); });
  check_aliases(in, out);
  return names;
}

/// An island with the medium access only has none of what joins it to the PEIS network.
void refuse_parts(table_reader& in) {
  for (const auto* key :
       {"keep_alive", "duty_cycle", "serial", "gateway", "alias", "export", "plain", "real"}) {
    in.expect(key);
    if (in.has(key))
      in.problems().add(in.at(key), '`' + std::string(key) +
                                        "` has no effect in an island with stack = \"mac\"");
  }
}

/// What needs a sink that knows its motes.
void refuse_membership(table_reader& in) {
  for (const auto* key : {"duty_cycle", "alias", "real"})
    if (in.has(key))
      in.problems().add(
          in.at(key),
          '`' + std::string(key) +
              "` has no effect in an island with a base station, which does not know its motes");
}

/// Motes carry the id of an island in one octet (ADR-03); radios alone carry it as PAN id.
bool id_has_room(const table_reader& in, const island_description& x) {
  if (x.stack == stack::mac || x.id.value <= island_id_max)
    return true;
  in.problems().add(in.at("id"), "`id` must be a whole number from 1 to " +
                                     std::to_string(island_id_max) + ", not " + to_string(x.id));
  return false;
}

/// The id of an island with a gateway is a PEIS id too (ADR-02).
void add_island_id(const table_reader& in, surroundings& with, const island_description& x) {
  const bool is_free =
      x.stack == stack::mac ||
      with.end_ids.add(x.id.value, "PEIS id " + to_string(x.id), in.at("id"), in.problems());
  if (is_free)
    with.island_ids.add(x.id.value, "island id " + to_string(x.id), in.at("id"), in.problems());
}

island_description read_island(table_reader& in, surroundings& with, name_uniqueness& names) {
  island_description out;
  in.all(out, island_keys());
  with.labels.add(label_table::kind::island, out.name, read_label(in));
  const bool name_is_free =
      in.is_good("name") && names.add(out.name, "island name", in.at("name"), in.problems());
  if (in.is_good("id") && id_has_room(in, out))
    add_island_id(in, with, out);
  const auto before_sink = in.problems().size();
  out.sink.platform = radio::find_platform("micaz");
  std::vector<placed_app> sink_apps;
  in.table("sink", "[island.sink]", "the mote at the cable",
           [&](table_reader& x) { sink_apps = read_sink(x, with, out); });
  const bool sink_is_good = in.problems().size() == before_sink;
  real_names names_of_real;
  mark window_at;
  const auto interval_at = read_listening(in, out.listening);
  if (out.stack == stack::mac) {
    refuse_parts(in);
  } else {
    in.all(out, keep_alive_keys());
    window_at = read_duty_cycle(in, out.duty);
    warn_of_keep_alive(in, out);
    warn_of_slow_signs(in, out);
    names_of_real = read_parts(in, with, name_is_free, out);
    if (out.stack == stack::plain)
      refuse_membership(in);
    if (out.stack == stack::plain && out.outside.has_sink())
      in.problems().add(in.at("sink"), "`role` has no effect with a real sink");
  }
  in.all(out, crystal_keys());
  const auto before_motes = in.problems().size();
  island_motes motes(with, out, sink_is_good);
  for (const auto& [at, name] : names_of_real)
    motes.add_name(name, at, in.problems());
  motes.add_sink(in, std::move(sink_apps), in.at("sink"));
  in.tables("mote", "[[island.mote]]", {"also as `mote = [{ ... }, { ... }]`", "none"},
            [&](table_reader& x) { motes.read_mote(x); });
  in.tables("group", "[[island.group]]", {"many motes in one table", "none"},
            [&](table_reader& x) { motes.read_group(x); });
  if (sink_is_good && in.problems().size() == before_motes)
    motes.finish(in.problems());
  if (!in.walks() && out.listening.enabled() && with.radio_is_known)
    check_listening(out, with.radio, with.tick, interval_at, in.problems());
  if (!in.walks() && in.problems().empty() && with.radio_is_known) {
    const auto short_window = warning_of_window(out, with.radio);
    if (!short_window.empty())
      in.problems().warn(window_at, short_window);
    const auto traffic = warning_of_traffic(out);
    if (!traffic.empty())
      in.problems().warn(in.at("id"), traffic);
  }
  return out;
}

} // namespace

surroundings::surroundings(reading& all, const radio::channel_config& channel,
                           std::uint64_t ecology_seed)
    : shared(all), radio(channel), seed(ecology_seed) {
  const auto* gains = std::get_if<radio::gain_matrix>(&channel.propagation);
  if (gains == nullptr || gains->table == nullptr)
    return;
  nodes.resize(std::numeric_limits<std::uint16_t>::max() + 1U);
  for (const auto& each : gains->table->gains)
    nodes[each.from] = nodes[each.to] = true;
}

std::vector<island_description> read_islands(table_reader& root, surroundings& with) {
  std::vector<island_description> out;
  name_uniqueness names;
  root.tables("island", "[[island]]",
              "motes around one sink; a file has at least an island or a peer",
              [&](table_reader& x) { out.push_back(read_island(x, with, names)); });
  for (const auto& [name, profile] : with.types) {
    if (!with.types_used.contains(name))
      check_profile(profile, with.shared);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return out;
}

} // namespace rubicon::config
