// [[fault]]: what goes wrong, and when.
#include <algorithm>
#include <utility>

#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

/// Of one fault; all of them are known before the run begins.
constexpr std::int64_t times_max = 100'000;
constexpr duration span_min = 1ms;

bool has_separate_app(const std::vector<mote_app>& all) {
  return std::ranges::any_of(all,
                             [](const auto& x) { return std::holds_alternative<separate_app>(x); });
}

/// What a reader of one kind needs, and what it fills.
struct kind_reader {
  const surroundings& with;
  const std::vector<island_description>& islands;
  fault& out;

  void battery_end(table_reader& in) const {
    battery_end_fault x;
    in.required(
        "mote", mote_name{true}, x.mote,
        "it sees that its battery ends, and tells its sink; a second later it is flat, for good");
    out = x;
  }

  void crash(table_reader& in) const {
    in.either({{"mote", [this](table_reader& x) { crash_mote(x); }},
               {"sink", [this](table_reader& x) { crash_sink(x); }}});
  }

  void crash_sink(table_reader& in) const {
    sink_crash_fault x;
    read_sink(in, x.island,
              "the sink of that island instead; its end of the serial cables is dead as long");
    in.optional("for", time_span{span_min}, x.length, "how long it is off");
    refuse(in, {"type"}, "sink");
    out = x;
  }

  void crash_mote(table_reader& in) const {
    crash_fault x;
    in.required("mote", mote_name{true}, x.mote,
                "its program fails; it is off for a while and then started again");
    in.optional("for", time_span{span_min}, x.length, "how long it is off");
    std::string type;
    if (in.optional("type", mote_type_name{with.types}, type,
                    {"with a single `mote`: what it is from its next start on; platform, power and "
                     "battery stay, and the type too once it was carried to another island",
                     "the one it has"}))
      x.becomes = of_another_type(in, x.mote, type);
    out = std::move(x);
  }

  /// The mote of the description; nullptr if there is none, about which somebody else complains.
  [[nodiscard]] const mote_description* find(const mote_address& x) const {
    for (const auto& island : islands) {
      if (island.id != x.island)
        continue;
      const auto found = std::ranges::find(island.motes, x.mote, &mote_description::id);
      return found == island.motes.end() ? nullptr : &*found;
    }
    return nullptr;
  }

  /// The mote at its place, with all that the type says but platform, battery and power.
  [[nodiscard]] std::optional<mote_description>
  of_another_type(table_reader& in, const mote_address& who, const std::string& type) const {
    const auto* before = find(who);
    if (who == any_mote)
      in.problems().add(in.at("type"), "`type` needs the name of one `mote`, not \"*\"");
    const auto profile = with.types.find(type);
    if (before == nullptr || profile == with.types.end())
      return std::nullopt;
    auto x = profile->second.mote();
    x.id = before->id;
    x.name = before->name;
    x.platform = before->platform;
    x.place = before->place;
    x.path = before->path;
    x.step = before->step;
    x.transmit_dbm = before->transmit_dbm;
    x.battery_mah = before->battery_mah;
    if (const auto* of = in.names().find(who.island); of != nullptr && !of->has_gateway)
      in.problems().add(in.at("type"),
                        "in an island with stack = \"mac\" nobody is told a mote's type");
    if (has_separate_app(before->apps) || has_separate_app(x.apps))
      in.problems().add(in.at("type"), "a mote with programs that are actors of their own keeps "
                                       "its type; leave `separate` out");
    if (std::ranges::any_of(x.apps, is_flow_app))
      in.problems().add(in.at("type"), "a mote of that type would be an end of flows, which are "
                                       "the same all the time");
    static_cast<void>(settle_traces(x.transducers, x.id, in.at("type"), in.shared()));
    return x;
  }

  /// A mote of an island with a gateway, by its name.
  void read_joining_mote(table_reader& in, mote_address& out_mote, const about& what) const {
    in.required("mote", mote_name{}, out_mote, what);
    if (const auto* of = in.names().find(out_mote.island); of != nullptr && !of->has_gateway)
      in.problems().add(in.at("mote"),
                        "a mote of an island with stack = \"mac\" does not join anything");
    if (const auto* mote = find(out_mote); mote != nullptr && has_separate_app(mote->apps))
      in.problems().add(in.at("mote"), "not a mote with programs that are actors of their own; "
                                       "leave `separate` out");
  }

  static constexpr about duplicate_length{"after this it ends without a word, its links reset",
                                          "to the end of the run"};

  void duplicate_id(table_reader& in) const {
    in.either({{"peer",
                [this](table_reader& x) {
                  refuse(x, {"position_m"}, "peer");
                  absence<duplicate_id_fault>(x, "whose id", duplicate_length);
                }},
               {"mote", [this](table_reader& x) { duplicate_mote(x); }}});
  }

  void duplicate_mote(table_reader& in) const {
    mote_double_fault x;
    read_joining_mote(in, x.mote, "the mote whose address, instead");
    in.required("position_m", place{}, x.place, "where that second mote is");
    in.optional("for", time_span{span_min}, x.length, duplicate_length);
    out = x;
  }

  void move_mote(table_reader& in) const {
    move_island_fault x;
    read_joining_mote(in, x.mote, "the mote that is carried to another island, instead; only once");
    in.required("to_island", island_name{}, x.to,
                "with `mote`: switched on there, it is a mote of this one, under its old id, in "
                "its next life");
    in.required("to_m", place{}, x.place, "where to");
    in.optional("for", time_span{span_min}, x.length, "with `mote`: how long it is off");
    if (in.sound() && x.to == x.mote.island)
      in.problems().add(in.at("to_island"),
                        "it is in that island already; a `path` of the mote lets it move there");
    if (const auto* to = in.names().find(x.to); in.sound() && to != nullptr) {
      if (!to->has_gateway)
        in.problems().add(in.at("to_island"),
                          "nobody joins an island with stack = \"mac\"; name another");
      if (to->sink == x.mote.mote || find({x.to, x.mote.mote}) != nullptr)
        in.problems().add(in.at("to_island"), "that island has a mote or sink with the id " +
                                                  to_string(x.mote.mote) +
                                                  " already; give one of them another `id`");
    }
    out = x;
  }

  /// These keys are of the other kinds of who is hit.
  static void refuse(table_reader& in, const std::vector<std::string>& keys, const char* of) {
    for (const auto& key : keys) {
      in.expect(key);
      if (in.has(key))
        in.problems().add(in.at(key), '`' + key + "` means nothing with `" + std::string(of) + '`');
    }
  }

  /// The sink of an island with a gateway.
  void read_sink(table_reader& in, island_id& island, const about& what) const {
    in.required("sink", island_name{true}, island, what);
    if (const auto* of = in.names().find(island); of != nullptr && !of->has_gateway)
      in.problems().add(in.at("sink"),
                        "the sink of an island with stack = \"mac\" only measures; name another");
    if (in.sound() && island == any_island && !has_full_stack())
      in.problems().add(in.at("sink"), "no island has a gateway, so that there is no sink to draw");
  }

  [[nodiscard]] bool has_full_stack() const {
    return std::ranges::any_of(islands, [](const auto& x) { return x.stack == stack::full; });
  }

  void noise(table_reader& in) const {
    noise_fault x;
    in.required("island", island_name{}, x.island, "in whose air");
    in.required("position_m", place{}, x.place, "where");
    in.optional("power", power_level{-100, 30}, x.transmit_dbm, "how strong");
    in.optional("duty", ratio{}, x.duty, {"share of the time that it sends", "", "ratio above 0"});
    in.optional("burst", time_span{100us, 1h}, x.burst,
                "how long each time, if not always; gaps are drawn from 0 to twice their mean");
    in.optional("for", time_span{span_min}, x.length, "how long in all");
    if (in.has("duty") && in.sound() && x.duty == 0)
      in.problems().add(in.at("duty"), "`duty` must be above 0: leave the fault out instead");
    if (in.has("kind") && with.radio_is_known &&
        std::holds_alternative<radio::gain_matrix>(with.radio.propagation))
      in.problems().add(in.at("kind"),
                        "with model = \"gains\" no place has a gain to anybody; choose another "
                        "model of the radio, or kind = \"radio_loss\"");
    out = x;
  }

  void radio_loss(table_reader& in) const {
    radio_loss_fault x;
    island_id island;
    in.required("loss", ratio{}, x.loss,
                "chance that a copy of a frame is lost on its way to a radio, beside `loss` of "
                "`[radio]` and its links");
    if (in.optional("island", island_name{true}, island,
                    {"to radios of this one only", "all islands"}))
      x.island = island;
    in.optional("for", time_span{span_min}, x.length, "how long");
    out = x;
  }

  void unplug(table_reader& in) const {
    unplug_fault x;
    peer_id gateway;
    if (in.optional(
            "gateway", peer_name{}, gateway,
            {"the one whose cable is out, and no other of its island", "", "name of a gateway"})) {
      const auto* of = gateway == any_peer ? nullptr : in.names().island_of_gateway(gateway);
      if (of == nullptr)
        in.problems().add(in.at("gateway"), "that is not the name of a gateway");
      else if (in.has("island"))
        in.problems().add(in.at("island"), "`island` means nothing with `gateway`");
      else
        x.island = of->id;
      x.gateway = gateway;
    } else if (!in.has("gateway")) {
      in.required_if(true, "island", island_name{true}, x.island,
                     {"whose serial cables are out; `\"*\"`: one cable of any island",
                      "with `gateway`, none"});
    }
    in.expect("island");
    if (const auto* island = in.names().find(x.island); island != nullptr && !island->has_gateway)
      in.problems().add(in.at("island"), "an island with stack = \"mac\" has no serial cable");
    in.optional("for", time_span{span_min}, x.length, "how long");
    out = x;
  }

  /// A peer that is away, or one too many, for a while or for good.
  template <class Fault>
  void absence(table_reader& in, const about& who, const about& length) const {
    Fault x;
    in.required("peer", peer_name{}, x.peer, who);
    in.optional("for", time_span{span_min}, x.length, length);
    out = x;
  }

  void pause(table_reader& in) const {
    pause_fault x;
    in.required("peer", peer_name{}, x.peer, "who");
    in.optional("for", time_span{span_min, 1h}, x.length, "how long");
    out = x;
  }

  void clock_step(table_reader& in) const {
    in.either({{"peer", [this](table_reader& x) { peer_step(x); }},
               {"mote", [this](table_reader& x) { crystal_step(x, false); }},
               {"sink", [this](table_reader& x) { crystal_step(x, true); }}});
  }

  void peer_step(table_reader& in) const {
    clock_step_fault x;
    in.required("peer", peer_name{}, x.peer, "whose clock is set");
    in.required("by", time_step{}, x.by, "forward or back");
    out = x;
  }

  void crystal_step(table_reader& in, bool is_sink) const {
    crystal_step_fault x;
    x.is_sink = is_sink;
    if (is_sink)
      read_sink(in, x.mote.island, "that of the island's sink, by which all its motes go");
    else
      in.required(
          "mote", mote_name{true}, x.mote,
          "the clock of its crystal instead; what it waits for comes earlier or later by as "
          "much");
    if (const auto* of = in.names().find(x.mote.island);
        !is_sink && of != nullptr && !of->has_gateway)
      in.problems().add(in.at("mote"),
                        "a mote of an island with stack = \"mac\" has no use for its clock");
    in.required("by", time_step{}, x.by, "forward or back");
    out = x;
  }

  void move(table_reader& in) const {
    in.either({{"peer", [this](table_reader& x) { move_peer(x); }},
               {"mote", [this](table_reader& x) { move_mote(x); }}});
  }

  void move_peer(table_reader& in) const {
    refuse(in, {"to_island", "for"}, "peer");
    move_fault x;
    in.required("peer", peer_name{}, x.peer, "whose computer");
    in.required("to_m", place{}, x.to, "where to");
    out = x;
  }

  void partition(table_reader& in) const {
    partition_fault x;
    std::vector<located<std::vector<located<std::vector<peer_id>>>>> groups;
    in.required("groups", list_of<list_of<peer_group_name>>{{{}, 1}, 1}, groups,
                {"the name of a table with `count` stands for all of its peers; those in no group "
                 "make one more",
                 "", "array of arrays of names of peers and gateways, at least 1 of each"});
    claims<peer_id> placed;
    for (const auto& group : groups) {
      auto& peers = x.groups.emplace_back();
      for (const auto& each : group.value)
        for (const auto id : each.value) {
          placed.claim(id, "the peer with the id " + to_string(id), each.at, in.problems(),
                       "is already in a group");
          peers.push_back(id);
        }
    }
    in.optional("for", time_span{span_min}, x.length, "how long");
    out = std::move(x);
  }

  void link_loss(table_reader& in) const {
    link_loss_fault x;
    std::vector<located<std::vector<peer_id>>> peers;
    in.required("loss", ratio{}, x.loss,
                "chance that a package is lost, beside `loss` of `[peis]`");
    if (in.optional("peers", list_of<peer_group_name>{{}, 1}, peers,
                    {"on links between two of these; the name of a table with `count` stands for "
                     "all of its peers",
                     "all links", "array of names of peers and gateways, at least 2"})) {
      for (const auto& each : peers)
        x.peers.insert(x.peers.end(), each.value.begin(), each.value.end());
      if (x.peers.size() < 2)
        in.problems().add(in.at("peers"), "a link has two ends: name another peer");
    }
    in.optional("for", time_span{span_min}, x.length, "how long");
    out = std::move(x);
  }
};

void read_kind(table_reader& in, const surroundings& with,
               const std::vector<island_description>& islands, fault& out) {
  const kind_reader read{with, islands, out};
  in.one_of(
      "kind", "what goes wrong",
      {{"battery_end", [&](table_reader& x) { read.battery_end(x); }},
       {"crash", [&](table_reader& x) { read.crash(x); }},
       {"unplug", [&](table_reader& x) { read.unplug(x); }},
       {"kill",
        [&](table_reader& x) {
          read.absence<kill_fault>(
              x, "who",
              {"after this it is started again, and knows nothing of its life before", "for good"});
        }},
       {"power_off",
        [&](table_reader& x) {
          read.absence<power_off_fault>(
              x, "who",
              {"after this it is started again; its links of before are reset then", "for good"});
        }},
       {"pause", [&](table_reader& x) { read.pause(x); }},
       {"partition", [&](table_reader& x) { read.partition(x); }},
       {"link_loss", [&](table_reader& x) { read.link_loss(x); }},
       {"duplicate_id", [&](table_reader& x) { read.duplicate_id(x); }},
       {"clock_step", [&](table_reader& x) { read.clock_step(x); }},
       {"move", [&](table_reader& x) { read.move(x); }},
       {"noise", [&](table_reader& x) { read.noise(x); }},
       {"radio_loss", [&](table_reader& x) { read.radio_loss(x); }}});
}

/// A time of a fault; not after the end of the run.
bool read_time(table_reader& in, std::string_view key, duration length, duration& out,
               const about& what) {
  if (!in.optional(key, time_span{}, out, what))
    return false;
  if (out > length)
    in.problems().add(in.at(key), '`' + std::string(key) +
                                      "` is after the end of the run, which is at " +
                                      to_text(length));
  return true;
}

/// every or random, from, until
void read_repetition(table_reader& in, duration length, fault_description& out) {
  fault_times x;
  duration until = length;
  const bool is_periodic = in.optional("every", time_span{span_min}, x.every,
                                       {"from one time to the next, at most 100000 times", "none"});
  in.optional("random", whole<std::uint32_t>{1, times_max}, x.count,
              {"how many times, at random moments from `from` to `until`", "none"});
  read_time(in, "from", length, x.from, "with `every` and `random`, not before this");
  if (read_time(in, "until", length, until,
                {"with `every` and `random`, not after this", "the end of the run"}))
    x.until = until;
  if (!in.has("every") && !in.has("random")) {
    for (const auto* key : {"from", "until"}) {
      if (in.has(key))
        in.problems().add(in.at(key),
                          '`' + std::string(key) + "` means nothing without `every` or `random`");
    }
    return;
  }
  if (in.has("every") && in.has("random"))
    in.problems().add(in.at("random"), "`random` means nothing with `every`");
  if (in.sound() && until < x.from)
    in.problems().add(in.at("until"),
                      "`until` must not be before `from`, which is " + to_text(x.from));
  else if (in.sound() && is_periodic && (until - x.from) / x.every >= times_max)
    in.problems().add(in.at("every"), "that is more than " + std::to_string(times_max) + " times");
  out.at = x.from;
  out.repeated = x;
}

fault_description read_fault(table_reader& in, const surroundings& with,
                             const std::vector<island_description>& islands, duration length) {
  fault_description out;
  const bool repeated = in.has("every") || in.has("random");
  const about when{"when it happens; required without `every` and `random`"};
  if (!repeated && !in.has("at")) {
    in.required_if(true, "at", time_span{}, out.at, when); // is missing
  } else if (read_time(in, "at", length, out.at, when) && repeated) {
    in.problems().add(in.at("at"), "`at` means nothing with `every` or `random`");
  }
  read_repetition(in, length, out);
  read_kind(in, with, islands, out.what);
  return out;
}

} // namespace

std::vector<fault_description> read_faults(table_reader& root, const surroundings& with,
                                           const std::vector<island_description>& islands,
                                           duration length) {
  std::vector<fault_description> out;
  root.tables("fault", "[[fault]]", "what goes wrong, and when",
              [&](table_reader& x) { out.push_back(read_fault(x, with, islands, length)); });
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.at < b.at; });
  return out;
}

} // namespace rubicon::config
