#include "peis/kernel/tuple_commands.hpp"

#include <string>
#include <utility>

#include "peis/wire/package.hpp"

namespace rubicon::peis {

outputs tuple_commands::set(std::string_view name, tuple_content content, instant now,
                            request_id request) {
  kernel_turn turn(layers_, now);
  const auto parsed = key::parse(name);
  auto why = layers_.refusal(parsed);
  if (why == cause::none) {
    auto [verdict, todo] = layers_.tuples.set(*parsed, std::move(content), now);
    why = verdict;
    turn.perform(std::move(todo));
    if (why == cause::none && parsed->folded() == debug_key)
      layers_.out.emplace_back(debug_requested{
          std::string(layers_.tuples.stored().content(layers_.self(), *parsed)->text())});
  }
  turn.report(request, why);
  return turn.finish();
}

outputs tuple_commands::insert(tuple draft, instant now, request_id request) {
  kernel_turn turn(layers_, now);
  if (layers_.network.view().own.left) {
    turn.report(request, cause::left);
  } else if (draft.owner == layers_.self()) {
    auto [why, todo] = layers_.tuples.insert(std::move(draft), now);
    turn.perform(std::move(todo));
    turn.report(request, why);
  } else {
    const bool quits = draft.expiry != deleted;
    const auto why = refusal_of_owner(draft.owner, draft.name, quits);
    if (why == cause::none && quits)
      expect_quit(draft, request);
    if (why == cause::none)
      turn.ask(layers_.tuples.drafts().ask_to_set(std::move(draft), request, now), request);
    else
      turn.report(request, why);
  }
  return turn.finish();
}

outputs tuple_commands::append(const prototype& wanted, payload added, instant now,
                               request_id request) {
  kernel_turn turn(layers_, now);
  const bool ours = wanted.owner == layers_.self();
  auto why = layers_.network.view().own.left ? cause::left : cause::none;
  if (why == cause::none && !ours && wanted.mimetype)
    why = cause::bad_value;
  if (why == cause::none &&
      added.size() + (wanted.value ? wanted.value->size() : 0) > tuple_value_max)
    why = cause::too_long;
  const auto request_to = [&](peer_id owner) {
    append_request message{wanted, added};
    message.wanted.owner = owner;
    return transmit{owner,
                    port::append_request,
                    {encode_append_request_head(message), added},
                    wanted.owner == any_peer ? no_request : request};
  };
  if (why != cause::none) {
    turn.refuse(request, why);
    return turn.finish();
  }
  if (!ours && wanted.owner != any_peer) {
    turn.ask({refusal_of_owner(wanted.owner, wanted.name, false), request_to(wanted.owner)},
             request);
    return turn.finish();
  }
  auto [verdict, todo] = layers_.tuples.append(wanted, added, now);
  turn.perform(std::move(todo));
  if (!ours) {
    for (const auto* host : layers_.network.view().hosts.records()) {
      if (host->id != layers_.self())
        turn.perform(tuple_events{request_to(host->id)});
    }
  }
  turn.report(request, verdict);
  return turn.finish();
}

outputs tuple_commands::remove(std::string_view name, instant now, request_id request) {
  kernel_turn turn(layers_, now);
  const auto parsed = key::parse(name);
  const auto why = layers_.refusal(parsed);
  if (why == cause::none)
    turn.perform(layers_.tuples.remove(*parsed, now));
  turn.report(request, why);
  return turn.finish();
}

outputs tuple_commands::set_remote(peer_id owner, std::string_view name, tuple_content content,
                                   request_id request, instant now) {
  if (owner == layers_.self())
    return set(name, std::move(content), now, request);
  kernel_turn turn(layers_, now);
  const auto parsed = key::parse(name);
  auto why = layers_.refusal(parsed);
  if (why == cause::none) {
    auto x = layers_.tuples.drafts().draft(owner, *parsed, std::move(content));
    if (!x || parsed->is_pattern())
      why = x ? cause::bad_key : cause::bad_value;
    else
      why = refusal_of_owner(owner, *parsed, true);
    if (why == cause::none) {
      expect_quit(*x, request);
      turn.ask(layers_.tuples.drafts().ask_to_set(std::move(*x), request, now), request);
      return turn.finish();
    }
  }
  turn.report(request, why);
  return turn.finish();
}

outputs tuple_commands::remove_remote(peer_id owner, std::string_view name, request_id request,
                                      instant now) {
  if (owner == layers_.self())
    return remove(name, now, request);
  kernel_turn turn(layers_, now);
  const auto parsed = key::parse(name);
  auto why = layers_.refusal(parsed);
  if (why == cause::none)
    why = refusal_of_owner(owner, *parsed, false);
  if (why == cause::none)
    turn.ask(layers_.tuples.drafts().ask_to_delete(owner, *parsed, request, now), request);
  else
    turn.report(request, why);
  return turn.finish();
}

/// What every kernel of our kind refuses is not sent: an acknowledgement says that it has arrived,
/// and not what has become of it. Real kernels decide for themselves.
/// @param quits it may be the request to quit, which some may send
cause tuple_commands::refusal_of_owner(peer_id owner, const key& name, bool quits) const {
  const auto* record = layers_.network.view().hosts.record_of(owner);
  const bool is_of_our_kind = record != nullptr && record->marked;
  const bool may_be_taken = !is_reserved(name) || (quits && name.folded() == quit_key);
  return is_of_our_kind && !may_be_taken ? cause::refused : cause::none;
}

/// @param asked is sent next
void tuple_commands::expect_quit(const tuple& asked, request_id request) {
  const auto view = layers_.network.view();
  const auto* record = view.hosts.record_of(asked.owner);
  if (request != no_request && asked.name.folded() == quit_key && asks_to_quit(asked) &&
      record != nullptr && record->marked && !view.hosts.shares_host(asked.owner))
    layers_.quits.expect(request, asked.owner);
}

} // namespace rubicon::peis
