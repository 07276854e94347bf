#include "config/island/island_motes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/checks/connectivity.hpp"
#include "config/checks/slot_check.hpp"
#include "config/island/layouts.hpp"
#include "config/island/model_readers.hpp"
#include "config/island/mote_keys.hpp"
#include "config/island/size_check.hpp"
#include "config/label_keys.hpp"
#include "radio/medium/tossim_files.hpp"
#include "serial/cable/backbone_keys.hpp"

namespace rubicon::config {

namespace {

std::string metres_text(double x) {
  return shown(std::ceil(x * 100) / 100) + " m"; // upwards: 30.001 m is more than 30 m
}

/// The first of the lowest `count` ids in a row from 1 on that are free.
std::uint32_t lowest_free(const std::set<std::uint32_t>& taken, std::uint32_t count) {
  std::uint32_t first = 1;
  for (const auto id : taken) {
    if (id >= first + count)
      break;
    first = std::max(first, id + 1);
  }
  return first;
}

bool is_sink_name(std::string_view x) {
  return edit_distance(x, sink_name) == 0; // whatever the letter case
}

bool has_floor(const radio::gain_table& table, std::uint16_t node) {
  const auto found = std::lower_bound(table.floors.begin(), table.floors.end(), node,
                                      [](const auto& x, auto n) { return x.node < n; });
  return found != table.floors.end() && found->node == node;
}

} // namespace

island_motes::island_motes(surroundings& with, island_description& island, bool sink_is_good)
    : with_(with), island_(island), taken_{island.sink.id.value} {
  const auto* disk = std::get_if<radio::unit_disk>(&with.radio.propagation);
  const bool known = with.radio_is_known;
  if (known && disk != nullptr && sink_is_good && joins())
    range_m_ = disk->range_m;
  if (island.real.is_there())
    for (std::uint32_t id = island.real.motes.first; id <= island.real.motes.last; ++id)
      taken_.insert(id);
  positions_matter_ = known && !std::holds_alternative<radio::gain_matrix>(with.radio.propagation);
}

void island_motes::add_sink(table_reader& island, std::vector<placed_app> apps, mark at) {
  static_cast<void>(check_node(island_.sink.id, "sink", at, island.problems()));
  settle_flows(apps, island_.id, island_.sink.id, island.problems());
  note_flows(island_.sink.id, apps, island.problems());
  for (auto& each : apps)
    island_.sink.apps.push_back(std::move(each.app));
}

/// What a mote and a group have in common; starts from what the mote's type says.
mote_profile island_motes::read_profile_of(table_reader& in) {
  mote_type_choice choice;
  in.all(choice, mote_kind_keys(joins() && !island_.outside.has_sink()));
  const auto& kind = choice.kind;
  const bool known = in.is_good("type");
  mote_profile profile;
  profile.like.type = kind.number;
  if (const auto* given = in.content().find("type"); !known && given != nullptr)
    if (const auto* name = given->as<std::string>())
      profile.like.type_name = *name; // others name the mote by it
  if (const auto found = with_.types.find(kind.name); found != with_.types.end()) {
    profile = found->second;
    with_.types_used.insert(kind.name);
  }
  read_profile(in, profile);
  check_profile(profile, with_.shared);
  settle_flows(profile.apps, island_.id, island_.sink.id, in.problems());
  check_stack(in, profile);
  if (with_.radio_is_known)
    check_rules(with_.radio, *profile.like.platform, profile.like.access, profile.access_at,
                in.problems());
  return profile;
}

/// Complains about what a mote of the island's stack does not have.
void island_motes::check_stack(const table_reader& in, const mote_profile& profile) const {
  for (const auto& each : profile.apps)
    if (const auto* firmware = std::get_if<firmware::program_config>(&each.app))
      check_firmware(in, *firmware, each.channel_at);
  if (island_.stack == stack::mac)
    return check_mac_profile(in, profile);
  for (const auto& each : profile.apps) {
    const bool is_plain = is_plain_app(each.app);
    if (is_plain && joins() && !island_.outside.has_sink())
      in.problems().add(each.channel_at, "a plain program of TinyOS needs an island whose sink has "
                                         "role = \"base_station\"");
    if (!joins() && !is_plain && !is_flow_app(each.app) && !is_firmware(each.app))
      in.problems().add(each.channel_at, "a mote around a base station has no other apps than "
                                         "oscilloscope, blink, count, sender, relay and receiver");
  }
  if (!joins() && !profile.like.actuators.empty())
    in.problems().add(
        in.has("actuators") ? in.at("actuators") : in.at("type"),
        "a mote around a base station has no actuators: they could not be controlled");
}

/// Complains about firmware where no mote could run it.
void island_motes::check_firmware(const table_reader& in, const firmware::program_config& x,
                                  mark at) const {
  if (island_.outside.has_sink())
    in.problems().add(at, "`firmware` has no effect in an island with a real sink: none of its "
                          "motes is simulated");
  else if (joins())
    in.problems().add(at, "`firmware` needs an island with stack = \"mac\", or one whose sink has "
                          "role = \"base_station\": its motes do not join");
  if (with_.mode == run_mode::wall && x.code && !x.code->facts.runs_in_wall_time())
    in.problems().add(at, "the firmware runs in virtual time only: it does not have the flag "
                          "RUBICON_MOTE_WALL_TIME");
}

void island_motes::check_mac_profile(const table_reader& in, const mote_profile& profile) const {
  const auto refuse = [&](std::string_view key, const char* what) {
    in.problems().add(in.has(key) ? in.at(key) : in.at("type"),
                      std::string("a mote of an island with stack = \"mac\" has no ") + what);
  };
  if (!profile.like.transducers.empty())
    refuse("transducers", "transducers");
  if (!profile.like.actuators.empty())
    refuse("actuators", "actuators");
  if (!std::all_of(profile.apps.begin(), profile.apps.end(),
                   [](const auto& x) { return uses_radio_alone(x.app); }))
    refuse("apps", "other apps than sender, relay, receiver and member");
  for (const auto& each : profile.apps) {
    const auto* member = std::get_if<member_app>(&each.app);
    if (member != nullptr && std::ranges::any_of(member->subscribes, [](const auto& x) {
          return x.channel.has_value();
        }))
      in.problems().add(each.channel_at, "an island with stack = \"mac\" has no gateway that a "
                                         "`channel` of `subscribes` could lead to");
  }
}

/// What makes a mote a further sink.
void island_motes::read_backbone(table_reader& in, mote_description& out) {
  in.table("backbone", "[island.mote.backbone]",
           {"makes the mote a further sink: a root of the same collection tree, powered by its "
            "cable, with a backbone to the island's sink",
            "none: it is an ordinary mote"},
           [&out](table_reader& x) {
             out.backbone.emplace();
             out.backbone->baud = out.platform->serial_baud;
             x.all(*out.backbone);
           });
  if (!out.backbone)
    return;
  const auto refuse = [&in](const std::string& what) {
    in.problems().add(in.at("backbone"), what);
  };
  if (!joins())
    refuse("`backbone` has no effect in an island whose motes do not join: with stack = \"mac\" or "
           "a base station");
  else if (island_.outside.has_sink())
    refuse("a mote of an island with a real sink cannot be a further sink");
  else if (island_.real.is_there())
    refuse("an island with `real` cannot have further sinks");
  if (island_.duty.enabled)
    refuse("an island with `duty_cycle` cannot have further sinks");
  if (island_.listening.enabled())
    refuse("an island with `low_power_listening` cannot have further sinks");
  if (!out.path.empty())
    refuse("a further sink cannot have a `path`: it is connected to a cable");
  if (channel_of(island_, out) != island_.channel)
    refuse("a further sink has the `channel` of its island");
  if (std::ranges::any_of(out.apps,
                          [](const auto& app) { return std::holds_alternative<member_app>(app); }))
    refuse("a further sink cannot be a member of a group, which controls its radio");
}

void island_motes::read_mote(table_reader& in) {
  const std::uint16_t least = island_.outside.has_sink() ? 0 : 1; // plain motes may have any
  mote_description identity;
  in.all(identity, mote_id_keys(least));
  const auto id = identity.id;
  const bool has_id = in.is_good("id");
  const auto profile = read_profile_of(in);
  auto out = profile.mote();
  out.id = id;
  out.name = default_mote_name(out.type_name, out.id);
  in.all(out, mote_name_keys());
  with_.labels.add(label_table::kind::mote, island_.name + '/' + out.name, read_label(in));
  if (in.is_good("name") && is_sink_name(out.name))
    in.problems().add(in.at("name"),
                      "`" + out.name + "` stands for the sink of an island: choose another name");
  const bool may_lack_place = !positions_matter_ || in.has("path") || island_.outside.has_sink();
  in.all(out, mote_place_keys(!may_lack_place));
  const bool has_place = in.is_good("position_m");
  if (in.has("path") && with_.radio_is_known && !positions_matter_)
    in.problems().add(in.at("path"), "`path` has no effect with model = \"gains\"");
  read_path(in, has_place, out.place, out.path);
  in.all(out, movement_keys());
  if (in.has("stays_when_flat") && !in.has("path"))
    in.problems().add(in.at("stays_when_flat"), "`stays_when_flat` has no effect without a `path`");
  if (in.has("step") && !in.has("path"))
    in.problems().add(in.at("step"), "`step` has no effect without a `path`");
  read_backbone(in, out);
  if (has_id) {
    static_cast<void>(settle_traces(out.transducers, out.id, in.at("id"), in.shared()));
    const bool id_is_free = add_id(out.id, in.at("id"), in.problems());
    if (id_is_free || in.has("name")) // a default name is taken together with its id
      names_.add(out.name, "mote name", in.at("name"), in.problems());
    static_cast<void>(check_node(out.id, out.name, in.at("id"), in.problems()));
  }
  if (has_place)
    placed_at_[out.id] = in.at("position_m");
  with_.shared.seen.motes[{island_.id, out.id}] = {in.at(has_place ? "position_m" : "id"),
                                                   in.at(in.has("step") ? "step" : "path")};
  note_flows(out.id, profile.apps, in.problems());
  island_.motes.push_back(std::move(out));
  note_programs(profile.apps, island_.motes.size() - 1, in.problems());
}

void island_motes::read_group(table_reader& in) {
  mote_group group;
  in.all(group, group_size_keys());
  group.first = lowest_free(taken_, group.count);
  in.all(group, group_name_keys());
  auto& [count, first, prefix] = group;
  if (first + count - 1 > mote_id_max) {
    in.problems().add(in.at("count"), "mote ids from " + std::to_string(first) + " to " +
                                          std::to_string(first + count - 1) + " are more than " +
                                          std::to_string(mote_id_max));
    count = 0;
  } else if (count > group_motes_max - with_.group_motes) {
    in.problems().add(in.at("count"), "the groups of a file must not have more than " +
                                          std::to_string(group_motes_max) + " motes together");
    count = 0;
  }
  with_.group_motes += count;
  const auto profile = read_profile_of(in);
  const auto like = profile.mote();
  if (!in.is_good("prefix")) {
    prefix = default_mote_name(like.type_name, mote_id{});
    prefix.resize(prefix.rfind('-'));
    if (prefix.size() > prefix_length_max) {
      in.problems().add(in.at("type"), "names that begin with the mote type would be longer than "
                                       "32 characters: give a `prefix`");
      count = 0;
    }
  }
  const auto begin = island_.motes.size();
  add_group(in, first, count, like, prefix);
  for (auto i = begin; i < island_.motes.size(); ++i)
    note_flows(island_.motes[i].id, profile.apps, in.problems());
  note_programs(profile.apps, begin, in.problems());
}

/// The motes from `begin` on have these programs.
void island_motes::note_programs(const std::vector<placed_app>& placed, std::size_t begin,
                                 complaints& problems) {
  const auto programs = programs_of(placed);
  const auto one = apps::traffic_of(island_.id, programs);
  if (one.longest == apps::load{} && one.longest_tunnelled == apps::load{})
    return; // no vectors
  vectors_at_ = placed.back().channel_at;
  check_tick(programs, island_.id, with_.tick, vectors_at_, problems);
  for (auto i = begin; i < island_.motes.size(); ++i) {
    traffic_ += one;
    programs_at_[island_.motes[i].id] = vectors_at_;
  }
}

void island_motes::add_group(table_reader& in, std::uint32_t first, std::uint32_t count,
                             const mote_description& like, const std::string& prefix) {
  std::vector<position> places;
  const layout_rng rng{with_.seed, island_.name + "/layout/" + std::to_string(first)};
  if (positions_matter_ || in.has("layout") || in.walks())
    places = read_layout(in, count, rng);
  island_.motes.reserve(island_.motes.size() + count);
  bool ids_are_free = true;
  bool has_node = true;
  bool has_traces = true;
  for (std::uint32_t i = 0; i < count && ids_are_free; ++i) {
    auto mote = like;
    mote.id = mote_id(static_cast<std::uint16_t>(first + i));
    mote.name = default_mote_name(prefix, mote.id);
    if (i < places.size())
      mote.place = places[i];
    // The first mistake of each kind will do.
    const auto id_at = in.at(in.has("first") ? "first" : "count");
    ids_are_free = add_id(mote.id, id_at, in.problems()) &&
                   names_.add(mote.name, "mote name", in.at(in.has("prefix") ? "prefix" : "count"),
                              in.problems());
    has_node = has_node && check_node(mote.id, mote.name, id_at, in.problems());
    has_traces = has_traces && settle_traces(mote.transducers, mote.id, id_at, in.shared());
    if (i < places.size())
      placed_at_[mote.id] = in.at("layout");
    with_.shared.seen.motes[{island_.id, mote.id}] = {in.at(i < places.size() ? "layout" : "count"),
                                                      {}};
    island_.motes.push_back(std::move(mote));
  }
}

bool island_motes::add_id(mote_id id, mark at, complaints& problems) {
  taken_.insert(id.value);
  const bool is_real = island_.real.is_there() && island_.real.motes.has(id);
  if (id == island_.sink.id)
    problems.add(at, "mote id " + to_string(id) + " is the sink's");
  else if (is_real)
    problems.add(at, "mote id " + to_string(id) +
                         " is in the range of `real`, whose motes are not simulated");
  return ids_.add(id.value, "mote id " + to_string(id), at, problems) && id != island_.sink.id &&
         !is_real;
}

/// Each mote that stands still must have a route to the sink, over others if need be.
void island_motes::check_connectivity(complaints& problems) const {
  if (!range_m_ || !joins() || island_.outside.has_sink())
    return;
  std::vector<position> sinks{island_.sink.place};
  std::vector<position> places;
  std::vector<std::size_t> motes; // of those on another channel radio_warnings.cpp warns
  for (std::size_t i = 0; i < island_.motes.size(); ++i) {
    if (channel_of(island_, island_.motes[i]) != island_.channel)
      continue;
    motes.push_back(i);
    places.push_back(island_.motes[i].place);
    if (island_.motes[i].backbone)
      sinks.push_back(island_.motes[i].place);
  }
  std::set<mark> reported; // one mote of a group will do
  for (const auto i : disconnected_from_any(sinks, places, *range_m_)) {
    const auto& mote = island_.motes[motes[i]];
    const auto at = placed_at_.find(mote.id);
    if (mote.path.empty() && at != placed_at_.end() && reported.insert(at->second).second)
      problems.add(at->second,
                   "mote `" + mote.name + "` is unreachable: no chain of motes at most " +
                       metres_text(*range_m_) +
                       " apart leads to its sink; place it nearer, add motes between, or "
                       "raise `range` in [radio]");
  }
}

bool island_motes::check_node(mote_id id, const std::string& name, mark at,
                              complaints& problems) const {
  const auto* gains = std::get_if<radio::gain_matrix>(&with_.radio.propagation);
  if (!with_.radio_is_known || gains == nullptr || gains->table == nullptr)
    return true;
  const auto who = "mote `" + name + "` with the id " + to_string(id);
  if (id.value < gains->first_mote) {
    problems.add(at, who + " is before `first_mote` of the topology, which is " +
                         std::to_string(gains->first_mote));
    return false;
  }
  const auto node = static_cast<std::uint16_t>(id.value - gains->first_mote);
  if (!with_.nodes[node]) {
    problems.add(at, who + " is node " + std::to_string(node) +
                         " of the topology, which has no gain to or from it");
    return false;
  }
  if (std::holds_alternative<radio::table_noise>(with_.radio.noise) &&
      !has_floor(*gains->table, node)) {
    problems.add(at, who + " is node " + std::to_string(node) +
                         " of the topology, which has no noise for it");
    return false;
  }
  return true;
}

void island_motes::note_flows(mote_id from, const std::vector<placed_app>& apps,
                              complaints& problems) {
  for (const auto& each : apps) {
    const auto refuse_self = [&](std::size_t end, mote_id x) {
      if (x == from && from != mote_id{})
        problems.add(each.ends[end].at, "a mote cannot send to itself");
    };
    if (const auto* sender = std::get_if<traffic::sender_config>(&each.app)) {
      refuse_self(0, sender->to);
      if (sender->via)
        refuse_self(1, *sender->via);
      flows_.emplace(placed_flow{sender->to, sender->via, each.ends[0].at, each.ends[1].at}, from);
    } else if (const auto* relay = std::get_if<traffic::relay_config>(&each.app)) {
      refuse_self(0, relay->next);
      relays_.emplace(from, relay->next);
    } else if (std::holds_alternative<traffic::receiver_config>(each.app)) {
      receivers_.insert(from);
    }
  }
}

std::string island_motes::name_of(mote_id id) const {
  if (id == island_.sink.id)
    return std::string(sink_name);
  const auto found = std::find_if(island_.motes.begin(), island_.motes.end(),
                                  [id](const auto& x) { return x.id == id; });
  return found == island_.motes.end() ? to_string(id) : found->name;
}

void island_motes::finish(complaints& problems) {
  constexpr unsigned hops_max = 1024;
  std::sort(island_.motes.begin(), island_.motes.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  check_connectivity(problems);
  check_tick(traffic_, island_.serial, with_.tick, vectors_at_, problems);
  // Where radios sleep there are no slots: channels have schedules, or receivers no certain time.
  if (!programs_at_.empty() && !island_.duty.enabled && !island_.listening.enabled())
    check_slots(slot_needs(island_, range_m_, access_of(with_.radio, island_), programs_at_),
                with_.tick, problems);
  for (const auto& [flow, from] : flows_) {
    if (flow.to != broadcast_mote && !receivers_.contains(flow.to))
      problems.add(flow.to_at, "mote `" + name_of(flow.to) + "` has no app = \"receiver\"");
    if (!flow.via)
      continue;
    auto at = *flow.via;
    for (unsigned hops = 0; at != flow.to; ++hops) {
      const auto next = relays_.find(at);
      if (next == relays_.end()) {
        problems.add(flow.via_at, "mote `" + name_of(at) + "` on the route to `" +
                                      name_of(flow.to) + "` has no app = \"relay\"");
        break;
      }
      if (hops == hops_max) {
        problems.add(flow.via_at, "through `" + name_of(*flow.via) + "` packets do not reach `" +
                                      name_of(flow.to) + "` within 1024 hops");
        break;
      }
      at = next->second;
    }
  }
}

} // namespace rubicon::config
