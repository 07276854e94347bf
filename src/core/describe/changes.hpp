// New values of those keys of a struct that may change while an ecology runs, as its list says
// (core/describe/keys.hpp). What two files differ in, what [[change]] may have, what is sent to
// actors and applied there, and what logs show of it, follow from the list.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/describe/keys.hpp"
#include "core/time.hpp"

namespace rubicon::keys {

/// A value of such a key.
using key_value = std::variant<bool, std::int64_t, double, duration, std::string>;

struct key_change {
  std::string key;
  key_value value;

  friend bool operator==(const key_change&, const key_change&) = default;
};
RUBICON_FIELDS(key_change, key, value);

/// Each key at most once; all others stay as they are.
using key_changes = std::vector<key_change>;

/// `every 5 s`
[[nodiscard]] std::string to_text(const key_change& x);

/// `5 s`
[[nodiscard]] std::string to_text(const key_value& x);

/// The new value of a key; nullptr if it has none.
[[nodiscard]] const key_value* find(const key_changes& all, std::string_view key);

namespace detail {

template <class T>
struct held {
  using type = T;
};
template <class T>
struct held<std::optional<T>> {
  using type = T;
};

} // namespace detail

/// A member of a struct that a key_value can hold.
template <class Member, class T = typename detail::held<Member>::type>
concept changeable_member = std::integral<T> || std::same_as<T, double> ||
    std::same_as<T, duration> || std::same_as<T, std::string>;

template <changeable_member Member>
[[nodiscard]] bool is_set(const Member& x) {
  if constexpr (!std::same_as<typename detail::held<Member>::type, Member>)
    return x.has_value();
  else
    return true;
}

/// @pre is_set(x)
template <changeable_member Member>
[[nodiscard]] key_value value_of(const Member& x) {
  if constexpr (!std::same_as<typename detail::held<Member>::type, Member>)
    return value_of(*x);
  else if constexpr (std::integral<Member> && !std::same_as<Member, bool>)
    return static_cast<std::int64_t>(x);
  else
    return x;
}

/// Leaves the member as it is if the value is of another type.
template <changeable_member Member>
void assign(Member& to, const key_value& x) {
  using type = typename detail::held<Member>::type;
  if constexpr (std::integral<type> && !std::same_as<type, bool>) {
    if (const auto* value = std::get_if<std::int64_t>(&x); value && std::in_range<type>(*value))
      to = static_cast<type>(*value);
  } else if (const auto* value = std::get_if<type>(&x)) {
    to = *value;
  }
}

/// Calls use(name, member, about) for each changeable key of a struct.
template <class Struct, class Use>
void for_each_changeable(Use use) {
  const auto one = [&use]<class Member, class Kind>(const key<Struct, Member, Kind>& x) {
    if constexpr (changeable_member<Member>)
      if (x.what.is_changeable)
        use(x.name, x.member, x.what);
  };
  std::apply([&one](const auto&... each) { (one(each), ...); },
             keys_of(static_cast<const Struct*>(nullptr)));
}

/// What is new. A key that was removed and must not be is no change.
template <class Struct>
[[nodiscard]] key_changes changes_between(const Struct& before, const Struct& now) {
  key_changes out;
  for_each_changeable<Struct>([&](std::string_view name, auto member, const about& what) {
    const bool removed = !what.is_removable && now.*member == Struct().*member;
    if (now.*member != before.*member && is_set(now.*member) && !removed)
      out.push_back({std::string(name), value_of(now.*member)});
  });
  return out;
}

/// Keys that the struct does not have, or that cannot change, are ignored.
template <class Struct>
void apply(const key_changes& all, Struct& to) {
  for_each_changeable<Struct>([&](std::string_view name, auto member, const about&) {
    if (const auto* value = find(all, name))
      assign(to.*member, *value);
  });
}

/// The values that the struct has of the same keys, in their order; of one that it lacks the new.
template <class Struct>
[[nodiscard]] key_changes values_before(key_changes all, const Struct& x) {
  for_each_changeable<Struct>([&](std::string_view name, auto member, const about&) {
    for (auto& each : all)
      if (each.key == name && is_set(x.*member))
        each.value = value_of(x.*member);
  });
  return all;
}

} // namespace rubicon::keys
