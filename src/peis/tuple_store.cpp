#include "peis/tuple_store.hpp"

namespace rubicon::peis {

const tuple* tuple_store::find(const key& name, peer_id owner) const {
  const auto at = tuples_.find(name.folded());
  if (at == tuples_.end())
    return nullptr;
  const auto which = at->second.find(owner);
  return which == at->second.end() ? nullptr : &which->second.content;
}

const tuple& tuple_store::put(tuple x, std::optional<instant> expiry) {
  auto& same_key = tuples_[x.name.folded()];
  const auto owner = x.owner;
  const auto [at, is_new] = same_key.try_emplace(owner);
  auto& slot = at->second;
  if (is_new)
    ++size_;
  else
    x.name = std::move(slot.content.name);
  if (slot.expiry)
    expiries_.erase({*slot.expiry, x.name.folded(), owner});
  if (expiry)
    expiries_.emplace(*expiry, x.name.folded(), owner);
  slot = {std::move(x), expiry};
  return slot.content;
}

tuple tuple_store::take(std::map<std::string, owners>::iterator at, owners::iterator which) {
  auto taken = std::move(which->second);
  if (taken.expiry)
    expiries_.erase({*taken.expiry, at->first, which->first});
  at->second.erase(which);
  if (at->second.empty())
    tuples_.erase(at);
  --size_;
  return std::move(taken.content);
}

std::optional<tuple> tuple_store::remove(const key& name, peer_id owner) {
  const auto at = tuples_.find(name.folded());
  if (at == tuples_.end())
    return std::nullopt;
  const auto which = at->second.find(owner);
  if (which == at->second.end())
    return std::nullopt;
  return take(at, which);
}

std::optional<tuple> tuple_store::take_expired(instant now) {
  if (expiries_.empty() || std::get<instant>(*expiries_.begin()) > now)
    return std::nullopt;
  const auto [when, name, owner] = *expiries_.begin();
  const auto at = tuples_.find(name);
  return take(at, at->second.find(owner));
}

std::vector<const tuple*> tuple_store::find_all(peer_id owner, const key& pattern) const {
  std::vector<const tuple*> found;
  const auto add = [&](const owners& same_key) {
    for (const auto& [id, x] : same_key) {
      if ((owner == any_peer || owner == id) && pattern.matches(x.content.name))
        found.push_back(&x.content);
    }
  };
  if (pattern.is_pattern()) {
    for (const auto& [name, same_key] : tuples_)
      add(same_key);
  } else if (const auto at = tuples_.find(pattern.folded()); at != tuples_.end()) {
    add(at->second);
  }
  return found;
}

std::optional<instant> tuple_store::deadline() const {
  if (expiries_.empty())
    return std::nullopt;
  return std::get<instant>(*expiries_.begin());
}

} // namespace rubicon::peis
