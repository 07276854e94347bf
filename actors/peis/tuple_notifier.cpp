#include "actors/peis/tuple_notifier.hpp"

#include <utility>

#include "actors/messages/peis.hpp"
#include "core/tuples/device_keys.hpp"

namespace rubicon {

tuple_notifier::tuple_notifier(const config::ecology_description& names, listener to)
    : listener_(std::move(to)) {
  config::for_each_island(names, [this](const config::island_description& x) {
    names_[gateway_of(x.id)] = x.gateway_name;
    for (const auto& alias : x.aliases)
      names_[alias.id] = alias.name;
  });
  for (const auto& x : names.peers)
    names_[x.id] = x.name;
}

template <class Set>
void tuple_notifier::notify_of(const scheduler::delivery& x, std::optional<peer_id> owner,
                               const Set& set) {
  if (set.text)
    notify(x, owner, set.key, tuple_text(set.value.view()));
  else
    notify(x, owner, set.key, "0x" + to_hex(set.value.view()));
}

void tuple_notifier::on_delivery(const scheduler::delivery& x) {
  if (!x.received)
    return;
  if (const auto* set = x.as<set_tuple>())
    notify_of(x, {}, *set);
  else if (const auto* remote = x.as<set_remote_tuple>())
    notify_of(x, remote->owner, *remote);
  else if (const auto* meta = x.as<set_meta_tuple>())
    notify(x, meta->owner, meta->key, meta->reference);
  else if (const auto* gone = x.as<delete_tuple>())
    notify(x, {}, gone->key, {}, /*deleted=*/true);
}

void tuple_notifier::notify(const scheduler::delivery& x, std::optional<peer_id> owner,
                            std::string_view key, std::string_view value, bool deleted) {
  write_.at = x.time;
  write_.peer = x.path.substr(x.path.find('/') + 1);
  if (!owner)
    write_.owner = write_.peer;
  else if (const auto found = names_.find(*owner); found != names_.end())
    write_.owner = found->second;
  else
    write_.owner = to_string(*owner);
  write_.key = key;
  write_.value = value;
  write_.deleted = deleted;
  listener_(write_);
}

} // namespace rubicon
