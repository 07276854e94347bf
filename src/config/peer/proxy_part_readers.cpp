#include "config/peer/proxy_part_readers.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>

#include "config/island/mote_readers.hpp"
#include "config/island/size_check.hpp"
#include "config/toml/units.hpp"
#include "core/text/spelling.hpp"
#include "proxy/classes/class_table.hpp"
#include "proxy/classes/tuple_template.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t template_octets_max = 200;
constexpr std::size_t json_fields_max = 32;

/// A key with names in braces.
struct template_key {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    if (found != nullptr && found->size() <= 100 && is_good(*found))
      return *found;
    return who.refuse(x, "1 to 7 parts between dots, at most 100 characters, each of letters, "
                         "digits, -, _ and names in braces, as in \"{room}.climate\"");
  }

  [[nodiscard]] static form takes() {
    return string_form("1 to 7 parts between dots, at most 100 characters");
  }

private:
  static bool is_good(const std::string& x) {
    const auto parts = proxy::template_parts(x);
    if (!parts || x.find("{{") != std::string::npos || x.find("}}") != std::string::npos)
      return false;
    std::string plain; // a letter for each name: what is left must be a key
    for (const auto& part : *parts)
      plain += part.is_name ? "n" : part.text;
    reading ignored;
    return config::read(tuple_key{}, node{{}, plain}, asker{"", ignored}).has_value();
  }
};

/// Text with names in braces.
struct template_text {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    const auto found = config::read(text{template_octets_max}, x, who);
    if (!found || proxy::template_parts(*found))
      return found;
    return who.refuse(x, "text in which { and } enclose a name, as in \"{temperature} C\"; {{ and "
                         "}} are braces");
  }
  [[nodiscard]] static form takes() { return string_form("text of 1 to 200 octets"); }
};

auto template_keys() {
  using proxy::tuple_template;
  return keys::of(
      keys::required(
          "key", &tuple_template::key, template_key{},
          "the whole key. In braces: `{island}`, `{id}`, `{name}` as in `prefix`; `{class}`; "
          "`{room}`, the property of that name, else the island's name; any property of the "
          "class. With `ids` `{channel}` instead of `{island}` and `{room}`"),
      keys::optional(
          "value", &tuple_template::text, template_text{},
          {"the same names; properties of [objects](#proxyobject), empty if an object lacks "
           "them; fields, and their units as `{FIELD.unit}`; `{{` and `}}` are braces",
           "either this"}),
      keys::optional(
          "json", &tuple_template::json, list_of<name_text>{{}, 1, json_fields_max},
          {"one JSON object: the `time` of the message in seconds of the ecology, and for each "
           "field its `value`, a number unless the field has words, and its `unit`, if it has one",
           "or this", "array of 1 to 32 names of fields"}));
}

auto class_program_keys() {
  return keys::of(keys::optional("program", &proxy::proxy_class::program, name_text{},
                                 {"of motes: code that completes the table; a file is rejected if "
                                  "the binary lacks the program. There is `occupancy`, see below; "
                                  "[others](architecture.md#proxies-with-code) are written in C++",
                                  "none"}));
}

/// Settings of a program, with the places that checks need.
struct program_numbers {
  named_values<double> settings;
};

auto keys_of(const program_numbers*) {
  return keys::of(keys::optional("settings", &program_numbers::settings, pairs_of<real>{},
                                 {"of the `program`", "none"}));
}

/// Names that keys and texts of the class may have: those known from the start.
std::vector<std::string> prior_names(const proxy::proxy_class& of) {
  auto names = of.ids.empty() ? proxy::mote_template_names() : proxy::object_template_names();
  for (const auto& [name, value] : of.properties)
    if (std::ranges::find(names, name) == names.end())
      names.push_back(name);
  return names;
}

/// Whether some objects of the class have such a property; of others it is an empty text.
bool is_of_some(const proxy::proxy_class& of, const std::string& name) {
  return std::ranges::any_of(of.objects, [&name](const auto& object) {
    return std::ranges::any_of(object.properties,
                               [&name](const auto& x) { return x.first == name; });
  });
}

std::vector<std::string> field_names(const proxy::proxy_class& of) {
  std::vector<std::string> names;
  for (const auto& x : of.fields)
    names.push_back(x.name);
  return names;
}

/// Where among a mote's programs the sampler that sends on the channel is; their number: nowhere.
std::size_t sampler_index(const mote_description& mote, std::uint16_t channel) {
  const auto sends_on_it = [channel](const mote_app& app) {
    const auto* const sampler = std::get_if<sampler_app>(&app);
    return sampler != nullptr && sampler->channel == channel;
  };
  return static_cast<std::size_t>(std::ranges::find_if(mote.apps, sends_on_it) - mote.apps.begin());
}

/// The sampler itself, or nullptr.
const sampler_app* sampler_on(const mote_description& mote, std::uint16_t channel) {
  const auto i = sampler_index(mote, channel);
  return i < mote.apps.size() ? &std::get<sampler_app>(mote.apps[i]) : nullptr;
}

/// Calls `use` with the name, as in `kitchen/fan`, and each mote that a class claims.
template <class Islands, class Use>
void each_mote_of(const std::string& proxy, const proxy::class_table& table, Islands& islands,
                  Use use) {
  for (auto& island : islands) {
    for (auto& mote : island.motes) {
      const auto* const its = table.find(proxy::signature_of({island.id, mote.id}, mote.type));
      if (its != nullptr && its->name == proxy)
        use(island.name + '/' + mote.name, mote);
    }
  }
}

/// How a mote sends the counts of a transducer.
struct sent_count {
  std::size_t offset = 0;
  double resolution = 1;

  friend bool operator==(const sent_count&, const sent_count&) = default;
};

std::optional<sent_count> count_of(const mote_description& mote, std::uint16_t channel,
                                   device::quantity kind) {
  const auto* const sampler = sampler_on(mote, channel);
  if (sampler == nullptr)
    return std::nullopt;
  const auto& sent = sampler->transducers;
  const auto at = std::ranges::find(sent, kind);
  if (at == sent.end())
    return std::nullopt;
  sent_count out{static_cast<std::size_t>(at - sent.begin()) * 2, 1}; // 1 of the signal
  const auto is = std::ranges::find(mote.transducers, kind, &device::transducer_config::kind);
  if (is != mote.transducers.end())
    out.resolution = is->resolution;
  return out;
}

} // namespace

void tuple_names::add(const std::string& name, mark at, complaints& problems) {
  constexpr std::array<std::string_view, 6> set_by_all{"status", "class",     "id",
                                                       "island", "interface", "position"};
  if (std::ranges::find(set_by_all, name) != set_by_all.end())
    problems.add(at, "`" + name + "` is a tuple that proxies set by themselves");
  names_.add(name, "name", at, problems);
}

placed_template read_tuple_template(table_reader& in) {
  placed_template out;
  in.all(out.what, template_keys());
  out.key_at = in.at("key");
  out.text_at = in.at(in.has("json") ? "json" : "value");
  if (in.has("value") == in.has("json"))
    in.problems().add(in.at(), "a tuple needs either `value`, a text, or `json`, names of fields");
  return out;
}

void check_tuple_template(const placed_template& x, const proxy::proxy_class& of,
                          complaints& problems) {
  const auto prior = prior_names(of);
  const auto is_prior = [&prior](const auto& name) {
    return std::ranges::find(prior, name) != prior.end();
  };
  if (const auto parts = proxy::template_parts(x.what.key)) {
    for (const auto& part : *parts)
      if (part.is_name && !is_prior(part.text))
        problems.add(x.key_at, "a key has no {" + part.text + '}' + suggestion(part.text, prior));
  }
  std::vector<std::string> used = x.what.json;
  if (const auto parts = proxy::template_parts(x.what.text)) {
    for (const auto& part : *parts)
      if (part.is_name && !is_prior(part.text) && !is_of_some(of, part.text))
        used.push_back(part.text);
  }
  const auto text_of = [](const proxy::reading_source& from) {
    return (from.is_stream ? "stream " : "channel ") + std::to_string(from.number);
  };
  std::optional<proxy::reading_source> source;
  for (const auto& name : used) {
    const auto* const field = proxy::field_named(of, name);
    if (field == nullptr) {
      auto known = field_names(of);
      if (x.what.json.empty())
        known.insert(known.end(), prior.begin(), prior.end());
      problems.add(x.text_at, "the proxy has no field `" + name + '`' + suggestion(name, known));
    } else if (source && *source != field->source()) {
      problems.add(x.text_at, "`" + name + "` is of " + text_of(field->source()) + ", not of " +
                                  text_of(*source) + ": the fields of a tuple come in one message");
    } else if (!x.what.json.empty() && name == "time") {
      problems.add(x.text_at, "`time` is in every JSON object: its field needs another name");
    } else {
      source = field->source();
    }
  }
}

void read_program(table_reader& in, const proxy::program_registry& programs, tuple_names& names,
                  proxy::proxy_class& out) {
  program_numbers numbers;
  in.all(out, class_program_keys());
  in.all(numbers);
  const auto& found = numbers.settings;
  const bool named = in.is_good("program");
  const bool set = in.is_good("settings");
  if (set && !in.has("program"))
    in.problems().add(in.at("settings"), "`settings` are those of a `program`");
  const auto* const make = named ? programs.find(out.program) : nullptr;
  if (named && make == nullptr)
    in.problems().add(in.at("program"), "no program is named `" + out.program + '`' +
                                            suggestion(out.program, programs.names()));
  if (make == nullptr)
    return;
  proxy::program_settings settings;
  for (const auto& [key, value] : found)
    settings.emplace_back(key.value, value);
  auto made = (*make)(out, settings);
  if (const auto* wrong = std::get_if<proxy::program_problem>(&made)) {
    const auto of = std::ranges::find_if(
        found, [wrong](const auto& x) { return x.first.value == wrong->setting; });
    in.problems().add(of == found.end() ? in.at("program") : of->first.at,
                      '`' + (of == found.end() ? out.program : of->first.value) + "` " +
                          wrong->message);
    return;
  }
  out.make_program = std::get<proxy::program_factory>(std::move(made));
  for (const auto& name : out.make_program()->names())
    names.add(name, in.at("program"), in.problems());
}

void check_streams(const std::vector<placed_stream>& all,
                   const std::vector<proxy::proxy_class>& classes,
                   const std::vector<island_description>& islands,
                   const std::vector<peer_description>& peers, complaints& problems) {
  const auto reads_it = [](const peer_description& peer, std::uint16_t number) {
    return std::ranges::any_of(peer.apps, [number](const peer_app& app) {
      const auto* program = std::get_if<apps::app_config>(&app);
      return program != nullptr && std::ranges::count(streams_read(*program), number) > 0;
    });
  };
  const proxy::class_table table(classes);
  for (auto x = all.begin(); x != all.end(); ++x) {
    const auto number = std::to_string(x->what.number);
    const auto before = std::find_if(
        all.begin(), x, [x](const auto& y) { return y.what.number == x->what.number; });
    if (before != x) {
      if (before->proxy != x->proxy)
        problems.add(x->at, "stream " + number + " is read by proxies of `" + before->proxy + '`');
      else if (before->what.every != x->what.every)
        problems.add(x->at, "the fields of a stream need the same `every`");
      continue;
    }
    std::size_t motes = 0;
    each_mote_of(x->proxy, table, islands, [&](const auto&, const auto&) { ++motes; });
    if (motes > 1)
      problems.add(x->at, std::to_string(motes) + " motes are of this class, but stream " + number +
                              " can be read by the proxy of one: a class of its own");
    for (const auto& peer : peers)
      if (std::ranges::any_of(
              peer.apps,
              [](const peer_app& app) { return std::holds_alternative<proxy_manager_app>(app); }) &&
          reads_it(peer, x->what.number))
        problems.add(x->at, "stream " + number + " is read by a program of `" + peer.name +
                                "`, where the proxies are");
  }
}

void place_computations(const std::vector<placed_computation>& all,
                        const std::vector<proxy::proxy_class>& classes,
                        std::vector<island_description>& islands, complaints& problems) {
  const proxy::class_table table(classes);
  for (const auto& x : all) {
    const auto* const of = table.find(x.proxy);
    const auto* const field = of == nullptr ? nullptr : proxy::field_named(*of, x.field);
    if (field == nullptr || field->mean_of <= 1)
      continue;
    each_mote_of(x.proxy, table, islands, [&](const std::string& name, mote_description& mote) {
      const auto* const sampler = sampler_on(mote, field->channel);
      const auto index = field->offset / 2;
      if (sampler == nullptr || field->layout != proxy::encoding::i16 || field->offset % 2 != 0 ||
          index >= sampler->transducers.size()) {
        problems.add(x.at, "mote `" + name +
                               "` has no sampler that sends a count there that it could average");
        return;
      }
      auto& apps = mote.apps.edit();
      auto& averaging = std::get<sampler_app>(apps[sampler_index(mote, field->channel)]);
      averaging.mean_of.resize(averaging.transducers.size(), 1);
      averaging.mean_of[index] = field->mean_of;
    });
  }
}

/// Channels of the class's fields on which all its motes have samplers that stamp.
std::vector<std::uint16_t> stamped_channels_of(const proxy::proxy_class& of,
                                               const proxy::class_table& table,
                                               const std::vector<island_description>& islands) {
  std::map<std::uint16_t, bool> stamped; // and by all
  each_mote_of(of.name, table, islands, [&](const auto&, const mote_description& mote) {
    for (const auto& field : of.fields) {
      if (field.stream)
        continue;
      const auto* const sampler = sampler_on(mote, field.channel);
      auto& by_all = stamped.try_emplace(field.channel, true).first->second;
      by_all = by_all && sampler != nullptr && sampler->stamped;
    }
  });
  std::erase_if(stamped, [](const auto& x) { return !x.second; });
  std::vector<std::uint16_t> all;
  for (const auto& [channel, by_all] : stamped)
    all.push_back(channel);
  return all;
}

void place_stamps(std::vector<proxy::proxy_class>& classes,
                  const std::vector<island_description>& islands) {
  const proxy::class_table table(classes);
  for (auto& of : classes) {
    of.stamped_channels = stamped_channels_of(of, table, islands);
    for (auto& field : of.fields) {
      if (field.stream || field.layout != proxy::encoding::u32 || !field.words.empty())
        continue;
      std::size_t stamps = 0;
      std::size_t others = 0;
      each_mote_of(of.name, table, islands, [&](const auto&, const mote_description& mote) {
        const auto* const sampler = sampler_on(mote, field.channel);
        const bool is_one = sampler != nullptr && sampler->stamped &&
                            field.offset == 2 * sampler->transducers.size();
        ++(is_one ? stamps : others);
      });
      if (stamps > 0 && others == 0)
        field.layout = proxy::encoding::stamp;
    }
  }
}

void place_transducers(const std::vector<placed_transducer>& all,
                       std::vector<proxy::proxy_class>& classes,
                       const std::vector<island_description>& islands, reading& shared) {
  auto& problems = shared.problems;
  const proxy::class_table table(classes);
  for (const auto& x : all) {
    const auto of = std::ranges::find(classes, x.proxy, &proxy::proxy_class::name);
    const auto field = std::ranges::find(of->fields, x.field, &proxy::field::name);
    const auto& what = shared.quantities.word_of(x.kind);
    const auto from = "on channel " + std::to_string(field->channel);
    std::optional<sent_count> agreed;
    std::string first; // the mote that has it so
    bool good = true;  // the first mistake will do
    each_mote_of(x.proxy, table, islands, [&](const std::string& name, const auto& mote) {
      const auto found = good ? count_of(mote, field->channel, x.kind) : std::nullopt;
      if (good && !found)
        problems.add(x.at, "mote `" + name + "` has no sampler that sends `" + what + "` " + from);
      else if (good && agreed && *agreed != *found)
        problems.add(x.at, "motes `" + first + "` and `" + name + "` send `" + what +
                               "` with different units or scales: make one class for each, or set "
                               "`offset` and `scale`");
      good = good && found && (!agreed || *agreed == *found);
      if (!agreed) {
        agreed = found;
        first = name;
      }
    });
    if (good && !agreed)
      problems.add(x.at, "the file has no mote of this class whose `" + what + "` it could be");
    if (!agreed)
      continue;
    if (!x.has_offset)
      field->offset = agreed->offset;
    if (!x.has_scale)
      field->scale = agreed->resolution;
    if (!x.has_unit)
      field->unit = shared.quantities.unit_of(x.kind);
  }
}

} // namespace rubicon::config
