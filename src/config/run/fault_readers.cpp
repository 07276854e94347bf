// [[fault]]: what goes wrong, and when.
#include <algorithm>
#include <type_traits>
#include <utility>

#include "config/file_readers.hpp"
#include "config/run/fault_variation.hpp"

namespace rubicon::config {

namespace {

using keys::of;
using keys::optional;
using keys::required;

constexpr time_span span{1ms};

/// Of one fault; all of them are known before the run begins.
constexpr std::uint32_t fault_times_max = 100'000;

bool has_separate_app(const std::vector<mote_app>& all) {
  return std::ranges::any_of(all,
                             [](const auto& x) { return std::holds_alternative<separate_app>(x); });
}

auto unplugged_island_keys() {
  return of(keys::required_if(
      true, "island", &unplug_fault::island, island_name{true},
      {"island whose serial cables are unplugged; `\"*\"`: one cable of any island",
       "with `gateway` or `further_sink`, none"}));
}

/// What the keys of one fault have to do with each other and with the islands.
class fault_reader {
public:
  fault_reader(const surroundings& with, const std::vector<island_description>& islands, fault& out)
      : with_(with), islands_(islands), out_(out) {}

  void read(table_reader& in) {
    describe_motes();
    describe_peers();
    describe_either();
    describe_radio();
    in.one_of("kind", "kind of fault", choices_);
  }

private:
  /// @param lists of the keys of each struct that a fault of that kind may be
  template <class... Lists>
  void kind(std::string_view word, const Lists&... lists) {
    choices_.emplace_back(word, [this, lists...](table_reader& in) {
      const auto use = [&](auto x) {
        check(in, x);
        check_simulated(in, x);
        out_ = std::move(x);
      };
      in.either(use, lists...);
    });
  }

  void describe_motes() {
    kind("battery_end", of(required("mote", &battery_end_fault::mote, mote_name{true},
                                    "it detects a low battery and notifies its sink; a second "
                                    "later it is flat permanently")));
    kind("crash",
         of(required("mote", &crash_fault::mote, mote_name{true},
                     "its program fails; it is off for a while and then restarted"),
            optional("for", &crash_fault::length, span, "time until it is on again"),
            optional("type", &crash_fault::type, mote_type_name{},
                     {"with a single `mote`: its type from its next start on; platform, power and "
                      "battery stay, and so does the type once it was carried to another island",
                      "the one it has"})),
         of(required("sink", &sink_crash_fault::island, joined_sink_name{},
                     "the sink of that island instead; its serial cables are dead for that time"),
            optional("for", &sink_crash_fault::length, span, "time until it is on again")));
    kind("unplug",
         of(optional("gateway", &unplug_fault::gateway, gateway_name{},
                     "the one whose cable is unplugged; the island's other gateways keep theirs"),
            optional("further_sink", &unplug_fault::further_sink, mote_name{},
                     {"instead, the further sink whose backbone is cut", "none"}),
            optional("for", &unplug_fault::length, span, "length")));
  }

  void describe_peers() {
    kind("kill",
         of(required("peer", &kill_fault::peer, peer_name{}, "who"),
            optional("for", &kill_fault::length, span,
                     {"it is restarted after this time, without any state of its previous life",
                      "never"})));
    kind("power_off",
         of(required("peer", &power_off_fault::peer, peer_name{}, "who"),
            optional(
                "for", &power_off_fault::length, span,
                {"it is restarted after this time; its former links are then reset", "never"})));
    kind("pause", of(required("peer", &pause_fault::peer, peer_name{}, "who"),
                     optional("for", &pause_fault::length, time_span{1ms, 1h}, "length")));
    kind("partition", of(required("groups", &partition_fault::groups, peer_groups{},
                                  "the name of a table with `count` stands for all of its peers; "
                                  "peers in no group form one more group"),
                         optional("for", &partition_fault::length, span, "length")));
    kind("link_loss",
         of(required("loss", &link_loss_fault::loss, ratio{},
                     "probability that a package is lost, in addition to `loss` of `[peis]`"),
            optional("peers", &link_loss_fault::peers, linked_peers{},
                     {"on links between two of these; the name of a table with "
                      "`count` stands for all of its peers",
                      "all links"}),
            optional("for", &link_loss_fault::length, span, "length")));
  }

  void describe_either() {
    kind("duplicate_id",
         of(required("peer", &duplicate_id_fault::peer, peer_name{}, "peer whose id is duplicated"),
            optional("for", &duplicate_id_fault::length, span,
                     {"it stops after this time without notifying anyone; its links are reset",
                      "to the end of the run"})),
         of(required("mote", &mote_double_fault::mote, mote_name{},
                     "instead, the mote whose address is duplicated"),
            required("position_m", &mote_double_fault::place, place{},
                     "position of that second mote"),
            optional("for", &mote_double_fault::length, span,
                     {"it is switched off after this time", "to the end of the run"})));
    kind("clock_step",
         of(required("peer", &clock_step_fault::peer, peer_name{}, "peer whose clock is set"),
            required("by", &clock_step_fault::by, time_step{}, "forward or back")),
         of(required("mote", &crystal_step_fault::mote, mote_name{true},
                     "instead, the mote whose clock of island time is set; its timers go on"),
            required("by", &crystal_step_fault::by, time_step{}, "forward or back")),
         of(required("sink", &sink_step_fault::island, joined_sink_name{},
                     "the clock of the island's sink, the time source of its motes"),
            required("by", &sink_step_fault::by, time_step{}, "forward or back")));
    kind("move",
         of(required("peer", &move_fault::peer, peer_name{}, "peer whose computer is carried"),
            required("to_m", &move_fault::to, place{}, "target position")),
         of(required("mote", &move_island_fault::mote, mote_name{},
                     "instead, the mote that is carried to another island; only once"),
            required("to_island", &move_island_fault::to, island_name{},
                     "with `mote`: the island that it joins when switched on there, under its old "
                     "id, in its next life"),
            required("to_m", &move_island_fault::place, place{}, "target position"),
            optional("for", &move_island_fault::length, span,
                     "with `mote`: time until it is on again")));
  }

  void describe_radio() {
    kind("noise",
         of(required("island", &noise_fault::island, island_name{},
                     "island whose radio medium is disturbed"),
            required("position_m", &noise_fault::place, place{}, "where"),
            optional("power", &noise_fault::transmit_dbm, power_level{-100, 30}, "transmit power"),
            optional("channel", &noise_fault::channel, radio_channel,
                     {"channel that it disturbs", "all"}),
            optional("duty", &noise_fault::duty, ratio{},
                     {"share of the time that it transmits", "", "ratio above 0"}),
            optional("burst", &noise_fault::burst, time_span{100us, 1h},
                     "length of each transmission, if not continuous; gaps are drawn from "
                     "0 to twice their mean"),
            optional("for", &noise_fault::length, span, "total length")));
    kind("radio_loss", of(required("loss", &radio_loss_fault::loss, ratio{},
                                   "probability that a copy of a frame is lost, in addition to "
                                   "`loss` of `[radio]` and its links"),
                          optional("island", &radio_loss_fault::island, island_name{true},
                                   {"only at radios of this island", "all islands"}),
                          optional("for", &radio_loss_fault::length, span, "length")));
  }

  template <class Fault>
  void check(table_reader& /*in*/, Fault& /*x*/) const {}

  void check(table_reader& in, crash_fault& x) const {
    if (x.type.empty())
      return;
    if (x.mote == any_mote)
      in.problems().add(in.at("type"), "`type` needs the name of one `mote`, not \"*\"");
    const auto* before = find(x.mote);
    const auto profile = with_.types.find(x.type);
    if (before != nullptr && profile != with_.types.end())
      x.becomes = of_another_type(in, x.mote.island, *before, profile->second.mote());
  }

  void check(table_reader& in, mote_double_fault& x) const {
    check_joining(in, x.mote);
    refuse_further_sink(in, x.mote);
  }

  /// There is one cable, which holds its sink.
  void refuse_further_sink(table_reader& in, const mote_address& x) const {
    if (const auto* mote = find(x); mote != nullptr && mote->backbone)
      in.problems().add(in.at("mote"), "mote `" + mote->name +
                                           "` is a further sink, which stays at its cable: name "
                                           "another mote");
  }

  void check(table_reader& in, move_island_fault& x) const {
    check_joining(in, x.mote);
    refuse_further_sink(in, x.mote);
    const auto* to = in.shared().names->find(x.to);
    if (!in.sound() || to == nullptr)
      return;
    const auto refuse = [&in](std::string why) {
      in.problems().add(in.at("to_island"), std::move(why));
    };
    if (x.to == x.mote.island)
      refuse("it is in that island already; a `path` of the mote lets it move there");
    else if (!to->is_joined)
      refuse(
          "no mote can join an island with stack = \"mac\" or with a base station; name another");
    else if (to->sink == x.mote.mote || find({x.to, x.mote.mote}) != nullptr)
      refuse("that island has a mote or sink with the id " + to_string(x.mote.mote) +
             " already; give one of them another `id`");
  }

  void check(table_reader& in, crystal_step_fault& x) const {
    if (const auto* of = in.shared().names->find(x.mote.island); of != nullptr && !of->is_joined)
      in.problems().add(
          in.at("mote"),
          "a mote of an island with stack = \"mac\" or with a base station does not use its clock");
  }

  void check(table_reader& in, noise_fault& x) const {
    if (in.has("duty") && in.sound() && x.duty == 0)
      in.problems().add(in.at("duty"), "`duty` must be above 0: remove the fault instead");
    if (in.has("kind") && with_.radio_is_known &&
        std::holds_alternative<radio::gain_matrix>(with_.radio.propagation))
      in.problems().add(in.at("kind"), "with model = \"gains\" positions have no gains; choose "
                                       "another model of the radio, or kind = \"radio_loss\"");
  }

  void check(table_reader& in, unplug_fault& x) const {
    const bool has_further = in.has("further_sink");
    const bool has_gateway = in.has("gateway") || has_further;
    if (has_gateway)
      in.expect("island");
    else
      in.all(x, unplugged_island_keys());
    if (has_gateway && in.has("island"))
      in.problems().add(in.at("island"), has_further ? "`island` has no effect with `further_sink`"
                                                     : "`island` has no effect with `gateway`");
    if (has_further && in.has("gateway"))
      in.problems().add(in.at("gateway"), "`gateway` has no effect with `further_sink`");
    if (x.further_sink) {
      x.island = x.further_sink->island;
      if (const auto* mote = find(*x.further_sink); mote != nullptr && !mote->backbone)
        in.problems().add(in.at("further_sink"),
                          "mote `" + mote->name + "` is no further sink: it has no `backbone`");
    }
    if (x.gateway)
      x.island = in.shared().names->island_of_gateway(*x.gateway)->id;
    if (const auto* of = in.shared().names->find(x.island); of != nullptr && !of->has_gateway)
      in.problems().add(in.at("island"), "an island with stack = \"mac\" has no serial cable");
  }

  /// What is real has faults of its own.
  template <class Fault>
  void check_simulated(table_reader& in, const Fault& x) const {
    if constexpr (requires { x.mote; })
      refuse_real(in, "mote", x.mote.island);
    else if constexpr (std::is_same_v<Fault, sink_crash_fault> ||
                       std::is_same_v<Fault, sink_step_fault>)
      refuse_real(in, "sink", x.island);
    else if constexpr (std::is_same_v<Fault, noise_fault>)
      refuse_real(in, "island", x.island);
    else if constexpr (std::is_same_v<Fault, radio_loss_fault>)
      refuse_real(in, "island", x.island.value_or(any_island));
    if constexpr (std::is_same_v<Fault, move_island_fault>)
      refuse_real(in, "to_island", x.to);
  }

  static void refuse_real(table_reader& in, std::string_view key, island_id x) {
    if (const auto* of = in.shared().names->find(x); of != nullptr && !of->is_simulated)
      in.problems().add(in.at(key), "that island has a real sink: its motes and radio medium are "
                                    "not simulated, so they cannot fail");
  }

  /// The mote of the description; nullptr if there is none, which is reported elsewhere.
  [[nodiscard]] const mote_description* find(const mote_address& x) const {
    const auto island = std::ranges::find(islands_, x.island, &island_description::id);
    if (island == islands_.end())
      return nullptr;
    const auto found = std::ranges::find(island->motes, x.mote, &mote_description::id);
    return found == island->motes.end() ? nullptr : &*found;
  }

  /// The mote at its place, with all that the type says but platform, battery and power.
  [[nodiscard]] static mote_description of_another_type(table_reader& in, island_id island,
                                                        const mote_description& before,
                                                        mote_description x) {
    const auto refuse = [&in](const char* why) { in.problems().add(in.at("type"), why); };
    x.id = before.id;
    x.name = before.name;
    x.platform = before.platform;
    x.place = before.place;
    x.path = before.path;
    x.step = before.step;
    x.stays_when_flat = before.stays_when_flat;
    x.transmit_dbm = before.transmit_dbm;
    x.battery_mah = before.battery_mah;
    x.access = before.access;
    x.channel = before.channel;
    x.backbone = before.backbone;
    if (const auto* of = in.shared().names->find(island); of != nullptr && !of->is_joined)
      refuse("in an island with stack = \"mac\" or with a base station a mote does not report its "
             "type");
    if (has_separate_app(before.apps) || has_separate_app(x.apps))
      refuse("a mote with programs that are actors of their own keeps its type; leave `separate` "
             "out");
    if (std::ranges::any_of(x.apps, is_firmware))
      refuse("a mote of that type has firmware, and joins no island");
    if (std::ranges::any_of(x.apps, is_flow_app))
      refuse("a mote of that type would be an end of flows, which cannot change");
    static_cast<void>(settle_traces(x.transducers, x.id, in.at("type"), in.shared()));
    return x;
  }

  /// A mote that is to join an island is of one with a gateway.
  void check_joining(table_reader& in, const mote_address& x) const {
    if (const auto* of = in.shared().names->find(x.island); of != nullptr && !of->is_joined)
      in.problems().add(in.at("mote"), "a mote of an island with stack = \"mac\" or with a base "
                                       "station does not join anything");
    if (const auto* mote = find(x); mote != nullptr && has_separate_app(mote->apps))
      in.problems().add(in.at("mote"), "not a mote with programs that are actors of their own; "
                                       "leave `separate` out");
  }

  const surroundings& with_;
  const std::vector<island_description>& islands_;
  fault& out_;
  std::vector<std::pair<std::string_view, table_reader::part_reader>> choices_;
};

/// @param is_required whether neither `every` nor `random` is given
auto fault_time_keys(bool is_required) {
  return of(keys::required_if(is_required, "at", &fault_description::at, time_of_run{},
                              "time of the fault; required without `every` and `random`"));
}

/// every or random, from, until
void read_repetition(table_reader& in, fault_description& out) {
  fault_times x;
  in.all(x, of(optional("every", &fault_times::every, span,
                        {"interval of repetitions, at most 100000", "none"}),
               optional("random", &fault_times::count, whole<std::uint32_t>{1, fault_times_max},
                        {"number of times, at random moments from `from` to `until`", "none"}),
               optional("from", &fault_times::from, time_of_run{},
                        "with `every` and `random`, not before this"),
               optional("until", &fault_times::until, time_of_run{},
                        {"with `every` and `random`, not after this", "the end of the run"})));
  if (!in.has("every") && !in.has("random")) {
    for (const auto* key : {"from", "until"})
      if (in.has(key))
        in.problems().add(in.at(key),
                          '`' + std::string(key) + "` has no effect without `every` or `random`");
    return;
  }
  const auto until = x.until.value_or(in.shared().end);
  if (in.has("every") && in.has("random"))
    in.problems().add(in.at("random"), "`random` has no effect with `every`");
  if (in.sound() && until < x.from)
    in.problems().add(in.at("until"),
                      "`until` must not be before `from`, which is " + to_text(x.from));
  else if (in.sound() && x.every > 0s && (until - x.from) / x.every >= fault_times_max)
    in.problems().add(in.at("every"),
                      "that is more than " + std::to_string(fault_times_max) + " times");
  out.at = x.from;
  out.repeated = x;
}

} // namespace

std::vector<fault_description> read_faults(table_reader& root, const surroundings& with,
                                           const std::vector<island_description>& islands) {
  std::vector<fault_description> out;
  const bool varies = varies_faults(root.content());
  root.tables("fault", "[[fault]]", about("faults and their times").changeable("further ones"),
              [&](table_reader& in) {
                fault_description x;
                const bool repeated = in.has("every") || in.has("random");
                in.all(x, fault_time_keys(!repeated));
                if (in.is_good("at") && repeated)
                  in.problems().add(in.at("at"), "`at` has no effect with `every` or `random`");
                read_repetition(in, x);
                fault_reader(with, islands, x.what).read(in);
                const auto* kind = in.content().find("kind");
                const auto* word = kind == nullptr ? nullptr : kind->as<std::string>();
                if (!varies || word == nullptr || !leaves_out(with.seed, *word))
                  out.push_back(std::move(x));
              });
  sort_plan(out);
  return out;
}

} // namespace rubicon::config
