// What a file may say about a struct: its keys, listed once, in the struct's room. The
// configuration's reader, its documents and its JSON Schema are made from the list. It has a header
// of its own, so that nobody but the configuration is compiled anew for a sentence:
//
//   inline auto keys_of(const line_config*) {
//     return keys::of(keys::optional("latency", &line_config::latency, keys::time_span{0s, 10s},
//                                    "of adapter and driver, each way"));
//   }
//
// A key that may change while an ecology runs says so there, `.changeable()`, and nowhere else: see
// core/describe/changes.hpp.
//
// Kinds say what a value may be; they are plain, and `config` knows how each is read and described.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"

namespace rubicon::keys {

/// An integer from `min` to `max`.
template <class T>
struct whole {
  using type = T;
  T min = std::numeric_limits<T>::min();
  T max = std::numeric_limits<T>::max();
};

/// A finite number from `min` to `max`, with or without decimals.
struct real {
  using type = double;
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
};

struct flag {
  using type = bool;
};

/// Text of 1 to `octets_max` octets without control characters.
struct text {
  using type = std::string;
  std::size_t octets_max = 100;
};

/// 1 to 32 letters, digits, `-` and `_`: fits in one part of a tuple's key and in an actor's path.
struct name_text {
  using type = std::string;
};

/// A tuple's key (TUP-03): 1 to 7 parts of letters, digits, `-` and `_`, at most 127 characters.
struct tuple_key {
  using type = std::string;
  bool wildcards = false; ///< a part may be `*`
};

/// "31s"
struct time_span {
  using type = duration;
  duration min = 0s;
  duration max = 24h * 3650;
};

/// "-5s" or "5s", but not 0
struct time_step {
  using type = duration;
};

/// 0.02 or "2%"
struct ratio {
  using type = double;
};

/// "25m"
struct metres {
  using type = double;
  double min = 0;
  double max = 0;
};

/// "2000mAh"
struct charge {
  using type = double;
};

/// "-98dBm"
struct power_level {
  using type = double;
  double min_dbm = -150;
  double max_dbm = 20;
};

/// "46.68dB"
struct decibels {
  using type = double;
  double min = 0;
  double max = 200;
};

/// "2480MHz", in MHz
struct frequency {
  using type = double;
};

/// 57600 or "57600baud"
struct baud {
  using type = std::uint32_t;
};

/// "10Mbit/s" or 10000000; 0 for no limit
struct bit_rate {
  using type = std::uint64_t;
};

/// [x, y] or [x, y, z] in metres
struct place {
  using type = position;
};

/// [["0s", 21.0], ["5min", 27.5]], times strictly increasing
struct time_points {
  using type = std::vector<std::pair<duration, double>>;
};

/// Octets in hexadecimal, "01" or "00ff", 1 to 100 of them.
struct hex_octets {
  using type = bytes;
};

/// A mote as "island/mote".
struct mote_name {
  using type = mote_address;
  bool any = false; ///< or "*", for any_mote
};

/// A mote as "island/mote", or a peer by its name.
struct node_name {
  using type = mote_address; ///< no_mote in the mote part: a peer
};

/// A quantity that motes measure, by its name.
struct quantity_name {
  bool signal = false; ///< how strongly a mote receives its parent counts, too
};

/// One of some words.
template <class T>
struct word {
  using type = T;
  std::vector<std::pair<std::string_view, T>> choices;
};

/// An array of values.
template <class Kind>
struct list_of {
  Kind kind;
  std::size_t min = 0;
  std::size_t max = std::numeric_limits<std::size_t>::max();
};

/// A table whose keys the file's author chooses, in the order of the file.
template <class Kind>
struct pairs_of {
  Kind kind;
};

/// What is said of a key in documents and while a file is typed.
struct about {
  // NOLINTNEXTLINE(google-explicit-constructor): mostly it is just a sentence
  constexpr about(const char* meaning_, std::string_view unset_ = {}, std::string_view wanted_ = {})
      : meaning(meaning_), unset(unset_), wanted(wanted_) {}

  /// It may change while an ecology runs: what is new in a file that is read again is applied.
  /// @param effect_ what a change affects, if that is not obvious
  [[nodiscard]] constexpr about changeable(std::string_view effect_ = {}) const {
    auto x = *this;
    x.is_changeable = true;
    x.effect = effect_;
    return x;
  }

  /// The same, but only from one value to another: once it is in the file, it remains there.
  [[nodiscard]] constexpr about replaceable(std::string_view effect_ = {}) const {
    auto x = changeable(effect_);
    x.is_removable = false;
    return x;
  }

  std::string_view meaning; ///< one sentence, without a full stop; empty: its name says it
  std::string_view unset;   ///< what holds without it, if its struct's default does not say
  std::string_view wanted;  ///< what it may be, if its kind does not say
  bool is_changeable = false;
  bool is_removable = true;
  std::string_view effect{};
};

/// One key and the member that it sets.
template <class Struct, class Member, class Kind>
struct key {
  std::string_view name;
  Member Struct::*member;
  Kind kind;
  about what;
  bool is_required = false;
  bool is_conditional = false; ///< other keys decide whether it is required; its sentence says how

  [[nodiscard]] constexpr key changeable(std::string_view effect = {}) const {
    auto x = *this;
    x.what = what.changeable(effect);
    return x;
  }

  [[nodiscard]] constexpr key replaceable(std::string_view effect = {}) const {
    auto x = *this;
    x.what = what.replaceable(effect);
    return x;
  }
};

/// Without it the member stays as it is.
template <class Struct, class Member, class Kind>
constexpr key<Struct, Member, Kind> optional(std::string_view name, Member Struct::*member,
                                             Kind kind, about what) {
  return {name, member, std::move(kind), what, false};
}

template <class Struct, class Member, class Kind>
constexpr key<Struct, Member, Kind> required(std::string_view name, Member Struct::*member,
                                             Kind kind, about what) {
  return {name, member, std::move(kind), what, true};
}

/// One that is required under a condition only.
template <class Struct, class Member, class Kind>
constexpr key<Struct, Member, Kind> required_if(bool condition, std::string_view name,
                                                Member Struct::*member, Kind kind, about what) {
  return {name, member, std::move(kind), what, condition, true};
}

/// The keys of a struct, in the order in which they are described.
template <class... Keys>
constexpr std::tuple<Keys...> of(Keys... all) {
  return {std::move(all)...};
}

} // namespace rubicon::keys
