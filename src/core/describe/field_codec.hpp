// Values as octets, and back: numbers, texts, octets, times, ids, containers of such, and structs
// whose fields are listed (core/describe/fields.hpp). For messages and files between programs of
// one version.
//
// Numbers are in network byte order, each as wide as its type; what has a size begins with it, in
// 32 bits; an optional and a variant begin with an octet. A value has one form: keys of maps
// ascend, `true` is 1, and nothing follows.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/bytes.hpp"
#include "core/codec.hpp"
#include "core/describe/content.hpp"
#include "core/describe/enumerators.hpp"
#include "core/describe/fields.hpp"
#include "core/error.hpp"

namespace rubicon {

namespace detail {

template <class T>
inline constexpr bool is_time_point = false;
template <class Clock, class Length>
inline constexpr bool is_time_point<std::chrono::time_point<Clock, Length>> = true;

template <class T>
inline constexpr bool is_tuple = is_pair<T>;
template <class... Each>
inline constexpr bool is_tuple<std::tuple<Each...>> = true;

template <class T>
inline constexpr bool is_array = false;
template <class T, std::size_t size>
inline constexpr bool is_array<std::array<T, size>> = true;

template <class T>
concept octet_sequence = std::same_as<T, std::string> || std::same_as<T, bytes>;

/// Sorted by keys, none twice: a map or a set.
template <class T>
concept keyed = sequence<T> && requires(const T& x) {
  x.key_comp();
} && requires(T& x) {
  x.emplace_hint(x.end(), std::declval<typename T::value_type>());
} && requires(T& x) {
  x.insert(std::declval<typename T::value_type>()).second;
};

struct any_callable {
  template <class... Parts>
  constexpr void operator()(Parts&... /*parts*/) const {}
};

/// A class without a list that shows its parts: `with_parts(f, x)` calls f with all of them.
template <class T>
concept shows_parts = requires(any_callable& f, T& x) {
  with_parts(f, x);
};

/// The fewest octets that a value takes: bounds how many of them can be in so many octets.
template <class T>
constexpr std::size_t octets_min();

template <class... Each>
constexpr std::size_t sum_of_min(std::tuple<Each...>* /*of*/) {
  return (std::size_t{0} + ... + octets_min<std::remove_cvref_t<Each>>());
}

template <class T, class... Member>
constexpr std::size_t sum_of_fields(std::tuple<listed_field<T, Member>...>* /*of*/) {
  return (std::size_t{0} + ... + octets_min<Member>());
}

template <class T>
constexpr std::size_t octets_min() {
  if constexpr (std::is_same_v<T, std::monostate>) {
    return 0;
  } else if constexpr (std::is_same_v<T, bool>) {
    return 1;
  } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    return sizeof(T);
  } else if constexpr (is_duration<T> || is_time_point<T>) {
    return sizeof(std::int64_t);
  } else if constexpr (is_strong_id<T> || is_largest<T>) {
    return octets_min<decltype(T::value)>();
  } else if constexpr (is_optional<T> || is_variant<T>) {
    return 1;
  } else if constexpr (is_array<T>) {
    return std::tuple_size_v<T> * octets_min<typename T::value_type>();
  } else if constexpr (is_pair<T>) {
    return octets_min<std::remove_cv_t<typename T::first_type>>() +
           octets_min<typename T::second_type>();
  } else if constexpr (is_tuple<T>) {
    return sum_of_min(static_cast<T*>(nullptr));
  } else if constexpr (std::is_same_v<T, payload> || sequence<T>) {
    return sizeof(std::uint32_t);
  } else if constexpr (described<T>) {
    return sum_of_fields<T>(
        static_cast<decltype(fields_of(static_cast<const T*>(nullptr)))*>(nullptr));
  } else {
    return 1; // at least, of the parts that it shows itself
  }
}

class value_writer {
public:
  template <class T>
  void add(const T& x) {
    if constexpr (std::is_same_v<T, std::monostate>) {
      return;
    } else if constexpr (std::is_same_v<T, bool>) {
      out_.octet(x ? 1 : 0);
    } else if constexpr (std::is_integral_v<T>) {
      out_.big(x);
    } else if constexpr (std::is_enum_v<T>) {
      assert(is_enumerator(x));
      out_.big(static_cast<std::underlying_type_t<T>>(x));
    } else if constexpr (std::is_same_v<T, double>) {
      out_.big(std::bit_cast<std::uint64_t>(x));
    } else if constexpr (std::is_same_v<T, float>) {
      out_.big(std::bit_cast<std::uint32_t>(x));
    } else if constexpr (is_duration<T>) {
      static_assert(std::is_integral_v<typename T::rep>);
      out_.big(static_cast<std::int64_t>(x.count()));
    } else if constexpr (is_time_point<T>) {
      add(x.time_since_epoch());
    } else if constexpr (is_strong_id<T> || is_largest<T>) {
      add(x.value);
    } else if constexpr (std::is_same_v<T, payload>) {
      add_octets(x.view());
    } else if constexpr (octet_sequence<T>) {
      add_octets(byte_view(reinterpret_cast<const std::uint8_t*>(x.data()), x.size()));
    } else {
      add_composed(x);
    }
  }

  [[nodiscard]] bytes finish() { return out_.finish(); }

private:
  void add_octets(byte_view x) {
    add_size(x.size());
    out_.append(x);
  }

  void add_size(std::size_t x) {
    assert(x <= std::numeric_limits<std::uint32_t>::max());
    out_.big(static_cast<std::uint32_t>(x));
  }

  template <class T>
  void add_composed(const T& x) {
    if constexpr (is_optional<T>) {
      add(x.has_value());
      if (x)
        add(*x);
    } else if constexpr (is_variant<T>) {
      static_assert(std::variant_size_v<T> <= 256);
      assert(!x.valueless_by_exception());
      out_.octet(static_cast<std::uint8_t>(x.index()));
      std::visit([this](const auto& each) { this->add(each); }, x);
    } else if constexpr (is_array<T>) {
      for (const auto& each : x)
        add(each);
    } else if constexpr (is_tuple<T>) {
      std::apply([this](const auto&... each) { (this->add(each), ...); }, x);
    } else if constexpr (sequence<T>) {
      add_size(x.size());
      for (const auto& each : x)
        add(static_cast<const typename T::value_type&>(each));
    } else if constexpr (described<T>) {
      for_each_field(x, [this](std::string_view, const auto& each) { this->add(each); });
    } else {
      static_assert(shows_parts<T>, "its fields are not listed");
      const auto add_all = [this](const auto&... part) { (this->add(part), ...); };
      auto copy = x; // who shows parts does not know that we only look
      with_parts(add_all, copy);
    }
  }

  byte_writer out_;
};

/// Whatever is wrong makes ok() false for good, and nothing more is read or allocated.
class value_reader {
public:
  value_reader(byte_view octets, std::size_t memory_max) : in_(octets), room_(memory_max) {}

  template <class T>
  void read(T& x) {
    if constexpr (std::is_same_v<T, std::monostate>) {
      return;
    } else if constexpr (std::is_same_v<T, bool>) {
      const auto octet = in_.octet();
      need(octet <= 1);
      x = octet == 1;
    } else if constexpr (std::is_integral_v<T>) {
      x = in_.big<T>();
    } else if constexpr (std::is_enum_v<T>) {
      x = static_cast<T>(in_.big<std::underlying_type_t<T>>());
      need(is_enumerator(x));
    } else if constexpr (std::is_same_v<T, double>) {
      x = std::bit_cast<double>(in_.big<std::uint64_t>());
    } else if constexpr (std::is_same_v<T, float>) {
      x = std::bit_cast<float>(in_.big<std::uint32_t>());
    } else if constexpr (is_duration<T>) {
      read_length(x);
    } else if constexpr (is_time_point<T>) {
      typename T::duration since{};
      read_length(since);
      x = T(since);
    } else if constexpr (is_strong_id<T> || is_largest<T>) {
      read(x.value);
    } else if constexpr (std::is_same_v<T, payload>) {
      x = payload(to_bytes(read_octets()));
    } else if constexpr (octet_sequence<T>) {
      const auto octets = read_octets();
      x.assign(octets.begin(), octets.end());
    } else {
      read_composed(x);
    }
  }

  [[nodiscard]] bool ok() const { return ok_ && in_.ok(); }
  [[nodiscard]] std::size_t remaining() const { return in_.remaining(); }

private:
  static constexpr std::size_t node_octets = 32; ///< of a map, beside what it holds

  void need(bool x) { ok_ = ok_ && x; }

  /// Before so much is allocated.
  [[nodiscard]] bool take_room(std::size_t octets) {
    need(octets <= room_);
    if (ok())
      room_ -= octets;
    return ok();
  }

  template <class Length>
  void read_length(Length& x) {
    using rep = typename Length::rep;
    const auto count = in_.big<std::int64_t>();
    need(std::in_range<rep>(count));
    x = Length(static_cast<rep>(count));
  }

  byte_view read_octets() {
    const auto size = in_.big<std::uint32_t>();
    need(size <= in_.remaining());
    return take_room(size) ? in_.take(size) : byte_view();
  }

  /// How many follow; none if there is no room for them, or they cannot be there.
  template <class T>
  std::size_t read_count(std::size_t octets_beside) {
    constexpr auto each_min = octets_min<T>();
    static_assert(each_min > 0, "any number of them fits in no octets");
    const std::size_t count = in_.big<std::uint32_t>();
    need(count <= in_.remaining() / each_min);
    return ok() && take_room(count * (sizeof(T) + octets_beside)) ? count : 0;
  }

  template <class T>
  void read_composed(T& x) {
    if constexpr (is_optional<T>) {
      bool is_there = false;
      read(is_there);
      x.reset();
      if (ok() && is_there)
        read(x.emplace());
    } else if constexpr (is_variant<T>) {
      read_alternative(x, std::make_index_sequence<std::variant_size_v<T>>());
    } else if constexpr (is_array<T>) {
      for (auto& each : x)
        read(each);
    } else if constexpr (is_tuple<T>) {
      std::apply([this](auto&... each) { (this->read(each), ...); }, x);
    } else if constexpr (keyed<T>) {
      read_keyed(x);
    } else if constexpr (sequence<T>) {
      read_sequence(x);
    } else if constexpr (described<T>) {
      for_each_field(x, [this](std::string_view, auto& each) { this->read(each); });
    } else {
      static_assert(shows_parts<T>, "its fields are not listed");
      const auto read_all = [this](auto&... part) { (this->read(part), ...); };
      with_parts(read_all, x);
    }
  }

  template <class T, std::size_t... number>
  void read_alternative(T& x, std::index_sequence<number...> /*all*/) {
    const std::size_t index = in_.octet();
    need(index < sizeof...(number));
    if (ok())
      ((number == index ? read(x.template emplace<number>()) : void()), ...);
  }

  template <class T>
  void read_sequence(T& x) {
    using value = typename T::value_type;
    const auto count = read_count<value>(0);
    x.clear();
    if constexpr (requires { x.reserve(count); })
      x.reserve(count);
    for (std::size_t i = 0; i < count && ok(); ++i) {
      value each{};
      read(each);
      x.push_back(std::move(each));
    }
  }

  template <class T>
  void read_keyed(T& x) {
    constexpr bool is_map = requires {
      typename T::mapped_type;
    };
    const auto count = read_count<typename T::value_type>(node_octets);
    x.clear();
    for (std::size_t i = 0; i < count && ok(); ++i) {
      typename T::key_type key{};
      read(key);
      const auto& last = [&]() -> const typename T::key_type& {
        if constexpr (is_map)
          return std::prev(x.end())->first;
        else
          return *std::prev(x.end());
      };
      need(x.empty() || x.key_comp()(last(), key));
      if constexpr (is_map) {
        typename T::mapped_type value{};
        read(value);
        if (ok())
          x.emplace_hint(x.end(), std::move(key), std::move(value));
      } else if (ok()) {
        x.emplace_hint(x.end(), std::move(key));
      }
    }
  }

  byte_reader in_;
  std::size_t room_;
  bool ok_ = true;
};

} // namespace detail

/// @pre enumerations have values that they list
template <class T>
[[nodiscard]] bytes encode_value(const T& x) {
  detail::value_writer out;
  out.add(x);
  return out.finish();
}

/// @param memory_max octets that the value may take in memory, roughly: its texts and elements
/// @returns bad_value for what encode_value() has not made, or what takes more
template <class T>
[[nodiscard]] result<T>
decode_value(byte_view octets, std::size_t memory_max = std::numeric_limits<std::size_t>::max()) {
  detail::value_reader in(octets, memory_max);
  T x{};
  in.read(x);
  if (!in.ok() || in.remaining() > 0)
    return errc::bad_value;
  return x;
}

} // namespace rubicon
