#include "actors/tuple_teller.hpp"

#include <utility>

#include "actors/messages.hpp"
#include "core/device_keys.hpp"

namespace rubicon {

namespace {

template <class Set>
std::string value_of(const Set& x) {
  return x.text ? std::string(tuple_text(x.value.view())) : "0x" + to_hex(x.value.view());
}

} // namespace

tuple_teller::tuple_teller(const config::ecology_description& names, listener tell)
    : tell_(std::move(tell)) {
  config::for_each_island(names, [this](const config::island_description& x) {
    names_[gateway_of(x.id)] = x.gateway_name;
    for (const auto& alias : x.aliases)
      names_[alias.id] = alias.name;
  });
  for (const auto& x : names.peers)
    names_[x.id] = x.name;
}

void tuple_teller::write(const scheduler::delivery& x) const {
  if (!x.heard)
    return;
  if (x.content.match_elements<set_tuple>()) {
    const auto& set = x.content.get_as<set_tuple>(0);
    tell(x, {}, set.key, value_of(set));
  } else if (x.content.match_elements<set_remote_tuple>()) {
    const auto& set = x.content.get_as<set_remote_tuple>(0);
    tell(x, set.owner, set.key, value_of(set));
  } else if (x.content.match_elements<set_meta_tuple>()) {
    const auto& set = x.content.get_as<set_meta_tuple>(0);
    tell(x, set.owner, set.key, set.reference);
  } else if (x.content.match_elements<delete_tuple>()) {
    tell(x, {}, x.content.get_as<delete_tuple>(0).key, {}, /*deleted=*/true);
  }
}

void tuple_teller::tell(const scheduler::delivery& x, std::optional<peer_id> owner,
                        const std::string& key, std::string value, bool deleted) const {
  std::string peer(x.path.substr(x.path.find('/') + 1));
  auto whose = peer;
  if (owner) {
    const auto found = names_.find(*owner);
    whose = found == names_.end() ? to_string(*owner) : found->second;
  }
  tell_({x.time, std::move(peer), std::move(whose), key, std::move(value), deleted});
}

} // namespace rubicon
