// Access to tuples through meta tuples (docs/peis-wire.md 17, META-02, META-03).
#include <utility>

#include "peis/kernel/kernel.hpp"

namespace rubicon::peis {

outputs kernel::declare_meta_tuple(std::string_view name, instant now, request_id request) {
  if (is_meta_tuple(id(), name) && !network_.view().own.left) {
    report(request, cause::none);
    return finish(now);
  }
  return set_tuple(name, meta_content({}), now, request);
}

outputs kernel::set_meta_tuple(peer_id meta_owner, std::string_view meta_key, peer_id target_owner,
                               std::string_view target_key, request_id request, instant now) {
  const auto target = key::parse(target_key);
  auto why = refusal(target);
  if (why == cause::none && (target->is_pattern() || target_owner.value <= 0))
    why = cause::abstract;
  if (why != cause::none) {
    report(request, why);
    return finish(now);
  }
  return set_remote_tuple(meta_owner, meta_key, meta_content(meta_target{target_owner, *target}),
                          request, now);
}

bool kernel::is_meta_tuple(peer_id owner, std::string_view name) const {
  const auto x = find_tuple(owner, name);
  return x && read_meta(*x);
}

outputs kernel::subscribe_indirectly(peer_id meta_owner, std::string_view meta_key,
                                     subscription_id id, instant now, request_id request) {
  return watch_indirectly(meta_owner, meta_key, tuple_space::interest::subscription, id, request,
                          now);
}

outputs kernel::register_indirect_callback(peer_id meta_owner, std::string_view meta_key,
                                           subscription_id id, instant now, request_id request) {
  return watch_indirectly(meta_owner, meta_key, tuple_space::interest::callback, id, request, now);
}

outputs kernel::watch_indirectly(peer_id owner, std::string_view name, tuple_space::interest kind,
                                 subscription_id id, request_id request, instant now) {
  const auto parsed = key::parse(name);
  auto why = refusal(parsed);
  if (why == cause::none && (owner == any_peer || parsed->is_pattern()))
    why = cause::abstract;
  if (why == cause::none && (id.value >= own_ids_first || indirections_.contains(id) ||
                             tuples_.audience().has_subscription(id)))
    why = cause::bad_handle;
  if (why != cause::none) {
    report(request, why);
    return finish(now);
  }
  const subscription_id meta_watch{own_ids_first + meta_watches_made_++};
  auto [verdict, todo] = tuples_.subscribe(prototype_of(owner, *parsed), meta_watch, kind, now);
  if (verdict == cause::none) {
    indirections_[id] = {kind, meta_watch, {}};
    meta_watches_[meta_watch] = id;
    perform(std::move(todo), now); // the reference itself, if we hold it
    if (kind == tuple_space::interest::callback) {
      if (const auto held = tuples_.stored().content(owner, *parsed))
        on_meta_tuple(meta_watch, held.get(), now);
    }
  }
  report(request, verdict);
  return finish(now);
}

/// A meta tuple that we follow has another value, or is gone: drops the old target before anything
/// of it can follow, then takes the new one.
void kernel::on_meta_tuple(subscription_id meta_watch, const tuple* content, instant now) {
  const auto at = meta_watches_.find(meta_watch);
  if (at == meta_watches_.end())
    return;
  const auto id = at->second;
  auto& x = indirections_.at(id);
  meta_reference target;
  if (content != nullptr) {
    if (auto parsed = read_meta(*content))
      target = std::move(*parsed);
    else
      ++bad_meta_tuples_;
  }
  if (target == x.target)
    return;
  const bool had_target = x.target.has_value();
  x.target = target;
  if (had_target)
    perform(tuples_.unsubscribe(id).second, now);
  if (target)
    perform(tuples_.subscribe(prototype_of(target->owner, target->name), id, x.kind, now).second,
            now);
}

/// What a meta tuple that we hold points at; bad_value if we hold none.
result<meta_reference> kernel::look_up(peer_id meta_owner, std::string_view meta_key, instant now) {
  const auto meta = get_tuple(meta_owner, meta_key, read_mode::keep_old, now);
  return meta ? read_meta(*meta.content) : errc::bad_value;
}

reading kernel::get_indirectly(peer_id meta_owner, std::string_view meta_key, read_mode mode,
                               instant now) {
  const auto target = look_up(meta_owner, meta_key, now);
  if (!target)
    return {nullptr, false, cause::bad_meta_tuple};
  if (!*target)
    return {};
  return get_tuple(prototype_of((*target)->owner, (*target)->name), mode, now);
}

outputs kernel::set_indirectly(peer_id meta_owner, std::string_view meta_key, tuple_content content,
                               request_id request, instant now) {
  const auto target = look_up(meta_owner, meta_key, now);
  if (!target || !*target) {
    refuse(request, cause::bad_meta_tuple);
    return finish(now);
  }
  return set_remote_tuple((*target)->owner, (*target)->name.text(), std::move(content), request,
                          now);
}

} // namespace rubicon::peis
