#include "peis/kernel/indirections.hpp"

#include <iterator>
#include <utility>

namespace rubicon::peis {

namespace {

void append(tuple_events& to, tuple_events more) {
  to.insert(to.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

} // namespace

std::pair<cause, tuple_events> indirections::begin(const prototype& meta, subscription_id id,
                                                   tuple_space::interest kind, tuple_space& space,
                                                   instant now) {
  const subscription_id meta_watch{own_ids_first + meta_watches_made_++};
  auto subscribed = space.subscribe(meta, meta_watch, kind, now);
  if (subscribed.first == cause::none) {
    by_id_[id] = {kind, meta_watch, {}};
    meta_watches_[meta_watch] = id;
  }
  return subscribed;
}

tuple_events indirections::on_held(subscription_id id, const tuple& content, tuple_space& space,
                                   instant now) {
  return on_meta_tuple(by_id_.at(id).meta_watch, &content, space, now);
}

tuple_events indirections::on_meta_tuple(subscription_id meta_watch, const tuple* content,
                                         tuple_space& space, instant now) {
  const auto at = meta_watches_.find(meta_watch);
  if (at == meta_watches_.end())
    return {};
  const auto id = at->second;
  auto& x = by_id_.at(id);
  meta_reference target;
  if (content != nullptr) {
    if (auto parsed = read_meta(*content))
      target = std::move(*parsed);
    else
      ++malformed_;
  }
  if (target == x.target)
    return {};
  tuple_events todo;
  if (x.target)
    append(todo, space.unsubscribe(id).second);
  x.target = target;
  if (target)
    append(todo,
           space.subscribe(prototype_of(target->owner, target->name), id, x.kind, now).second);
  return todo;
}

tuple_events indirections::end(subscription_id id, tuple_space& space) {
  const auto at = by_id_.find(id);
  auto todo = space.unsubscribe(at->second.meta_watch).second;
  append(todo, space.unsubscribe(id).second); // unless it points nowhere now
  meta_watches_.erase(at->second.meta_watch);
  by_id_.erase(at);
  return todo;
}

} // namespace rubicon::peis
