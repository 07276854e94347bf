#include "peis/kernel/subscription_commands.hpp"

#include <utility>

#include "peis/kernel/kernel_turn.hpp"

namespace rubicon::peis {

outputs subscription_commands::subscribe(peer_id owner, std::string_view pattern,
                                         subscription_id id, instant now, request_id request) {
  const auto parsed = key::parse(pattern);
  if (const auto why = layers_.refusal(parsed); why != cause::none) {
    kernel_turn turn(layers_, now);
    turn.report(request, why);
    return turn.finish();
  }
  return subscribe(prototype_of(owner, *parsed), id, now, request);
}

outputs subscription_commands::subscribe(const prototype& wanted, subscription_id id, instant now,
                                         request_id request) {
  return watch(wanted, interest::subscription, id, request, now);
}

outputs subscription_commands::register_callback(const prototype& wanted, subscription_id id,
                                                 instant now, request_id request) {
  return watch(wanted, interest::callback, id, request, now);
}

outputs subscription_commands::watch(const prototype& wanted, interest kind, subscription_id id,
                                     request_id request, instant now) {
  kernel_turn turn(layers_, now);
  auto why = layers_.network.view().own.left ? cause::left : cause::none;
  if (why == cause::none && (id.value >= own_ids_first || layers_.indirect.contains(id)))
    why = cause::bad_handle;
  if (why != cause::none) {
    turn.refuse(request, why);
    return turn.finish();
  }
  if (kind == interest::subscription)
    turn.refresh_statistics(wanted.name);
  auto [verdict, todo] = layers_.tuples.subscribe(wanted, id, kind, now);
  turn.perform(std::move(todo));
  turn.report(request, verdict);
  return turn.finish();
}

outputs subscription_commands::unsubscribe(subscription_id id, instant now, request_id request) {
  kernel_turn turn(layers_, now);
  if (layers_.indirect.contains(id)) {
    turn.perform(layers_.indirect.end(id, layers_.tuples));
    turn.report(request, cause::none);
    return turn.finish();
  }
  auto [why, todo] = layers_.tuples.unsubscribe(id);
  turn.perform(std::move(todo));
  turn.report(request, why);
  return turn.finish();
}

outputs subscription_commands::subscribe_indirectly(peer_id meta_owner, std::string_view meta_key,
                                                    subscription_id id, instant now,
                                                    request_id request) {
  return watch_indirectly(meta_owner, meta_key, interest::subscription, id, request, now);
}

outputs subscription_commands::register_indirect_callback(peer_id meta_owner,
                                                          std::string_view meta_key,
                                                          subscription_id id, instant now,
                                                          request_id request) {
  return watch_indirectly(meta_owner, meta_key, interest::callback, id, request, now);
}

outputs subscription_commands::watch_indirectly(peer_id owner, std::string_view name, interest kind,
                                                subscription_id id, request_id request,
                                                instant now) {
  kernel_turn turn(layers_, now);
  const auto parsed = key::parse(name);
  auto why = layers_.refusal(parsed);
  if (why == cause::none && (owner == any_peer || parsed->is_pattern()))
    why = cause::abstract;
  if (why == cause::none && (id.value >= own_ids_first || layers_.indirect.contains(id) ||
                             layers_.tuples.audience().has_subscription(id)))
    why = cause::bad_handle;
  if (why != cause::none) {
    turn.report(request, why);
    return turn.finish();
  }
  auto [verdict, todo] =
      layers_.indirect.begin(prototype_of(owner, *parsed), id, kind, layers_.tuples, now);
  turn.perform(std::move(todo)); // the reference itself, if we hold it
  if (verdict == cause::none && kind == interest::callback) {
    if (const auto held = layers_.tuples.stored().content(owner, *parsed))
      turn.perform(layers_.indirect.on_held(id, *held, layers_.tuples, now));
  }
  turn.report(request, verdict);
  return turn.finish();
}

} // namespace rubicon::peis
