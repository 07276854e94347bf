// How the values of keys are read and described, by their kinds (core/describe/keys.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "config/reading.hpp"
#include "config/toml/document.hpp"
#include "config/toml/form.hpp"
#include "config/toml/problem.hpp"
#include "core/address.hpp"
#include "core/describe/keys.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/text/name.hpp"
#include "core/text/spelling.hpp"
#include "core/time.hpp"
#include "proxy/classes/proxy_class.hpp"
#include "radio/parameters.hpp"

namespace rubicon::config {

inline constexpr std::size_t path_octets_max = 4096;   ///< of a file's name
inline constexpr std::size_t payload_octets_max = 100; ///< of a message (transport payload)

/// Whose value is read, and what its reader knows.
struct asker {
  std::string_view key;
  reading& in;

  /// `KEY` must be WANTED, not FOUND.
  std::nullopt_t refuse(const node& x, const std::string& wanted) const;

  /// The same with another end, such as a suggestion().
  std::nullopt_t refuse(const node& x, const std::string& wanted, const std::string& end) const;

  void complain(const node& x, std::string message) const {
    in.problems.add(x.at, std::move(message));
  }
};

using keys::about;
using keys::baud;
using keys::bit_rate;
using keys::charge;
using keys::decibels;
using keys::flag;
using keys::frequency;
using keys::hex_octets;
using keys::list_of;
using keys::metres;
using keys::mote_name;
using keys::name_text;
using keys::node_name;
using keys::pairs_of;
using keys::place;
using keys::power_level;
using keys::quantity_name;
using keys::ratio;
using keys::real;
using keys::text;
using keys::time_points;
using keys::time_span;
using keys::time_step;
using keys::tuple_key;
using keys::whole;
using keys::word;

/// `{ key = 0.5 }`: a table with what stands in its place; with `"value"` if that is none.
[[nodiscard]] std::string table_of(const std::string& key, const node& x);

/// `"a", "b" or "c"`
[[nodiscard]] std::string alternatives(const std::vector<std::string>& words);

// Each kind has a function that reads a node, or complains and returns nothing; one that says what
// it takes; and, if a key of it may have a default, one that writes a value as a file would. Kinds
// that only the configuration has bring them along as members, of which only `read` is needed.

std::optional<double> read(const real& kind, const node& x, const asker& who);
std::optional<bool> read(const flag& kind, const node& x, const asker& who);
std::optional<std::string> read(const text& kind, const node& x, const asker& who);
std::optional<std::string> read(const name_text& kind, const node& x, const asker& who);
std::optional<std::string> read(const tuple_key& kind, const node& x, const asker& who);
std::optional<duration> read(const time_span& kind, const node& x, const asker& who);
std::optional<duration> read(const time_step& kind, const node& x, const asker& who);
std::optional<double> read(const ratio& kind, const node& x, const asker& who);
std::optional<double> read(const metres& kind, const node& x, const asker& who);
std::optional<double> read(const charge& kind, const node& x, const asker& who);
std::optional<double> read(const power_level& kind, const node& x, const asker& who);
std::optional<double> read(const decibels& kind, const node& x, const asker& who);
std::optional<double> read(const frequency& kind, const node& x, const asker& who);
std::optional<std::uint32_t> read(const baud& kind, const node& x, const asker& who);
std::optional<std::uint64_t> read(const bit_rate& kind, const node& x, const asker& who);
std::optional<position> read(const place& kind, const node& x, const asker& who);
std::optional<time_points::type> read(const time_points& kind, const node& x, const asker& who);
std::optional<bytes> read(const hex_octets& kind, const node& x, const asker& who);
std::optional<mote_address> read(const mote_name& kind, const node& x, const asker& who);
std::optional<mote_address> read(const node_name& kind, const node& x, const asker& who);
std::optional<device::quantity> read(const quantity_name& kind, const node& x, const asker& who);

form form_of(const real& kind);
form form_of(const flag& kind);
form form_of(const text& kind);
form form_of(const name_text& kind);
form form_of(const tuple_key& kind);
form form_of(const time_span& kind);
form form_of(const time_step& kind);
form form_of(const ratio& kind);
form form_of(const metres& kind);
form form_of(const charge& kind);
form form_of(const power_level& kind);
form form_of(const decibels& kind);
form form_of(const frequency& kind);
form form_of(const baud& kind);
form form_of(const bit_rate& kind);
form form_of(const place& kind);
form form_of(const time_points& kind);
form form_of(const hex_octets& kind);
form form_of(const mote_name& kind);
form form_of(const node_name& kind);
form form_of(const quantity_name& kind); ///< without those that the file adds

json_text written(const real& kind, double x);
json_text written(const flag& kind, bool x);
json_text written(const text& kind, const std::string& x);
json_text written(const time_span& kind, duration x);
json_text written(const ratio& kind, double x);
json_text written(const metres& kind, double x);
json_text written(const power_level& kind, double x);
json_text written(const decibels& kind, double x);
json_text written(const frequency& kind, double x);
json_text written(const baud& kind, std::uint32_t x);
json_text written(const bit_rate& kind, std::uint64_t x);
json_text written(const place& kind, const position& x);

/// A kind with functions of its own.
template <class Kind>
concept own_kind = requires(const Kind& kind, const node& x, const asker& who) {
  kind.read(x, who);
};

template <own_kind Kind>
[[nodiscard]] auto read(const Kind& kind, const node& x, const asker& who) {
  return kind.read(x, who);
}

template <own_kind Kind>
[[nodiscard]] form form_of(const Kind& kind) {
  if constexpr (requires { kind.takes(); })
    return kind.takes();
  else
    return string_form("text");
}

template <class T>
[[nodiscard]] std::optional<T> read(const whole<T>& kind, const node& x, const asker& who) {
  const auto* found = x.as<std::int64_t>();
  if (found == nullptr || !std::in_range<T>(*found) || static_cast<T>(*found) < kind.min ||
      static_cast<T>(*found) > kind.max)
    return who.refuse(x, "a whole number from " + std::to_string(kind.min) + " to " +
                             std::to_string(kind.max));
  return static_cast<T>(*found);
}

template <class T>
[[nodiscard]] form form_of(const whole<T>& kind) {
  const bool is_bounded = std::cmp_less(kind.max, std::numeric_limits<std::int64_t>::max());
  return whole_form(static_cast<std::int64_t>(kind.min),
                    is_bounded ? std::optional(static_cast<std::int64_t>(kind.max)) : std::nullopt);
}

template <class T>
[[nodiscard]] json_text written(const whole<T>& /*kind*/, T x) {
  return std::to_string(x);
}

template <class T>
[[nodiscard]] std::vector<std::string> words_of(const word<T>& kind) {
  std::vector<std::string> out;
  for (const auto& [name, value] : kind.choices)
    out.emplace_back(name);
  return out;
}

template <class T>
[[nodiscard]] std::optional<T> read(const word<T>& kind, const node& x, const asker& who) {
  const auto* found = x.as<std::string>();
  for (const auto& [name, value] : kind.choices)
    if (found != nullptr && *found == name)
      return value;
  const auto known = words_of(kind);
  const auto meant = found == nullptr ? std::string() : nearest(*found, known);
  return who.refuse(x, alternatives(known),
                    meant.empty() ? "" : "; did you mean \"" + meant + "\"?");
}

template <class T>
[[nodiscard]] form form_of(const word<T>& kind) {
  return word_form(words_of(kind));
}

template <class T>
[[nodiscard]] json_text written(const word<T>& kind, const T& x) {
  for (const auto& [name, value] : kind.choices)
    if (value == x)
      return json_string(name);
  return {};
}

template <class Kind>
using value_of = typename decltype(read(std::declval<Kind>(), std::declval<node>(),
                                        std::declval<asker>()))::value_type;

/// Each with its place.
template <class Kind>
[[nodiscard]] auto read(const list_of<Kind>& kind, const node& x, const asker& who)
    -> std::optional<std::vector<located<value_of<Kind>>>> {
  const auto* elements = x.as<node_array>();
  if (elements == nullptr)
    return who.refuse(x, "an array in [ ]");
  if (elements->size() < kind.min || elements->size() > kind.max) {
    const bool few = elements->size() < kind.min;
    return who.refuse(x, "an array of " + std::string(few ? "at least " : "at most ") +
                             std::to_string(few ? kind.min : kind.max));
  }
  std::vector<located<value_of<Kind>>> out;
  bool good = true;
  for (const auto& each : *elements) {
    if (auto value = read(kind.kind, each, who))
      out.push_back({*std::move(value), each.at});
    else
      good = false;
  }
  return good ? std::optional(std::move(out)) : std::nullopt;
}

template <class Kind>
[[nodiscard]] form form_of(const list_of<Kind>& kind) {
  return list_form(form_of(kind.kind), kind.min, kind.max);
}

template <class T>
using named_values = std::vector<std::pair<located<std::string>, T>>;

template <class Kind>
[[nodiscard]] auto read(const pairs_of<Kind>& kind, const node& x, const asker& who)
    -> std::optional<named_values<value_of<Kind>>> {
  const auto* members = x.as<node_table>();
  if (members == nullptr)
    return who.refuse(x, "a table, as in " + table_of("key", x));
  named_values<value_of<Kind>> out;
  bool good = true;
  for (const auto& each : *members) {
    if (auto value = read(kind.kind, each.value, asker{each.key, who.in}))
      out.push_back({{each.key, each.at}, *std::move(value)});
    else
      good = false;
  }
  return good ? std::optional(std::move(out)) : std::nullopt;
}

template <class Kind>
[[nodiscard]] form form_of(const pairs_of<Kind>& kind) {
  return pairs_form(form_of(kind.kind));
}

/// The URL of a link over the real network, "tcp://host:port" or "udp://host:port"
struct peer_url {
  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};

/// An address of a computer's interface, "192.168.1.7"
struct interface_address {
  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};

/// "192.168.1.0/24", or one address
struct network_text {
  using type = ipv4_network;
  [[nodiscard]] static std::optional<ipv4_network> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};
/// So many of them are at most in a list.
constexpr std::size_t networks_max = 64;

/// A time that is not after the end of the run.
struct time_of_run {
  using type = duration;
  [[nodiscard]] static std::optional<duration> read(const node& x, const asker& who);
  [[nodiscard]] static form takes() { return form_of(time_span{}); }
};

[[nodiscard]] inline json_text written(const time_of_run& /*kind*/, duration x) {
  return written(time_span{}, x);
}

/// "2038-01-19"
struct calendar_day {
  using type = duration; ///< its midnight, since 1970; before network_time_end
  [[nodiscard]] static std::optional<duration> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};

/// "07:30" or "07:30:15"
struct time_of_day {
  using type = duration; ///< since midnight, below 24 h
  [[nodiscard]] static std::optional<duration> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};

/// [["0s", [0, 2]], ["1min", [30, 2]]], times strictly increasing
struct way {
  using type = std::vector<std::pair<duration, position>>;
  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};

/// 101, "100..119" or, a value and a mask, "0x0100/0xff00"
struct type_span {
  [[nodiscard]] static std::optional<proxy::type_range> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};

/// The name of a platform.
[[nodiscard]] word<const radio::platform*> platform_name();

/// The name of medium access rules.
[[nodiscard]] word<std::string> mac_name();

/// The values without their places.
template <class T>
[[nodiscard]] std::vector<T> values_of(std::vector<located<T>> x) {
  std::vector<T> out;
  out.reserve(x.size());
  for (auto& each : x)
    out.push_back(std::move(each.value));
  return out;
}

} // namespace rubicon::config
