// The keys of [[proxy]] and of its tables, without those that a change may have as well
// (proxy/classes/class_keys.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/label_keys.hpp"
#include "config/toml/values.hpp"
#include "proxy/classes/proxy_class.hpp"

namespace rubicon::config {

inline constexpr whole<std::uint16_t> message_channel{0, 255};

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

/// @param also "stamp", which no input has
inline word<proxy::encoding> encoding_words(bool also_stamps) {
  using proxy::encoding;
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

/// What a class claims and from when on, with the places that checks need.
struct class_scope {
  std::vector<located<proxy::type_range>> types;
  std::vector<located<proxy::id_prefix>> ids;
  duration known_from{};
};

inline auto class_name_keys() {
  return keys::of(
      keys::required("name", &proxy::proxy_class::name, labelled_name{}, "of the class"));
}

inline auto class_scope_keys() {
  return keys::of(
      keys::optional("types", &class_scope::types, list_of<type_span>{{}, 1},
                     {"the motes' types it claims; of a mask, those that have this value under it",
                      "either these"}),
      keys::optional(
          "ids", &class_scope::ids, list_of<id_pattern>{{}, 1},
          {"the ids of tags it claims, by their first part; `\"rfid/\"`: all", "or these"}));
}

inline auto class_prefix_keys() {
  return keys::of(
      keys::optional("prefix", &proxy::proxy_class::prefix, key_prefix{},
                     {"first part of the keys; `{island}`, `{id}` and `{name}` stand for the "
                      "island's name, the mote's id and the mote's name; `{channel}` for `rfid`, "
                      "`{id}` for the tag's id, `{name}` for the object's name",
                      "`\"{island}.{name}\"`, with `ids` `\"{channel}.{name}\"`"}));
}

inline auto class_start_keys() {
  return keys::of(
      keys::optional("known_from", &class_scope::known_from, time_span{0s, 24h * 10},
                     "time at which proxy managers receive the class; motes and tags that only it "
                     "claims have no proxy until then"));
}

inline auto class_form_keys() {
  return keys::of(
      keys::optional("indirect", &proxy::proxy_class::indirect, flag{},
                     "of motes: publish the [interface and the position](gateway.md#of-a-proxy) "
                     "too, as proxies of tagged objects always do"));
}

/// Prior information of a class, or of one of its objects.
struct property_table {
  named_values<std::string> properties;
};

inline auto keys_of(const property_table*) {
  return keys::of(keys::optional("properties", &property_table::properties, pairs_of<text>{{200}},
                                 {"published unchanged, under their names", "none"}));
}

/// [[proxy.object]] of a class of motes
struct known_mote {
  mote_address mote;
  std::optional<position> place = {};
};

inline auto keys_of(const known_mote*) {
  return keys::of(
      keys::required_if(true, "mote", &known_mote::mote, mote_name{}, "if the class has `types`"),
      keys::optional("position_m", &known_mote::place, place{},
                     {"of a mote: its position, for a class with `indirect`", "not known"}));
}

/// [[proxy.object]] of a class of tagged objects
inline auto tagged_object_keys() {
  return keys::of(keys::required_if(true, "id", &proxy::known_object::id, name_text{},
                                    "of its tag, if the class has `ids`"),
                  keys::optional("name", &proxy::known_object::name, name_text{},
                                 {"for `{name}` of the prefix, the same", "its id"}));
}

inline auto field_name_keys() {
  return keys::of(keys::required("name", &proxy::field::name, name_text{}, "last part of the key"));
}

inline auto field_channel_keys(bool is_required) {
  return keys::of(
      keys::required_if(is_required, "channel", &proxy::field::channel, message_channel,
                        "channel of the message it is read from; with `ids` there is none: it is "
                        "read from the tag's memory"));
}

inline auto field_stream_keys() {
  return keys::of(
      keys::optional(
          "stream", &proxy::stream_input::number, whole<std::uint16_t>{},
          {"instead of `channel`: the proxy itself reads this stream of sensor records, "
           "which a [`stream_writer`](#app--stream_writer) of a mote in any island writes "
           "`to` the peer of the proxy manager; only for a class with a single mote",
           "none"}),
      keys::optional("every", &proxy::stream_input::every, time_span{10ms, 24h},
                     "of a stream: as its writer's"));
}

inline auto field_layout_keys() {
  return keys::of(
      keys::optional("offset", &proxy::field::offset, whole<std::size_t>{0, payload_octets_max - 1},
                     "its first octet in the message, which has up to 100"),
      keys::optional(
          "encoding", &proxy::field::layout, encoding_words(true),
          "encoding of its octets, in network byte order; `\"stamp\"`: four octets are the "
          "time of a sampler with `stamped = true`, and the count is the whole [network "
          "time](gateway.md#time) since 1970 in milliseconds"));
}

/// Words of a field, before their counts are read.
struct field_words {
  named_values<std::string> words;
};

inline auto keys_of(const field_words*) {
  return keys::of(keys::optional("words", &field_words::words, pairs_of<text>{{32}},
                                 {"words for counts, instead of numbers", "none",
                                  "`{ 0 = \"off\", 1 = \"on\" }`, texts of 1 to 32 octets"}));
}

inline auto field_mean_keys() {
  return keys::of(
      keys::optional("mean_of", &proxy::field::mean_of, whole<std::size_t>{1, proxy::mean_of_max},
                     "of motes: the value is the mean of this many counts, rounded to a whole "
                     "count"),
      keys::optional("computed_by", &proxy::field::computed_by_mote,
                     word<bool>{{{"proxy", false}, {"mote", true}}},
                     "node that computes that mean. With `\"mote\"` it is the "
                     "[sampler](#app--sampler) of each mote of the class that sends on the "
                     "channel; the tuples are the same"));
}

/// Transducer that a field's counts are of.
struct field_transducer {
  device::quantity kind{};
};

inline auto keys_of(const field_transducer*) {
  return keys::of(keys::optional(
      "transducer", &field_transducer::kind, quantity_name{true},
      {"transducer whose counts the [samplers](#app--sampler) of the class send on the "
       "channel: it gives `offset`, its resolution as `scale` and its unit, where the "
       "field has none",
       "none", "quantity"}));
}

inline auto input_keys() {
  return keys::of(
      keys::required("name", &proxy::input::name, name_text{}, "last part of the key"),
      keys::required("channel", &proxy::input::channel, message_channel,
                     "channel on which the mote receives it"),
      keys::optional("meta", &proxy::input::meta, flag{},
                     "the input is the tuple that `PREFIX.mi-INPUT` points at, initially "
                     "`PREFIX.INPUT`: rewriting that [meta tuple](peis.md#meta-tuples) selects "
                     "the tuple that the actuator follows"));
}

inline auto number_form_keys() {
  return keys::of(keys::optional("encoding", &proxy::number_form::layout, encoding_words(false),
                                 {"encoding of a number that is not a word: its count is the "
                                  "number less `add`, divided by `scale`, rounded",
                                  "it accepts no numbers"}),
                  keys::optional("scale", &proxy::number_form::scale, real{},
                                 {"value of one count, not 0", "", "number, not 0"}),
                  keys::optional("add", &proxy::number_form::add, real{}, "value of the count 0"));
}

inline auto input_unit_keys() {
  return keys::of(keys::optional("unit", &proxy::input::unit, text{16},
                                 {"unit of the numbers, published with the range", "none"}));
}

inline auto number_min_keys(const real& range) {
  return keys::of(keys::optional("min", &proxy::number_form::min, range,
                                 {"smaller numbers are refused", "limit of the encoding"}));
}

/// @param range from the `min` that was read
inline auto number_max_keys(const real& range) {
  return keys::of(
      keys::optional("max", &proxy::number_form::max, range,
                     {"larger ones are", "limit of the encoding", "number, at least `min`"}));
}

/// Words of an input, before they are checked.
struct input_words {
  named_values<bytes> words;
};

inline auto input_word_keys(bool is_required) {
  return keys::of(
      keys::required_if(is_required, "words", &input_words::words, pairs_of<hex_octets>{},
                        {"1 to 100 octets in hexadecimal for each word", "none with `encoding`",
                         "`{ on = \"01\", off = \"00\" }`, at least 1"}));
}

} // namespace rubicon::config
