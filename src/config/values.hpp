// The kinds of value a key may take. Each knows its range, reads a node, and says what it wants:
//
//   using type = ...;
//   std::optional<type> read(const node&, asker&) const;  // complains if it returns nothing
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

#include "config/document.hpp"
#include "config/near.hpp"
#include "config/problem.hpp"
#include "core/address.hpp"
#include "core/time.hpp"
#include "mote/transducer_config.hpp"
#include "proxy/proxy_class.hpp"
#include "radio/parameters.hpp"

namespace rubicon::config {

/// Whose value is read, and where complaints about it go.
struct asker {
  std::string_view key;
  complaints& problems;

  /// `KEY` must be WANTED, not FOUND.
  std::nullopt_t refuse(const node& x, const std::string& wanted) const;

  /// The same with another end, such as a suggestion().
  std::nullopt_t refuse(const node& x, const std::string& wanted, const std::string& end) const;

  void complain(const node& x, std::string message) const {
    problems.add(x.at, std::move(message));
  }
};

/// A value and its place.
template <class T>
struct located {
  T value{};
  mark at;
};

/// An integer from `min` to `max`.
template <class T>
struct whole {
  using type = T;
  T min = std::numeric_limits<T>::min();
  T max = std::numeric_limits<T>::max();

  [[nodiscard]] std::optional<T> read(const node& x, const asker& who) const {
    const auto* found = x.as<std::int64_t>();
    if (found == nullptr || !std::in_range<T>(*found) || static_cast<T>(*found) < min ||
        static_cast<T>(*found) > max)
      return who.refuse(x, "a whole number from " + std::to_string(min) + " to " +
                               std::to_string(max));
    return static_cast<T>(*found);
  }
};

/// A finite number from `min` to `max`, with or without decimals.
struct real {
  using type = double;
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();

  [[nodiscard]] std::optional<double> read(const node& x, const asker& who) const;
};

struct flag {
  using type = bool;
  [[nodiscard]] static std::optional<bool> read(const node& x, const asker& who);
};

/// Text of 1 to `octets_max` octets without control characters.
struct text {
  using type = std::string;
  std::size_t octets_max = 100;

  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const;
};

inline constexpr std::size_t name_length_max = 32;

/// 1 to 32 letters, digits, `-` and `_`: fits in one part of a tuple's key and in an actor's path.
[[nodiscard]] bool is_name(std::string_view x);

struct name_text {
  using type = std::string;
  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
};

/// A tuple's key (TUP-03): 1 to 7 parts of letters, digits, `-` and `_`, at most 127 characters.
struct tuple_key {
  using type = std::string;
  bool wildcards = false; ///< a part may be `*`

  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const;
};

/// "31s"
struct time_span {
  using type = duration;
  duration min = 0s;
  duration max = 24h * 3650;

  [[nodiscard]] std::optional<duration> read(const node& x, const asker& who) const;
};

/// "-5s" or "5s", but not 0
struct time_step {
  using type = duration;
  [[nodiscard]] static std::optional<duration> read(const node& x, const asker& who);
};

/// 0.02 or "2%"
struct ratio {
  using type = double;
  [[nodiscard]] static std::optional<double> read(const node& x, const asker& who);
};

/// "25m"
struct metres {
  using type = double;
  double min = 0;
  double max = 0;

  [[nodiscard]] std::optional<double> read(const node& x, const asker& who) const;
};

/// "2000mAh"
struct charge {
  using type = double;
  [[nodiscard]] static std::optional<double> read(const node& x, const asker& who);
};

/// "-98dBm"
struct power_level {
  using type = double;
  double min_dbm = -150;
  double max_dbm = 20;

  [[nodiscard]] std::optional<double> read(const node& x, const asker& who) const;
};

/// "46.68dB"
struct decibels {
  using type = double;
  double min = 0;
  double max = 200;

  [[nodiscard]] std::optional<double> read(const node& x, const asker& who) const;
};

/// "2480MHz", in MHz
struct frequency {
  using type = double;
  [[nodiscard]] static std::optional<double> read(const node& x, const asker& who);
};

/// 57600 or "57600baud"
struct baud {
  using type = std::uint32_t;
  [[nodiscard]] static std::optional<std::uint32_t> read(const node& x, const asker& who);
};

/// "10Mbit/s" or 10000000; 0 for no limit
struct bit_rate {
  using type = std::uint64_t;
  [[nodiscard]] static std::optional<std::uint64_t> read(const node& x, const asker& who);
};

/// The URL of a TCP link, "tcp://host:port"
struct tcp_url {
  using type = std::string;
  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
};

/// [x, y] or [x, y, z] in metres
struct place {
  using type = position;
  [[nodiscard]] static std::optional<position> read(const node& x, const asker& who);
};

/// [["0s", [0, 2]], ["1min", [30, 2]]], times strictly increasing
struct way {
  using type = std::vector<std::pair<duration, position>>;
  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who);
};

/// [["0s", 21.0], ["5min", 27.5]], times strictly increasing
struct time_points {
  using type = std::vector<std::pair<duration, double>>;
  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who);
};

/// 101, "100..119" or, a value and a mask, "0x0100/0xff00"
struct type_span {
  using type = proxy::type_range;
  [[nodiscard]] static std::optional<proxy::type_range> read(const node& x, const asker& who);
};

/// The name of a platform.
struct platform_name {
  using type = const radio::platform*;
  [[nodiscard]] static std::optional<const radio::platform*> read(const node& x, const asker& who);
};

/// The name of medium access rules.
struct mac_name {
  using type = std::string;
  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
};

/// Octets in hexadecimal, "01" or "00ff", 1 to 100 of them.
struct hex_octets {
  using type = bytes;
  [[nodiscard]] static std::optional<bytes> read(const node& x, const asker& who);
};

/// `"a", "b" or "c"`
[[nodiscard]] std::string alternatives(const std::vector<std::string>& words);

/// One of some words.
template <class T>
struct word {
  using type = T;
  std::vector<std::pair<std::string_view, T>> choices;

  [[nodiscard]] std::optional<T> read(const node& x, const asker& who) const {
    const auto* found = x.as<std::string>();
    std::vector<std::string> known;
    for (const auto& [name, value] : choices) {
      if (found != nullptr && *found == name)
        return value;
      known.emplace_back(name);
    }
    const auto meant = found == nullptr ? std::string() : nearest(*found, known);
    return who.refuse(x, alternatives(known),
                      meant.empty() ? "" : "; did you mean \"" + meant + "\"?");
  }
};

/// An array of values, each with its place.
template <class Kind>
struct list_of {
  using element = typename Kind::type;
  using type = std::vector<located<element>>;
  Kind kind;
  std::size_t min = 0;
  std::size_t max = std::numeric_limits<std::size_t>::max();

  [[nodiscard]] std::optional<type> read(const node& x, const asker& who) const {
    const auto* elements = x.as<node_array>();
    if (elements == nullptr)
      return who.refuse(x, "an array in [ ]");
    if (elements->size() < min || elements->size() > max) {
      const bool few = elements->size() < min;
      return who.refuse(x, "an array of " + std::string(few ? "at least " : "at most ") +
                               std::to_string(few ? min : max));
    }
    type out;
    bool good = true;
    for (const auto& each : *elements) {
      if (auto value = kind.read(each, who))
        out.push_back({*std::move(value), each.at});
      else
        good = false;
    }
    return good ? std::optional(std::move(out)) : std::nullopt;
  }
};

/// A table whose keys the file's author chooses, in the order of the file.
template <class Kind>
struct pairs_of {
  using type = std::vector<std::pair<located<std::string>, typename Kind::type>>;
  Kind kind;

  [[nodiscard]] std::optional<type> read(const node& x, const asker& who) const {
    const auto* members = x.as<node_table>();
    if (members == nullptr)
      return who.refuse(x, "a table, as in { key = \"value\" }");
    type out;
    bool good = true;
    for (const auto& each : *members) {
      if (auto value = kind.read(each.value, asker{each.key, who.problems}))
        out.push_back({{each.key, each.at}, *std::move(value)});
      else
        good = false;
    }
    return good ? std::optional(std::move(out)) : std::nullopt;
  }
};

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
