#include "peis/tuple_store.hpp"

#include <utility>

namespace rubicon::peis {

namespace {

/// Calls `visit` with what stands in an ordered map under keys that a pattern may match.
template <class Map, class Visitor>
void walk(const Map& map, const key& pattern, Visitor visit) {
  if (!pattern.is_pattern()) {
    if (const auto at = map.find(pattern.folded()); at != map.end())
      visit(at->first, at->second);
    return;
  }
  const auto prefix = pattern.literal_prefix();
  for (auto at = map.lower_bound(prefix); at != map.end() && at->first.starts_with(prefix); ++at)
    visit(at->first, at->second);
}

/// Nodes of two trees, the tuple, its key and the head of the message that brought it.
constexpr std::size_t tuple_overhead = 900;

} // namespace

std::size_t weight_of(const tuple& x) {
  return tuple_overhead + 4 * x.name.text().size() + x.mimetype.size() + x.value.size();
}

const tuple_store::entry* tuple_store::find(peer_id owner, const key& name) const {
  const auto of_owner = owners_.find(owner);
  if (of_owner == owners_.end())
    return nullptr;
  const auto at = of_owner->second.find(name.folded());
  return at == of_owner->second.end() ? nullptr : &at->second;
}

fair_share* tuple_store::share_of(origin x) {
  switch (x) {
  case origin::ours:
    return nullptr;
  case origin::written:
    return &written_;
  case origin::held:
    return &held_;
  }
  return nullptr;
}

void tuple_store::remember(const entry& x) {
  if (x.expiry)
    expiries_.emplace(*x.expiry, x.content->owner, x.content->name.folded());
  if (auto* share = share_of(x.by.from))
    share->add(x.by.host, x.weight);
}

void tuple_store::forget(const entry& x) {
  if (x.expiry)
    expiries_.erase({*x.expiry, x.content->owner, x.content->name.folded()});
  if (auto* share = share_of(x.by.from))
    share->remove(x.by.host, x.weight);
}

bool tuple_store::admits(const tuple& x, source by) const {
  if (by.from == origin::ours)
    return true;
  const auto weight = weight_of(x);
  const auto* before = find(x.owner, x.name);
  const auto had = before != nullptr && before->by == by ? before->weight : 0;
  const auto& share = by.from == origin::held ? held_ : written_;
  return weight <= had || share.admits(by.host, weight - had);
}

tuple_pointer tuple_store::put(tuple x, std::optional<instant> expiry, source by) {
  const auto owner = x.owner;
  auto& slot = owners_[owner][x.name.folded()];
  const bool by_other = by.from == origin::written && (!slot.content || slot.created_by_other);
  if (slot.content) {
    forget(slot);
    x.name = slot.content->name;
  } else {
    keys_[x.name.folded()].insert(owner);
    ++size_;
  }
  const auto weight = weight_of(x);
  slot = {std::make_shared<const tuple>(std::move(x)), expiry, by, weight, by_other, true};
  remember(slot);
  return slot.content;
}

tuple_pointer tuple_store::remove(peer_id owner, const key& name) {
  const auto of_owner = owners_.find(owner);
  if (of_owner == owners_.end())
    return nullptr;
  const auto at = of_owner->second.find(name.folded());
  if (at == of_owner->second.end())
    return nullptr;
  forget(at->second);
  const auto same_key = keys_.find(at->first);
  same_key->second.erase(owner);
  if (same_key->second.empty())
    keys_.erase(same_key);
  auto taken = std::move(at->second.content);
  of_owner->second.erase(at);
  if (of_owner->second.empty())
    owners_.erase(of_owner);
  --size_;
  return taken;
}

tuple_pointer tuple_store::take_expired(instant now) {
  if (expiries_.empty() || std::get<instant>(*expiries_.begin()) > now)
    return nullptr;
  const auto& [when, owner, name] = *expiries_.begin();
  const auto content = owners_.at(owner).at(name).content;
  return remove(content->owner, content->name);
}

std::vector<const tuple_store::entry*> tuple_store::candidates(peer_id owner,
                                                               const key& pattern) const {
  std::vector<const entry*> found;
  if (owner != any_peer) {
    if (const auto at = owners_.find(owner); at != owners_.end())
      walk(at->second, pattern, [&](const std::string&, const entry& x) { found.push_back(&x); });
    return found;
  }
  walk(keys_, pattern, [&](const std::string& name, const std::set<peer_id>& holders) {
    for (const auto id : holders)
      found.push_back(&owners_.at(id).at(name));
  });
  return found;
}

std::vector<tuple_pointer> tuple_store::find_all(const prototype& wanted) const {
  std::vector<tuple_pointer> found;
  for_matching(wanted, [&](const entry& x) { found.push_back(x.content); });
  return found;
}

std::optional<instant> tuple_store::deadline() const {
  if (expiries_.empty())
    return std::nullopt;
  return std::get<instant>(*expiries_.begin());
}

} // namespace rubicon::peis
