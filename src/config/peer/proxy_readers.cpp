#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <map>
#include <system_error>
#include <utility>

#include "config/file_readers.hpp"
#include "config/island/application_readers.hpp"
#include "config/label_keys.hpp"
#include "config/peer/proxy_keys.hpp"
#include "config/peer/proxy_part_readers.hpp"
#include "proxy/classes/class_keys.hpp"
#include "proxy/classes/layout.hpp"
#include "proxy/classes/signature.hpp"

namespace rubicon::config {

namespace {

/// words = { "0" = "off" } of a field: every key is a count that its encoding can hold.
void read_field_words(table_reader& in, bool sized, proxy::field& out) {
  field_words found;
  in.all(found);
  const auto [least, most] = proxy::range_of(out.layout);
  for (auto& [key, value] : found.words) {
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
  field_transducer source;
  in.all(source);
  if (in.is_good("transducer") && !field.name.empty())
    placed.transducers.push_back({of, field.name, source.kind, in.at("transducer"),
                                  in.has("offset"), in.has("scale"), in.has("unit")});
  if (in.has("transducer") && in.has("encoding"))
    in.problems().add(in.at("encoding"), "`encoding` has no effect with `transducer`");
}

/// mean_of and computed_by, of fields of motes.
void read_computation(table_reader& in, proxy::field& field, const std::string& of,
                      std::vector<placed_computation>& computations) {
  in.all(field, field_mean_keys());
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
  in.all(stream, field_stream_keys());
  if (!in.is_good("stream")) {
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
  in.all(field, field_name_keys());
  if (in.is_good("name"))
    names.add(field.name, in.at("name"), in.problems());
  if (out.ids.empty()) {
    in.all(field, field_channel_keys(!in.has("stream")));
    read_stream(in, field, out.name, placed);
  }
  in.all(field, field_layout_keys());
  const bool sized = in.is_good("encoding") || !in.has("encoding");
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
  in.all(form, number_form_keys());
  in.all(out, input_unit_keys());
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
  in.all(form, number_min_keys(in.walks() ? real{} : real{low, high}));
  in.all(form, number_max_keys(in.walks() ? real{} : real{form.min, high}));
  if (in.is_good("encoding"))
    out.numbers = form;
}

void read_input(table_reader& in, tuple_names& names, proxy::proxy_class& out) {
  proxy::input input;
  in.all(input, input_keys());
  if (in.is_good("name"))
    names.add(input.name, in.at("name"), in.problems());
  if (input.meta && !input.name.empty())
    names.add("mi-" + input.name, in.at("meta"), in.problems());
  read_numbers(in, input);
  input_words words;
  in.all(words, input_word_keys(!in.has("encoding")));
  if (in.is_good("words") && words.words.empty())
    in.problems().add(in.at("words"), "`words` must have at least one word");
  for (auto& [key, octets] : words.words) {
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
  property_table found;
  in.all(found);
  for (auto& [key, value] : found.properties) {
    if (!is_name(key.value))
      in.problems().add(key.at, "a property's name must have 1 to 32 letters, digits, - and _, "
                                "unlike " +
                                    in_quotes(key.value));
    names.add(key.value, key.at, in.problems());
    out.emplace_back(key.value, std::move(value));
  }
  return out;
}

/// Who of a [[proxy.object]] it is: a mote by its name.
void read_known_mote(table_reader& in, name_uniqueness& ids, proxy::known_object& found) {
  known_mote known;
  in.all(known);
  if (in.is_good("mote")) {
    found.id = proxy::proxy_id(known.mote);
    ids.add(found.id, "mote", in.at("mote"), in.problems());
  }
  found.place = known.place;
}

/// [[proxy.object]]
void read_object(table_reader& in, const tuple_names& of_class, name_uniqueness& ids,
                 proxy::proxy_class& out) {
  proxy::known_object found;
  if (out.ids.empty() || in.walks()) {
    read_known_mote(in, ids, found);
  }
  if (!out.ids.empty() || in.walks()) {
    in.all(found, tagged_object_keys());
    if (in.is_good("id"))
      ids.add(found.id, "object", in.at("id"), in.problems());
  }
  auto names = of_class;
  found.properties = read_properties(in, names);
  out.objects.push_back(std::move(found));
}

/// What the class claims: motes by their types, or tagged objects by their ids.
class_scope read_scope(table_reader& in) {
  class_scope out;
  in.all(out, class_scope_keys());
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
  const auto* given = in.content().find(key);
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
                                             const std::vector<peer_description>& peers,
                                             label_table& labels) {
  std::vector<proxy::proxy_class> out;
  std::vector<placed_range> ranges;
  name_uniqueness classes;
  name_uniqueness ids;
  name_uniqueness objects;
  placed_fields placed;
  root.tables("proxy", "[[proxy]]", "decodes the octets of motes, or represents tagged objects",
              [&](table_reader& in) {
                proxy::proxy_class found;
                tuple_names names;
                in.all(found, class_name_keys());
                labels.add(label_table::kind::proxy, found.name, read_label(in));
                if (in.is_good("name"))
                  classes.add(found.name, "proxy name", in.at("name"), in.problems());
                auto scope = read_scope(in);
                for (const auto& [value, at] : scope.ids)
                  ids.add(value.channel + '/' + value.prefix, "id pattern", at, in.problems());
                for (const auto& each : scope.types)
                  ranges.push_back({each.value, each.at, found.name});
                found.types = values_of(std::move(scope.types));
                found.ids = values_of(std::move(scope.ids));
                if (in.has("ids"))
                  found.prefix = "{channel}.{name}";
                in.all(found, class_prefix_keys());
                check_kind(in, in.has("ids"), found.prefix);
                in.all(scope, class_start_keys());
                found.known_from = instant(scope.known_from);
                found.properties = read_properties(in, names);
                in.all(found, class_form_keys());
                in.table("qos", "[proxy.qos]", "of motes",
                         [&](table_reader& x) { x.all(found.settings); });
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
                uniqueness<std::string> keys;
                for (auto& each : templates) {
                  keys.add(folded(each.what.key), "the key `" + each.what.key + '`', each.key_at,
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
