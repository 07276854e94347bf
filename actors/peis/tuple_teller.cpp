#include "actors/peis/tuple_teller.hpp"

#include <utility>

#include "actors/messages/peis.hpp"
#include "core/tuples/device_keys.hpp"

namespace rubicon {

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

template <class Set>
void tuple_teller::tell_set(const scheduler::delivery& x, std::optional<peer_id> owner,
                            const Set& set) {
  if (set.text)
    tell(x, owner, set.key, tuple_text(set.value.view()));
  else
    tell(x, owner, set.key, "0x" + to_hex(set.value.view()));
}

void tuple_teller::write(const scheduler::delivery& x) {
  if (!x.received)
    return;
  if (const auto* set = x.as<set_tuple>())
    tell_set(x, {}, *set);
  else if (const auto* remote = x.as<set_remote_tuple>())
    tell_set(x, remote->owner, *remote);
  else if (const auto* meta = x.as<set_meta_tuple>())
    tell(x, meta->owner, meta->key, meta->reference);
  else if (const auto* gone = x.as<delete_tuple>())
    tell(x, {}, gone->key, {}, /*deleted=*/true);
}

void tuple_teller::tell(const scheduler::delivery& x, std::optional<peer_id> owner,
                        std::string_view key, std::string_view value, bool deleted) {
  told_.at = x.time;
  told_.peer = x.path.substr(x.path.find('/') + 1);
  if (!owner)
    told_.owner = told_.peer;
  else if (const auto found = names_.find(*owner); found != names_.end())
    told_.owner = found->second;
  else
    told_.owner = to_string(*owner);
  told_.key = key;
  told_.value = value;
  told_.deleted = deleted;
  tell_(told_);
}

} // namespace rubicon
