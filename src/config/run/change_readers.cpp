// [[change]]: what is to be another way from some moment on.
#include <algorithm>
#include <array>
#include <utility>

#include "apps/app_keys.hpp"
#include "config/file_readers.hpp"
#include "config/plan/debug_selection.hpp"
#include "config/plan/secret_key.hpp"
#include "config/run/change_text.hpp"
#include "config/run/key_changes.hpp"
#include "proxy/classes/class_keys.hpp"

namespace rubicon::config {

namespace {

using keys::of;
using keys::optional;
using keys::required;

/// A pattern, or a list of them, as debug_selection has them.
struct debug_pattern_list {
  using type = std::vector<std::string>;

  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who) {
    type found;
    if (const auto* text = x.as<std::string>())
      return debug_patterns(*text);
    const auto* all = x.as<node_array>();
    if (all == nullptr)
      return who.refuse(x, "an array of patterns, or a text with some");
    for (const auto& each : *all) {
      const auto* text = each.as<std::string>();
      if (text == nullptr)
        return who.refuse(each, "a text");
      std::ranges::move(debug_patterns(*text), std::back_inserter(found));
    }
    return found;
  }

  [[nodiscard]] static form takes() {
    const auto list = list_form(string_form("pattern"), 0, debug_patterns_max);
    return {"array of patterns, or a text with some",
            either_schema(list.schema, type_schema("string"))};
  }
};

/// What people may want to change, and what is to be said of it.
struct fixed_kind {
  std::string_view word;
  std::string_view why;
};

constexpr std::string_view is_decided = "is fixed when the run begins";

constexpr std::array fixed_kinds{
    fixed_kind{"name", "names the outputs of the run"},
    fixed_kind{"seed", "determines all random numbers from the start; run again with `--seed`"},
    fixed_kind{"mode", "is fixed for the whole run; run again with `--mode`"},
    fixed_kind{"duration", "is fixed for the whole run; run again with `--for`"},
    fixed_kind{"start", is_decided},
    fixed_kind{"network",
               "identifies the network of the peers; those of two networks never connect"},
    fixed_kind{"tick", "is shared by all motes and PCs from the start"},
    fixed_kind{"radio", "determines the links; change one with kind = \"link\", or all for a time "
                        "with a fault of kind = \"radio_loss\""},
    fixed_kind{"island", is_decided},
    fixed_kind{"air", is_decided},
    fixed_kind{"mote", "exists from the start; a fault of kind = \"crash\" can give it another "
                       "`type`, one of kind = \"move\" another island"},
    fixed_kind{"mote_type", is_decided},
    fixed_kind{"peer", "exists from the start; a fault of kind = \"kill\" ends it"},
    fixed_kind{"host", is_decided},
    fixed_kind{"expect", "is judged from the start"},
};

auto change_time_keys() {
  return of(required("at", &fault_description::at, time_of_run{}, "time from which it applies"));
}

auto class_keys() {
  using proxy::class_change;
  return of(required("class", &class_change::class_name, text{}, "name of a [[proxy]]"));
}

auto class_field_keys() {
  return of(optional("field", &proxy::class_change::field, text{},
                     {"the field that the next keys change", "none"}));
}

auto program_keys() {
  return of(required("mote", &program_change::mote, mote_name{}, "mote with the program"),
            optional("sampler", &program_change::sampler, whole<std::uint16_t>{0, 255},
                     {"its channel", "the mote's only sampler or messenger"}),
            optional("messenger", &program_change::messenger, whole<std::uint16_t>{0, 255},
                     {"its AM type, instead", "the same"}));
}

/// The key `every` of a program, as kind = "rate" has it.
struct new_rate {
  duration period{};
};

auto rate_keys() {
  return of(required("period", &new_rate::period, apps::report_period,
                     "period of its messages, also after the mote was restarted; a period "
                     "requested from the gateway takes precedence"));
}

auto link_keys() {
  return of(required("from", &link_change::from, radio_name{}, "sender"),
            required("to", &link_change::to, radio_name{}, "receiver"),
            optional("loss", &link_change::loss, ratio{},
                     {"probability that a copy is lost on this link", "as before"}),
            optional("gain", &link_change::gain_db, decibels{-200, 20},
                     {"received dBm at 0 dBm sent", "as before"}));
}

auto network_keys_keys() {
  return of(
      required("network_key", &network_keys_change::network_key, secret_key{"smepp.network_key"},
               "encrypts all frames from then on"),
      optional("network_mac", &network_keys_change::network_mac, secret_key{"smepp.network_mac"},
               {"authenticates them", "as before"}),
      optional("motes", &network_keys_change::motes, list_of<mote_name>{{}, 1},
               {"motes that receive the keys; others are left behind", "all motes with `member`"}));
}

class change_reader {
public:
  change_reader(const ecology_description& all, change& out) : all_(all), out_(out) {}

  void read(table_reader& in) {
    if (refuse_fixed(in))
      return;
    const auto within = in.title(); // faults and expectations have kinds of their own
    using choices = std::vector<std::pair<std::string_view, table_reader::part_reader>>;
    in.one_of(
        "kind", "what changes",
        choices{{"debug",
                 one(of(required(
                     "of", &debug_change::of, debug_pattern_list{},
                     "actors whose messages `--debug-dir` has from then on; none: no actor's")))},
                {"rate", [this](table_reader& x) { read_rate(x); }},
                {"program", [this](table_reader& x) { read_program(x); }},
                {"link", one(link_keys())},
                {"proxy_class", [this](table_reader& x) { read_class(x); }},
                {"network_keys", one(network_keys_keys())}},
        within);
  }

private:
  template <class... Keys>
  table_reader::part_reader one(const std::tuple<Keys...>& list) {
    return [this, list](table_reader& in) {
      in.either(
          [&](auto x) {
            if (in.sound() && !in.walks())
              check(in, x);
            out_ = std::move(x);
          },
          list);
    };
  }

  void read_rate(table_reader& in) {
    program_change x;
    new_rate rate;
    in.all(x, program_keys());
    in.all(rate, rate_keys());
    x.settings.push_back({"every", rate.period});
    if (in.sound() && !in.walks())
      check(in, x, program_of(in, x), "period");
    out_ = std::move(x);
  }

  void read_program(table_reader& in) {
    program_change x;
    in.all(x, program_keys());
    const auto* program = in.sound() && !in.walks() ? program_of(in, x) : nullptr;
    if (program == nullptr || std::holds_alternative<sampler_app>(*program))
      read_key_changes<sampler_app>(in, x.settings);
    if (program == nullptr || std::holds_alternative<messenger_app>(*program))
      read_key_changes<messenger_app>(in, x.settings);
    if (in.sound() && !in.walks())
      check(in, x, program, "every");
    if (in.sound() && !in.walks() && x.settings.empty())
      in.problems().add(in.at(), "no change of the program is given");
    out_ = std::move(x);
  }

  void read_class(table_reader& in) {
    proxy::class_change x;
    in.all(x, class_keys());
    read_key_changes<proxy::proxy_settings>(in, x.settings);
    in.all(x, class_field_keys());
    read_key_changes<proxy::field>(in, x.field_settings);
    if (in.sound() && !in.walks())
      check(in, x);
    out_ = std::move(x);
  }

  /// @returns whether it asks for what cannot change
  static bool refuse_fixed(table_reader& in) {
    const auto* kind = in.content().find("kind");
    const auto* word = kind == nullptr ? nullptr : kind->as<std::string>();
    const auto why = word == nullptr ? std::string_view() : why_fixed(*word);
    if (why.empty())
      return false;
    in.problems().add(in.at("kind"), '`' + *word + "` cannot change while an ecology runs: it " +
                                         std::string(why));
    for (const auto& each : *in.content().as<node_table>())
      in.expect(each.key); // nothing else is to be said of it
    return true;
  }

  static void refuse(table_reader& in, std::string_view key, std::string why) {
    in.problems().add(in.at(key), std::move(why));
  }

  void check(table_reader& in, debug_change& x) const {
    if (auto why = debug_names(all_).problem(x.of); !why.empty())
      refuse(in, "of", std::move(why));
  }

  /// The program that a change is about, by which its channel or AM type becomes known; nullptr if
  /// there is none, which is reported.
  const mote_app* program_of(table_reader& in, program_change& x) const {
    if (x.sampler && x.messenger) {
      refuse(in, "messenger", "`messenger` has no effect with `sampler`");
      return nullptr;
    }
    const auto* mote = find(x.mote);
    if (mote == nullptr) {
      if (const auto* of = in.shared().names->find(x.mote.island);
          of != nullptr && !of->is_simulated)
        refuse(in, "mote", "that island has a real sink: nothing of its motes is simulated");
      return nullptr; // otherwise reported elsewhere
    }
    std::vector<const mote_app*> fitting;
    for (const auto& each : mote->apps)
      if (fits(each, x))
        fitting.push_back(&each);
    if (fitting.size() != 1) {
      refuse_program(in, x, fitting.empty());
      return nullptr;
    }
    if (const auto* messenger = std::get_if<messenger_app>(fitting.front()))
      x.messenger = messenger->am_type;
    else
      x.sampler = std::get<sampler_app>(*fitting.front()).channel;
    return fitting.front();
  }

  static bool fits(const mote_app& app, const program_change& x) {
    if (const auto* sampler = std::get_if<sampler_app>(&app))
      return x.sampler ? *x.sampler == sampler->channel : !x.messenger;
    if (const auto* messenger = std::get_if<messenger_app>(&app))
      return x.messenger ? *x.messenger == messenger->am_type : !x.sampler;
    return false;
  }

  static void refuse_program(table_reader& in, const program_change& x, bool none) {
    if (!none)
      refuse(in, "mote",
             "that mote has several samplers and messengers: choose one with `sampler` or "
             "`messenger`");
    else if (x.sampler || x.messenger)
      refuse(in, x.sampler ? "sampler" : "messenger", "that mote has no " + program_text(x));
    else
      refuse(in, "mote",
             "that mote has no sampler and no messenger; other programs keep their "
             "periods, which both ends of a stream or flow have agreed on");
  }

  /// What the other keys of a sampler have to do with its new period, which is at `key`.
  static void check(table_reader& in, const program_change& x, const mote_app* program,
                    const std::string& key) {
    const auto* app = program == nullptr ? nullptr : std::get_if<sampler_app>(program);
    const auto* every = keys::find(x.settings, "every");
    if (app == nullptr || every == nullptr)
      return;
    const auto period = std::get<duration>(*every);
    const auto than = [&](const char* how, const char* other, duration value) {
      refuse(in, key,
             '`' + key + "` must not be " + how + " than the sampler's `" + other + "`, which is " +
                 to_text(value));
    };
    if (period < app->jitter)
      than("shorter", "jitter", app->jitter);
    else if (period < app->every_min)
      than("shorter", "every_min", app->every_min);
    else if (!app->dead_band.empty() && period > app->silence_max)
      than("longer", "silence_max", app->silence_max);
  }

  void check(table_reader& in, link_change& x) const {
    if (!x.loss && !x.gain_db)
      in.problems().add(in.at(), "a link needs `loss`, `gain` or both");
    if (x.from == x.to)
      refuse(in, "to", "a link leads from one mote to another");
    else if (air_of(x.from.island) != air_of(x.to.island))
      refuse(in, "to", "the two use different radio media, which are isolated from each other");
    if (const auto* of = in.shared().names->find(x.from.island); of != nullptr && !of->is_simulated)
      refuse(in, "from", "that island has a real sink: its radio medium is not simulated");
  }

  void check(table_reader& in, proxy::class_change& x) const {
    const auto found = std::ranges::find(all_.proxies, x.class_name, &proxy::proxy_class::name);
    std::vector<std::string> known;
    for (const auto& each : all_.proxies)
      known.push_back(each.name);
    if (found == all_.proxies.end()) {
      refuse(in, "class",
             "no proxy class is named `" + x.class_name + '`' + suggestion(x.class_name, known));
      return;
    }
    if (found->types.empty())
      refuse(in, "class", "that class is for tagged objects; only classes for motes may change");
    check_field(in, x, *found);
    if (in.sound() && proxy::to_text(x).empty())
      in.problems().add(in.at(), "no change of the class is given");
  }

  void check(table_reader& in, network_keys_change& x) const {
    const auto is_member = [](const mote_description& mote) {
      return std::ranges::any_of(mote.apps, [](const mote_app& app) {
        return std::holds_alternative<smepp::member_config>(app);
      });
    };
    for (const auto& each : x.motes)
      if (const auto* mote = find(each); mote != nullptr && !is_member(*mote))
        refuse(in, "motes",
               '`' + mote->name + "` has no program `member`, and therefore no such keys");
    if (std::ranges::none_of(all_.islands, [&](const island_description& island) {
          return std::ranges::any_of(island.motes, is_member);
        }))
      in.problems().add(in.at(), "no mote has the program `member`: there are no network keys");
  }

  static void check_field(table_reader& in, const proxy::class_change& x,
                          const proxy::proxy_class& of) {
    for (const auto& each : x.field_settings)
      if (x.field.empty())
        refuse(in, each.key, '`' + each.key + "` needs `field`");
    if (x.field.empty())
      return;
    std::vector<std::string> known;
    for (const auto& each : of.fields)
      known.push_back(each.name);
    if (std::ranges::find(known, x.field) == known.end())
      refuse(in, "field", "the class has no field `" + x.field + '`' + suggestion(x.field, known));
  }

  [[nodiscard]] const mote_description* find(const mote_address& x) const {
    const auto island = std::ranges::find(all_.islands, x.island, &island_description::id);
    if (island == all_.islands.end() || island->outside.has_sink())
      return nullptr;
    const auto found = std::ranges::find(island->motes, x.mote, &mote_description::id);
    return found == island->motes.end() ? nullptr : &*found;
  }

  [[nodiscard]] const air_description* air_of(island_id island) const {
    const auto found = std::ranges::find_if(all_.airs, [island](const auto& x) {
      return std::ranges::find(x.islands, island) != x.islands.end();
    });
    return found == all_.airs.end() ? nullptr : &*found;
  }

  const ecology_description& all_;
  change& out_;
};

} // namespace

std::string_view why_fixed(std::string_view kind) {
  const auto* found = std::ranges::find(fixed_kinds, kind, &fixed_kind::word);
  return found == fixed_kinds.end() ? std::string_view() : found->why;
}

std::vector<fault_description> read_changes(table_reader& root, const surroundings& /*with*/,
                                            const ecology_description& all) {
  std::vector<fault_description> out;
  root.tables("change", "[[change]]",
              about("settings that change at a given time").changeable("further ones"),
              [&](table_reader& in) {
                fault_description x;
                change what;
                in.all(x, change_time_keys());
                change_reader(all, what).read(in);
                x.what = std::move(what);
                out.push_back(std::move(x));
              });
  sort_plan(out);
  return out;
}

} // namespace rubicon::config
