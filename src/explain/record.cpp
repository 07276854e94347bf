#include "explain/record.hpp"

#include <array>
#include <concepts>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"

namespace rubicon::explain {

namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 28> kind_words = {
    "begun",
    "radio_send",
    "radio_done",
    "frame",
    "frame_received",
    "serial_write",
    "serial_octets",
    "plug_serial",
    "backbone_write",
    "backbone_received",
    "link_opened",
    "link_octets",
    "link_lost",
    "set_tuple",
    "delete_tuple",
    "set_remote_tuple",
    "tuple_event",
    "watch_tuples",
    "send_peis_message",
    "peis_outcome",
    "send_message",
    "message_received",
    "send_ended",
    "actuator_changed",
    "event",
    "ecology",
    "sample",
    "message_ended",
};
static_assert(kind_words.size() == static_cast<std::size_t>(kind::message_ended) + 1);

/// The first line's, before its fields.
constexpr const char* version_key = "rubicon_record";

// How values are written, one overload for each type that a field has.

template <class First, class Second>
void write(std::string& out, const std::pair<First, Second>& x);
template <class List>
requires requires(const List& x) {
  x.begin();
}
void write(std::string& out, const List& all);
template <described Struct>
void write(std::string& out, const Struct& x);

template <std::integral Number>
void write(std::string& out, Number x) {
  out += std::to_string(x);
}
void write(std::string& out, bool x) {
  out += x ? "true" : "false";
}
void write(std::string& out, const std::string& x) {
  out += json_line(json(x));
}
void write(std::string& out, const bytes& x) {
  (out += '"') += to_hex(x) += '"';
}
void write(std::string& out, instant x) {
  write(out, x.time_since_epoch().count());
}
void write(std::string& out, duration x) {
  write(out, x.count());
}
void write(std::string& out, kind x) {
  ((out += '"') += to_string(x)) += '"';
}
void write(std::string& out, const mote_address& x) {
  write(out, std::pair{x.island.value, x.mote.value});
}
template <class First, class Second>
void write(std::string& out, const std::pair<First, Second>& x) {
  write(out += '[', x.first);
  write(out += ',', x.second);
  out += ']';
}
template <class List>
requires requires(const List& x) {
  x.begin();
}
void write(std::string& out, const List& all) {
  out += '[';
  for (const auto& x : all) {
    write(out, x);
    out += ',';
  }
  if (!all.empty())
    out.pop_back();
  out += ']';
}

/// Those that are not as usual, without braces.
template <class Struct>
void write_fields(std::string& out, const Struct& x, const Struct& usual = {}) {
  const auto begin = out.size();
  const auto all = fields_of(&x);
  const auto one = [&](const auto& field) {
    if (x.*(field.member) == usual.*(field.member))
      return;
    if (out.size() != begin)
      out += ',';
    ((out += '"') += field.name) += "\":";
    write(out, x.*(field.member));
  };
  std::apply([&](const auto&... field) { (one(field), ...); }, all);
}

template <described Struct>
void write(std::string& out, const Struct& x) {
  write_fields(out += '{', x);
  out += '}';
}

// And read.

/// Why a line is refused.
struct refusal {
  std::string message;
};

[[noreturn]] void refuse(std::string_view name, std::string_view why) {
  throw refusal{"`" + std::string(name) + "` is " + std::string(why)};
}

template <class Value>
void read(const json& from, std::string_view name, std::vector<Value>& all);
template <class Key, class Value>
void read(const json& from, std::string_view name, std::map<Key, Value>& all);
template <described Struct>
void read(const json& from, std::string_view name, Struct& x);

template <std::integral Number>
void read(const json& from, std::string_view name, Number& x) {
  using most = std::conditional_t<std::is_signed_v<Number>, std::int64_t, std::uint64_t>;
  const bool is_negative = from.is_number_integer() && !from.is_number_unsigned();
  const bool is_possible = from.is_number_unsigned()
                               ? std::in_range<Number>(from.get<std::uint64_t>())
                           : is_negative ? std::in_range<Number>(from.get<std::int64_t>())
                                         : false;
  if (!is_possible)
    refuse(name, "not a number in range");
  x = static_cast<Number>(from.get<most>());
}
void read(const json& from, std::string_view name, bool& x) {
  if (!from.is_boolean())
    refuse(name, "neither true nor false");
  x = from.get<bool>();
}
void read(const json& from, std::string_view name, std::string& x) {
  if (!from.is_string())
    refuse(name, "no text");
  x = from.get<std::string>();
}
void read(const json& from, std::string_view name, bytes& x) {
  std::string text;
  read(from, name, text);
  auto octets = from_hex(text);
  if (!octets)
    refuse(name, "not hexadecimal");
  x = *std::move(octets);
}
void read(const json& from, std::string_view name, instant& x) {
  duration::rep count = 0;
  read(from, name, count);
  x = instant(duration(count));
}
void read(const json& from, std::string_view name, duration& x) {
  duration::rep count = 0;
  read(from, name, count);
  x = duration(count);
}
void read(const json& from, std::string_view name, kind& x) {
  std::string word;
  read(from, name, word);
  const auto known = parse_kind(word);
  if (!known)
    refuse(name, '"' + word.substr(0, 40) + "\", which is not a kind of record");
  x = *known;
}
template <class First, class Second>
void read(const json& from, std::string_view name, std::pair<First, Second>& x) {
  if (!from.is_array() || from.size() != 2)
    refuse(name, "no pair");
  read(from[0], name, x.first);
  read(from[1], name, x.second);
}
void read(const json& from, std::string_view name, mote_address& x) {
  std::pair<island_id::rep, mote_id::rep> both;
  read(from, name, both);
  x = {island_id(both.first), mote_id(both.second)};
}
template <class Value>
void read(const json& from, std::string_view name, std::vector<Value>& all) {
  if (!from.is_array())
    refuse(name, "no list");
  for (const auto& each : from)
    read(each, name, all.emplace_back());
}
template <class Key, class Value>
void read(const json& from, std::string_view name, std::map<Key, Value>& all) {
  std::vector<std::pair<Key, Value>> pairs;
  read(from, name, pairs);
  all.insert(pairs.begin(), pairs.end());
}
template <described Struct>
void read(const json& from, std::string_view name, Struct& x) {
  if (!from.is_object())
    refuse(name, "no object");
  for_each_field(x, [&](std::string_view field, auto& value) {
    if (const auto found = from.find(field); found != from.end())
      read(*found, field, value);
  });
}

void check_version(const json& x) {
  const auto version = x.find(version_key);
  if (version == x.end())
    throw refusal{"this is not a record: the first line must contain `rubicon_record`"};
  if (!version->is_number_integer() || *version != record_version)
    throw refusal{"a record of version " + version->dump() + ", this program reads version " +
                  std::to_string(record_version) + ": record the run again"};
}

} // namespace

std::string_view to_string(kind x) {
  return kind_words[static_cast<std::size_t>(x)];
}

std::optional<kind> parse_kind(std::string_view word) {
  for (std::size_t i = 0; i < kind_words.size(); ++i)
    if (kind_words[i] == word)
      return static_cast<kind>(i);
  return std::nullopt;
}

std::string encode(const header& x) {
  std::string out = '{' + json_line(json(version_key)) + ':' + std::to_string(record_version) + ',';
  write_fields(out, x);
  if (out.back() == ',')
    out.pop_back();
  return out + "}\n";
}

std::string encode(const record& x) {
  record usual;
  usual.what = static_cast<kind>(kind_words.size()); // it is always written
  std::string out = "{";
  write_fields(out, x, usual);
  return out += "}\n";
}

std::optional<bad_line> decoder::take(std::string_view text) {
  ++lines_;
  try {
    const auto x = try_parse_json(text);
    if (x.is_discarded() || !x.is_object())
      throw refusal{lines_ == 1 ? "this is not a record: the first line is not a JSON object"
                                : "this is not a JSON object"};
    if (lines_ == 1) {
      check_version(x);
      read(x, "header", result_.about);
    } else {
      if (!x.contains("what"))
        throw refusal{"`what` is missing"};
      record r;
      read(x, "record", r);
      result_.records.push_back(std::move(r));
    }
  } catch (const refusal& why) {
    return bad_line{lines_, why.message};
  }
  return std::nullopt;
}

std::optional<bad_line> decoder::finish(std::string_view rest) {
  if (!rest.empty() && lines_ > 0) {
    result_.cut_off = take(rest).has_value();
    return std::nullopt;
  }
  if (!rest.empty())
    return take(rest);
  return lines_ == 0 ? std::optional(bad_line{1, "this is not a record: it is empty"})
                     : std::nullopt;
}

read_result read(std::string_view text) {
  decoder lines;
  read_result x;
  while (!x.problem) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) {
      x.problem = lines.finish(text);
      break;
    }
    x.problem = lines.take(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  x.content = std::move(lines.result());
  return x;
}

} // namespace rubicon::explain
