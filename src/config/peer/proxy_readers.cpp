#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <map>
#include <system_error>
#include <utility>

#include "config/file_readers.hpp"
#include "config/island/application_readers.hpp"
#include "config/peer/proxy_part_readers.hpp"
#include "proxy/classes/class_keys.hpp"
#include "proxy/classes/layout.hpp"
#include "proxy/classes/signature.hpp"

namespace rubicon::config {

namespace {

using proxy::encoding;

constexpr whole<std::uint16_t> message_channel{0, 255};

/// How a proxy's tuples begin: 1 to 5 parts, so that two more fit behind (TUP-03).
struct key_prefix {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    if (found != nullptr && found->size() <= 48 &&
        std::count(found->begin(), found->end(), '.') < 5 && is_good(*found))
      return *found;
    return who.refuse(x, "1 to 5 parts between dots, at most 48 characters, each of letters, "
                         "digits, -, _, {island}, {channel}, {id} and {name}");
  }

  [[nodiscard]] static form takes() { return string_form("1 to 5 parts, at most 48 characters"); }

private:
  static bool is_good(std::string_view x) {
    bool part_is_empty = true;
    while (!x.empty()) {
      if (x.front() == '.') {
        if (part_is_empty)
          return false;
        part_is_empty = true;
        x.remove_prefix(1);
        continue;
      }
      const auto size = placeholder_at(x);
      if (size == 0 && !is_name(x.substr(0, 1)))
        return false;
      part_is_empty = false;
      x.remove_prefix(std::max<std::size_t>(size, 1));
    }
    return !part_is_empty;
  }

  static std::size_t placeholder_at(std::string_view x) {
    for (const std::string_view each : {"{island}", "{channel}", "{id}", "{name}"}) {
      if (x.starts_with(each))
        return each.size();
    }
    return 0;
  }
};

/// @param also "stamp", which nobody writes
word<encoding> encoding_words(bool also_stamps) {
  word<encoding> all{{{"u8", encoding::u8},
                      {"i8", encoding::i8},
                      {"u16", encoding::u16},
                      {"i16", encoding::i16},
                      {"u32", encoding::u32},
                      {"i32", encoding::i32}}};
  if (also_stamps)
    all.choices.emplace_back("stamp", encoding::stamp);
  return all;
}

/// words = { "0" = "off" } of a field: every key is a count that its encoding can hold.
void read_field_words(table_reader& in, bool sized, proxy::field& out) {
  named_values<std::string> found;
  in.optional("words", pairs_of<text>{{32}}, found,
              {"words for counts, instead of numbers", "none",
               "`{ 0 = \"off\", 1 = \"on\" }`, texts of 1 to 32 octets"});
  const auto [least, most] = proxy::range_of(out.layout);
  for (auto& [key, value] : found) {
    const auto& digits = key.value;
    std::int64_t count = 0;
    const auto end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, count);
    const bool whole_number =
        error == std::errc{} && stop == end && std::to_string(count) == digits;
    if (sized && (!whole_number || count < least || count > most))
      in.problems().add(key.at, "a count of `words` must be a whole number from " +
                                    std::to_string(least) + " to " + std::to_string(most) +
                                    ", not " + in_quotes(digits));
    out.words.emplace_back(count, std::move(value));
  }
}

/// What other tables decide about a field of motes.
struct placed_fields {
  std::vector<placed_stream> streams;
  std::vector<placed_computation> computations;
  std::vector<placed_transducer> transducers;
};

/// transducer, of fields of motes.
void read_source(table_reader& in, const proxy::field& field, const std::string& of,
                 placed_fields& placed) {
  device::quantity kind{};
  if (in.optional("transducer", quantity_name{true}, kind,
                  {"transducer whose counts the [samplers](#app--sampler) of the class send on the "
                   "channel: it gives `offset`, its resolution as `scale` and its unit, where the "
                   "field has none",
                   "none", "quantity"}) &&
      !field.name.empty())
    placed.transducers.push_back({of, field.name, kind, in.at("transducer"), in.has("offset"),
                                  in.has("scale"), in.has("unit")});
  if (in.has("transducer") && in.has("encoding"))
    in.problems().add(in.at("encoding"), "`encoding` has no effect with `transducer`");
}

/// mean_of and computed_by, of fields of motes.
void read_computation(table_reader& in, proxy::field& field, const std::string& of,
                      std::vector<placed_computation>& computations) {
  in.optional("mean_of", whole<std::size_t>{1, proxy::mean_of_max}, field.mean_of,
              "of motes: the value is the mean of this many counts, rounded to a whole count");
  in.optional("computed_by", word<bool>{{{"proxy", false}, {"mote", true}}}, field.computed_by_mote,
              "node that computes that mean. With `\"mote\"` it is the [sampler](#app--sampler) of "
              "each mote of the class that sends on the channel; the tuples are the same");
  if (in.has("computed_by") && !in.has("mean_of"))
    in.problems().add(in.at("computed_by"), "`computed_by` needs `mean_of`: what is computed");
  if (field.mean_of > 1 && !field.words.empty())
    in.problems().add(in.at("mean_of"), "words have no mean");
  if (field.computed_by_mote)
    computations.push_back({of, field.name, in.at("computed_by")});
}

/// stream and every, of fields of motes.
void read_stream(table_reader& in, proxy::field& field, const std::string& of,
                 placed_fields& placed) {
  proxy::stream_input stream;
  const bool named =
      in.optional("stream", whole<std::uint16_t>{}, stream.number,
                  {"instead of `channel`: the proxy itself reads this stream of sensor records, "
                   "which a [`stream_writer`](#app--stream_writer) of a mote in any island writes "
                   "`to` the peer of the proxy manager; only for a class with a single mote",
                   "none"});
  in.optional("every", time_span{10ms, 24h}, stream.every, "of a stream: as its writer's");
  if (!named) {
    if (in.has("every"))
      in.problems().add(in.at("every"), "`every` needs a `stream`");
    return;
  }
  field.stream = stream;
  placed.streams.push_back({of, stream, in.at("stream")});
  for (const auto* key : {"channel", "offset", "encoding", "transducer", "computed_by"})
    if (in.has(key))
      in.problems().add(in.at(key), '`' + std::string(key) +
                                        "` has no effect with `stream`: it applies to messages");
}

void read_field(table_reader& in, tuple_names& names, placed_fields& placed,
                proxy::proxy_class& out) {
  proxy::field field;
  if (in.required("name", name_text{}, field.name, "last part of the key"))
    names.claim(field.name, in.at("name"), in.problems());
  if (out.ids.empty()) {
    in.required_if(!in.has("stream"), "channel", message_channel, field.channel,
                   "channel of the message it is read from; with `ids` there is none: it is read "
                   "from the tag's memory");
    read_stream(in, field, out.name, placed);
  }
  in.optional("offset", whole<std::size_t>{0, payload_octets_max - 1}, field.offset,
              "its first octet in the message, which has up to 100");
  const bool sized =
      in.optional("encoding", encoding_words(true), field.layout,
                  "encoding of its octets, in network byte order; `\"stamp\"`: four octets are the "
                  "time of a sampler with `stamped = true`, and the count is the whole [network "
                  "time](gateway.md#time) since 1970 in milliseconds") ||
      !in.has("encoding");
  in.all(field);
  read_field_words(in, sized, field);
  if (out.ids.empty()) {
    read_computation(in, field, out.name, placed.computations);
    read_source(in, field, out.name, placed);
  }
  if (field.offset + proxy::octets_of(field.layout) > payload_octets_max)
    in.problems().add(in.at("offset"), "the field ends beyond the " +
                                           std::to_string(payload_octets_max) +
                                           " octets that a message can carry");
  out.fields.push_back(std::move(field));
}

/// encoding and what belongs to it, of an input.
void read_numbers(table_reader& in, proxy::input& out) {
  proxy::number_form form;
  const bool sized = in.optional("encoding", encoding_words(false), form.layout,
                                 {"encoding of a number that is not a word: its count is the "
                                  "number less `add`, divided by `scale`, rounded",
                                  "it accepts no numbers"});
  in.optional("scale", real{}, form.scale, {"value of one count, not 0", "", "number, not 0"});
  in.optional("add", real{}, form.add, "value of the count 0");
  in.optional("unit", text{16}, out.unit,
              {"unit of the numbers, published with the range", "none"});
  for (const auto* key : {"scale", "add", "unit", "min", "max"})
    if (in.has(key) && !in.has("encoding"))
      in.problems().add(in.at(key),
                        '`' + std::string(key) +
                            "` applies to numbers, which the input accepts with `encoding` only");
  if (form.scale == 0) {
    in.problems().add(in.at("scale"), "`scale` must not be 0");
    form.scale = 1;
  }
  const auto [least, most] = proxy::range_of(form.layout);
  const auto [low, high] = std::minmax({static_cast<double>(least) * form.scale + form.add,
                                        static_cast<double>(most) * form.scale + form.add});
  form.min = low;
  form.max = high;
  in.optional("min", in.walks() ? real{} : real{low, high}, form.min,
              {"smaller numbers are refused", "limit of the encoding"});
  in.optional("max", in.walks() ? real{} : real{form.min, high}, form.max,
              {"larger ones are", "limit of the encoding", "number, at least `min`"});
  if (sized)
    out.numbers = form;
}

void read_input(table_reader& in, tuple_names& names, proxy::proxy_class& out) {
  proxy::input input;
  named_values<bytes> words;
  if (in.required("name", name_text{}, input.name, "last part of the key"))
    names.claim(input.name, in.at("name"), in.problems());
  in.required("channel", message_channel, input.channel, "channel on which the mote receives it");
  if (in.optional("meta", flag{}, input.meta,
                  "the input is the tuple that `PREFIX.mi-INPUT` points at, initially "
                  "`PREFIX.INPUT`: rewriting that [meta tuple](peis.md#meta-tuples) selects the "
                  "tuple that the actuator follows") &&
      input.meta && !input.name.empty())
    names.claim("mi-" + input.name, in.at("meta"), in.problems());
  read_numbers(in, input);
  const bool found =
      in.required_if(!in.has("encoding"), "words", pairs_of<hex_octets>{}, words,
                     {"1 to 100 octets in hexadecimal for each word", "none with `encoding`",
                      "`{ on = \"01\", off = \"00\" }`, at least 1"});
  if (found && words.empty())
    in.problems().add(in.at("words"), "`words` must have at least one word");
  for (auto& [key, octets] : words) {
    if (!is_name(key.value))
      in.problems().add(key.at, "a word must have 1 to 32 letters, digits, - and _, unlike " +
                                    in_quotes(key.value));
    input.words.emplace_back(key.value, std::move(octets));
  }
  out.inputs.push_back(std::move(input));
}

std::vector<std::pair<std::string, std::string>> read_properties(table_reader& in,
                                                                 tuple_names& names) {
  std::vector<std::pair<std::string, std::string>> out;
  named_values<std::string> found;
  in.optional("properties", pairs_of<text>{{200}}, found,
              {"published unchanged, under their names", "none"});
  for (auto& [key, value] : found) {
    if (!is_name(key.value))
      in.problems().add(key.at, "a property's name must have 1 to 32 letters, digits, - and _, "
                                "unlike " +
                                    in_quotes(key.value));
    names.claim(key.value, key.at, in.problems());
    out.emplace_back(key.value, std::move(value));
  }
  return out;
}

/// "rfid/e004": a kind of interface, and how ids begin there.
struct id_pattern {
  using type = proxy::id_prefix;

  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    const auto slash = found == nullptr ? std::string::npos : found->find('/');
    if (slash != std::string::npos) {
      const type out{found->substr(0, slash), folded(found->substr(slash + 1))};
      if (out.channel == "rfid" && (out.prefix.empty() || is_name(out.prefix)))
        return out;
    }
    return who.refuse(x, "\"rfid/\" and how ids begin, as in \"rfid/e004\"");
  }
  [[nodiscard]] static form takes() { return string_form("`\"rfid/e004\"`"); }
};

/// Who of a [[proxy.object]] it is: a mote by its name.
void read_known_mote(table_reader& in, name_claims& ids, proxy::known_object& found) {
  mote_address mote;
  if (in.required_if(true, "mote", mote_name{}, mote, "if the class has `types`")) {
    found.id = proxy::proxy_id(mote);
    ids.claim(found.id, "mote", in.at("mote"), in.problems());
  }
  in.optional("position_m", place{}, found.place,
              {"of a mote: its position, for a class with `indirect`", "not known"});
}

/// [[proxy.object]]
void read_object(table_reader& in, const tuple_names& of_class, name_claims& ids,
                 proxy::proxy_class& out) {
  proxy::known_object found;
  if (out.ids.empty() || in.walks()) {
    read_known_mote(in, ids, found);
  }
  if (!out.ids.empty() || in.walks()) {
    if (in.required_if(true, "id", name_text{}, found.id, "of its tag, if the class has `ids`"))
      ids.claim(found.id, "object", in.at("id"), in.problems());
    in.optional("name", name_text{}, found.name,
                {"for `{name}` of the prefix, the same", "its id"});
  }
  auto names = of_class;
  found.properties = read_properties(in, names);
  out.objects.push_back(std::move(found));
}

/// What the class claims: motes by their types, or tagged objects by their ids.
struct claimed {
  std::vector<located<proxy::type_range>> types;
  std::vector<located<proxy::id_prefix>> ids;
};

claimed read_claims(table_reader& in) {
  claimed out;
  in.optional("types", list_of<type_span>{{}, 1}, out.types,
              {"the motes' types it claims; of a mask, those that have this value under it",
               "either these"});
  in.optional("ids", list_of<id_pattern>{{}, 1}, out.ids,
              {"the ids of tags it claims, by their first part; `\"rfid/\"`: all", "or these"});
  if (in.has("types") == in.has("ids"))
    in.problems().add(in.at(),
                      "a proxy needs either `types`, of motes, or `ids`, of tagged objects");
  return out;
}

/// Some keys mean something for one of the two kinds of classes.
void check_kind(const table_reader& in, bool of_objects, const std::string& prefix) {
  const auto refuse = [&in](std::string_view key, const char* what) {
    in.problems().add(in.at(key), std::string(what));
  };
  if (of_objects && in.has("input"))
    refuse("input", "tagged objects have no inputs");
  for (const auto* key : {"qos", "indirect", "program"})
    if (of_objects && in.has(key))
      refuse(key, "only for motes, and the proxy has `ids` of tagged objects");
  if (prefix.find(of_objects ? "{island}" : "{channel}") != std::string::npos)
    refuse("prefix", of_objects ? "tagged objects have no {island}; use {channel}"
                                : "motes have an {island}, not a {channel}");
}

/// A range of types, where it stands, and whose it is.
struct placed_range {
  proxy::type_range types;
  mark at;
  std::string owner;
};

/// A type that both of two overlapping ones hold.
std::string common_type(const proxy::type_range& a, const proxy::type_range& b) {
  if (a.mask != 0 && b.mask != 0)
    return std::to_string(a.first | b.first);
  return std::to_string(std::max(a.first, b.first));
}

/// Of two overlapping ranges the narrower wins (PXY-11), so equally wide ones leave it open.
void check_overlaps(const std::vector<placed_range>& all, complaints& problems) {
  for (auto b = all.begin(); b != all.end(); ++b) {
    for (auto a = all.begin(); a != b; ++a) {
      if (a->owner == b->owner || !overlap(a->types, b->types) ||
          width(a->types) != width(b->types))
        continue;
      problems.add(b->at, "proxies `" + a->owner + "` and `" + b->owner + "` both claim type " +
                              common_type(a->types, b->types) + ", with equally wide ranges " +
                              place_text(a->at));
    }
  }
}

/// The places of the tables at `key` by their names.
std::map<std::string, mark, std::less<>> places_of(const table_reader& in, std::string_view key) {
  std::map<std::string, mark, std::less<>> out;
  const auto* given = in.value(key);
  const auto* array = given == nullptr ? nullptr : given->as<node_array>();
  if (array != nullptr)
    for (const auto& each : *array)
      if (const auto* name = each.find("name");
          name != nullptr && name->as<std::string>() != nullptr)
        out.emplace(*name->as<std::string>(), each.at);
  return out;
}

void note(const table_reader& in, const proxy::proxy_class& x) {
  in.shared().seen.classes.emplace(
      x.name, class_places{in.at("name"), in.at(in.has("prefix") ? "prefix" : "name"),
                           places_of(in, "field"), places_of(in, "input")});
}

} // namespace

std::vector<proxy::proxy_class> read_proxies(table_reader& root,
                                             const proxy::program_registry& programs,
                                             std::vector<island_description>& islands,
                                             const std::vector<peer_description>& peers) {
  std::vector<proxy::proxy_class> out;
  std::vector<placed_range> ranges;
  name_claims classes;
  name_claims ids;
  name_claims objects;
  placed_fields placed;
  root.tables(
      "proxy", "[[proxy]]", "decodes the octets of motes, or represents tagged objects",
      [&](table_reader& in) {
        proxy::proxy_class found;
        tuple_names names;
        if (in.required("name", name_text{}, found.name, "of the class"))
          classes.claim(found.name, "proxy name", in.at("name"), in.problems());
        auto claims_it = read_claims(in);
        for (const auto& [value, at] : claims_it.ids)
          ids.claim(value.channel + '/' + value.prefix, "id pattern", at, in.problems());
        for (const auto& each : claims_it.types)
          ranges.push_back({each.value, each.at, found.name});
        found.types = values_of(std::move(claims_it.types));
        found.ids = values_of(std::move(claims_it.ids));
        if (in.has("ids"))
          found.prefix = "{channel}.{name}";
        in.optional("prefix", key_prefix{}, found.prefix,
                    {"first part of the keys; `{island}`, `{id}` and `{name}` stand for the "
                     "island's name, the mote's id and the mote's name; `{channel}` for `rfid`, "
                     "`{id}` for the tag's id, `{name}` for the object's name",
                     "`\"{island}.{name}\"`, with `ids` `\"{channel}.{name}\"`"});
        check_kind(in, in.has("ids"), found.prefix);
        duration known_from{};
        in.optional("known_from", time_span{0s, 24h * 10}, known_from,
                    "time at which proxy managers receive the class; motes and tags that only it "
                    "claims have no proxy until then");
        found.known_from = instant(known_from);
        found.properties = read_properties(in, names);
        in.optional("indirect", flag{}, found.indirect,
                    "of motes: publish the [interface and the position](gateway.md#of-a-proxy) "
                    "too, as proxies of tagged objects always do");
        in.table("qos", "[proxy.qos]", "of motes", [&](table_reader& x) { x.all(found.settings); });
        in.tables("field", "[[proxy.field]]", {"values that it publishes", "none"},
                  [&](table_reader& x) { read_field(x, names, placed, found); });
        in.tables("input", "[[proxy.input]]", {"motes alone have inputs", "none"},
                  [&](table_reader& x) { read_input(x, names, found); });
        in.tables("object", "[[proxy.object]]",
                  {"properties of single motes or tagged objects", "none"},
                  [&](table_reader& x) { read_object(x, names, objects, found); });
        std::vector<placed_template> templates;
        in.tables("tuple", "[[proxy.tuple]]", {"tuples with other keys and forms", "none"},
                  [&](table_reader& x) { templates.push_back(read_tuple_template(x)); });
        claims<std::string> keys;
        for (auto& each : templates) {
          keys.claim(folded(each.what.key), "the key `" + each.what.key + '`', each.key_at,
                     in.problems());
          check_tuple_template(each, found, in.problems());
          found.tuples.push_back(std::move(each.what));
        }
        read_program(in, programs, names, found);
        note(in, found);
        out.push_back(std::move(found));
      });
  check_overlaps(ranges, root.problems());
  if (root.sound())
    check_streams(placed.streams, out, islands, peers, root.problems());
  if (root.sound())
    place_transducers(placed.transducers, out, islands, root.shared());
  if (root.sound())
    place_stamps(out, islands);
  if (root.sound())
    place_computations(placed.computations, out, islands, root.problems());
  return out;
}

void check_object_manager(const table_reader& root, const std::vector<peer_description>& peers,
                          const std::vector<proxy::proxy_class>& classes) {
  const auto starts_objects = [](const peer_app& x) {
    const auto* manager = std::get_if<proxy_manager_app>(&x);
    return manager != nullptr && manager->objects;
  };
  const bool managed = std::ranges::any_of(
      peers, [&](const auto& x) { return std::ranges::any_of(x.apps, starts_objects); });
  const bool wanted = std::ranges::any_of(classes, [](const auto& x) { return !x.ids.empty(); });
  if (wanted && !managed)
    root.problems().add(root.at("proxy"), "no component starts proxies of tagged objects: a "
                                          "\"proxy_manager\" needs `objects = true`");
}

} // namespace rubicon::config
