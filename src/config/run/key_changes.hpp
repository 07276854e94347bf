// Reads new values of keys that may change while an ecology runs, from the list that has them for
// the whole run.
#pragma once

#include <string>
#include <tuple>

#include "config/toml/table_reader.hpp"
#include "core/describe/changes.hpp"

namespace rubicon::config {

template <class Member>
struct new_value {
  Member value{};
};

template <class Struct, class Member, class Kind>
void read_change(table_reader& in, const keys::key<Struct, Member, Kind>& key,
                 keys::key_changes& out) {
  if constexpr (keys::changeable_member<Member>) {
    if (!key.what.is_changeable)
      return;
    auto meaning = std::string(key.what.meaning);
    if (!key.what.effect.empty())
      meaning += "; " + std::string(key.what.effect);
    new_value<Member> found;
    in.all(found, keys::of(keys::optional(key.name, &new_value<Member>::value, key.kind,
                                          {meaning.c_str(), "as before", key.what.wanted})));
    if (in.is_good(key.name))
      out.push_back({std::string(key.name), keys::value_of(found.value)});
  }
}

/// All keys of the list of `Struct` that may change; none is required.
template <class Struct>
void read_key_changes(table_reader& in, keys::key_changes& out) {
  std::apply([&](const auto&... each) { (read_change(in, each, out), ...); },
             keys_of(static_cast<const Struct*>(nullptr)));
}

} // namespace rubicon::config
