#include "peis/tuples/tuple_store.hpp"

#include <utility>

namespace rubicon::peis {

namespace {

/// Calls `visit` with each element of an ordered container whose key a pattern may match.
/// @param key_of of an element
template <class Ordered, class KeyOf, class Visitor>
void walk(const Ordered& all, const key& pattern, KeyOf key_of, Visitor visit) {
  const auto prefix = pattern.literal_prefix(); // of no pattern: the whole key
  for (auto at = all.lower_bound(prefix); at != all.end(); ++at) {
    const std::string_view name = key_of(*at).folded();
    if (pattern.is_pattern() ? !name.starts_with(prefix) : name != prefix)
      break;
    visit(*at);
  }
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
  const auto at = of_owner->second.find(name);
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
  if (x.expiry != instant::max())
    expiries_.emplace(x.expiry, x.content->owner, x.content->name.folded());
  if (auto* share = share_of(x.by.from))
    share->add(x.by.host, x.weight);
}

void tuple_store::forget(const entry& x) {
  if (x.expiry != instant::max())
    expiries_.erase({x.expiry, x.content->owner, x.content->name.folded()});
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
  auto& slot = owners_[owner][x.name];
  const bool by_other = by.from == origin::written && (!slot.content || slot.created_by_other);
  if (slot.content) {
    forget(slot);
    x.name = slot.content->name;
  } else {
    all_keys_.emplace(x.name, owner);
    ++size_;
  }
  const auto weight = static_cast<std::uint32_t>(weight_of(x));
  slot = {std::make_shared<const tuple>(std::move(x)),
          expiry.value_or(instant::max()),
          by,
          weight,
          by_other,
          true};
  remember(slot);
  return slot.content;
}

tuple_pointer tuple_store::remove(peer_id owner, const key& name) {
  const auto of_owner = owners_.find(owner);
  if (of_owner == owners_.end())
    return nullptr;
  const auto at = of_owner->second.find(name);
  if (at == of_owner->second.end())
    return nullptr;
  forget(at->second);
  all_keys_.erase({name, owner});
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
  const auto content = owners_.at(owner).find(std::string_view(name))->second.content;
  return remove(content->owner, content->name);
}

std::vector<const tuple_store::entry*> tuple_store::candidates(peer_id owner,
                                                               const key& pattern) const {
  std::vector<const entry*> found;
  if (owner != any_peer) {
    if (const auto at = owners_.find(owner); at != owners_.end())
      walk(
          at->second, pattern, [](const auto& x) -> const key& { return x.first; },
          [&](const auto& x) { found.push_back(&x.second); });
    return found;
  }
  walk(
      all_keys_, pattern, [](const owned_key& x) -> const key& { return x.first; },
      [&](const owned_key& x) { found.push_back(&owners_.at(x.second).at(x.first)); });
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
