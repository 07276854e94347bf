// The tuple commands of a kernel and looking at what it holds.
#include <utility>

#include "peis/kernel/kernel.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

outputs kernel::set_tuple(std::string_view name, tuple_content content, instant now,
                          request_id request) {
  const auto parsed = key::parse(name);
  auto why = refusal(parsed);
  if (why == cause::none) {
    auto [verdict, todo] = tuples_.set(*parsed, std::move(content), now);
    why = verdict;
    perform(std::move(todo), now);
    if (why == cause::none && parsed->folded() == debug_key)
      out_.emplace_back(
          debug_requested{std::string(tuples_.stored().content(id(), *parsed)->text())});
  }
  report(request, why);
  return finish(now);
}

outputs kernel::insert_tuple(tuple draft, instant now, request_id request) {
  if (network_.view().own.left) {
    report(request, cause::left);
  } else if (draft.owner == id()) {
    auto [why, todo] = tuples_.insert(std::move(draft), now);
    perform(std::move(todo), now);
    report(request, why);
  } else {
    const bool quits = draft.expiry != deleted;
    const auto why = refusal_of_owner(draft.owner, draft.name, quits);
    if (why != cause::none)
      return ask({why, {}}, request, now);
    if (quits)
      expect_quit(draft, request);
    return ask(tuples_.drafts().ask_to_set(std::move(draft), request, now), request, now);
  }
  return finish(now);
}

outputs kernel::append_tuple(const prototype& wanted, payload added, instant now,
                             request_id request) {
  const bool ours = wanted.owner == id();
  auto why = network_.view().own.left ? cause::left : cause::none;
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
    refuse(request, why);
    return finish(now);
  }
  if (!ours && wanted.owner != any_peer)
    return ask({refusal_of_owner(wanted.owner, wanted.name, false), request_to(wanted.owner)},
               request, now);
  auto [verdict, todo] = tuples_.append(wanted, added, now);
  perform(std::move(todo), now);
  if (!ours) {
    for (const auto* host : network_.view().hosts.records()) {
      if (host->id != id())
        perform({request_to(host->id)}, now);
    }
  }
  report(request, verdict);
  return finish(now);
}

outputs kernel::delete_tuple(std::string_view name, instant now, request_id request) {
  const auto parsed = key::parse(name);
  const auto why = refusal(parsed);
  if (why == cause::none)
    perform(tuples_.remove(*parsed, now), now);
  report(request, why);
  return finish(now);
}

outputs kernel::set_remote_tuple(peer_id owner, std::string_view name, tuple_content content,
                                 request_id request, instant now) {
  if (owner == id())
    return set_tuple(name, std::move(content), now, request);
  const auto parsed = key::parse(name);
  auto why = refusal(parsed);
  if (why != cause::none)
    return ask({why, {}}, request, now);
  auto x = tuples_.drafts().draft(owner, *parsed, std::move(content));
  if (!x || parsed->is_pattern())
    return ask({x ? cause::bad_key : cause::bad_value, {}}, request, now);
  if (why = refusal_of_owner(owner, *parsed, true); why != cause::none)
    return ask({why, {}}, request, now);
  expect_quit(*x, request);
  return ask(tuples_.drafts().ask_to_set(std::move(*x), request, now), request, now);
}

outputs kernel::delete_remote_tuple(peer_id owner, std::string_view name, request_id request,
                                    instant now) {
  if (owner == id())
    return delete_tuple(name, now, request);
  const auto parsed = key::parse(name);
  auto why = refusal(parsed);
  if (why == cause::none)
    why = refusal_of_owner(owner, *parsed, false);
  if (why != cause::none)
    return ask({why, {}}, request, now);
  return ask(tuples_.drafts().ask_to_delete(owner, *parsed, request, now), request, now);
}

/// What every kernel of our kind refuses is not sent: an acknowledgement says that it has arrived,
/// and not what has become of it. What real kernels do is theirs.
/// @param quits it may be the word to quit, which some are allowed to say
cause kernel::refusal_of_owner(peer_id owner, const key& name, bool quits) const {
  const auto* record = network_.view().hosts.record_of(owner);
  const bool is_of_our_kind = record != nullptr && record->marked;
  const bool may_be_taken = !is_reserved(name) || (quits && name.folded() == quit_key);
  return is_of_our_kind && !may_be_taken ? cause::refused : cause::none;
}

/// Sends a question to another owner, or says why there is none.
outputs kernel::ask(std::pair<cause, transmit> question, request_id request, instant now) {
  if (question.first == cause::none)
    perform({std::move(question.second)}, now);
  else
    report(request, question.first);
  return finish(now);
}

void kernel::refuse(request_id request, cause why) {
  ++refused_;
  report(request, why);
}

outputs kernel::subscribe(peer_id owner, std::string_view pattern, subscription_id id, instant now,
                          request_id request) {
  const auto parsed = key::parse(pattern);
  if (const auto why = refusal(parsed); why != cause::none) {
    report(request, why);
    return finish(now);
  }
  return subscribe(prototype_of(owner, *parsed), id, now, request);
}

outputs kernel::subscribe(const prototype& wanted, subscription_id id, instant now,
                          request_id request) {
  return watch(wanted, tuple_space::interest::subscription, id, request, now);
}

outputs kernel::register_callback(const prototype& wanted, subscription_id id, instant now,
                                  request_id request) {
  return watch(wanted, tuple_space::interest::callback, id, request, now);
}

outputs kernel::watch(const prototype& wanted, tuple_space::interest kind, subscription_id id,
                      request_id request, instant now) {
  auto why = network_.view().own.left ? cause::left : cause::none;
  if (why == cause::none && (id.value >= own_ids_first || indirections_.contains(id)))
    why = cause::bad_handle;
  if (why != cause::none) {
    refuse(request, why);
    return finish(now);
  }
  if (kind == tuple_space::interest::subscription)
    refresh_statistics(wanted.name, now);
  auto [verdict, todo] = tuples_.subscribe(wanted, id, kind, now);
  perform(std::move(todo), now);
  report(request, verdict);
  return finish(now);
}

outputs kernel::unsubscribe(subscription_id id, instant now, request_id request) {
  if (const auto at = indirections_.find(id); at != indirections_.end()) {
    perform(tuples_.unsubscribe(at->second.meta_watch).second, now);
    perform(tuples_.unsubscribe(id).second, now); // unless it points nowhere now
    meta_watches_.erase(at->second.meta_watch);
    indirections_.erase(at);
    report(request, cause::none);
    return finish(now);
  }
  auto [why, todo] = tuples_.unsubscribe(id);
  perform(std::move(todo), now);
  report(request, why);
  return finish(now);
}

void kernel::publish(const kernel_statistics::texts& values, instant now) {
  for (const auto& [name, text] : values) {
    const acting_on its(provenance::begin("value"));
    perform(tuples_.set(name, text_content(text), now).second, now);
  }
}

/// Nobody watches these, so this sends nothing (TUP-14).
void kernel::refresh_statistics(const key& looked_at, instant now) {
  publish(statistics_.stale(looked_at, network_, tuples_, now), now);
}

reading kernel::get_tuple(peer_id owner, std::string_view name, read_mode mode, instant now) {
  const auto parsed = key::parse(name);
  if (!parsed)
    return {nullptr, false, cause::bad_key};
  return get_tuple(prototype_of(owner, *parsed), mode, now);
}

reading kernel::get_tuple(const prototype& wanted, read_mode mode, instant now) {
  if (wanted.owner == any_peer || wanted.name.is_pattern())
    return {nullptr, false, cause::abstract};
  result_set found;
  get_tuples(wanted, found, now, mode);
  return found.next() ? found.value() : reading();
}

void kernel::get_tuples(const prototype& wanted, result_set& into, instant now, read_mode mode) {
  if (wanted.owner == id() || wanted.owner == any_peer)
    refresh_statistics(wanted.name, now);
  tuples_.stored().read(wanted, now, [&](const tuple_pointer& x, bool is_new) {
    const bool taken = is_new || mode == read_mode::keep_old;
    if (taken)
      into.append({x, is_new, cause::none});
    return taken;
  });
}

tuple_pointer kernel::find_tuple(peer_id owner, std::string_view name) const {
  const auto parsed = key::parse(name);
  return parsed ? tuples_.stored().content(owner, *parsed) : nullptr;
}

std::vector<tuple_pointer> kernel::own_tuples() const {
  return tuples_.stored().find_all(prototype_of(id(), key()));
}

std::vector<tuple_pointer> kernel::find_tuples(peer_id owner, std::string_view pattern) const {
  const auto parsed = key::parse(pattern);
  return parsed ? tuples_.stored().find_all(prototype_of(owner, *parsed))
                : std::vector<tuple_pointer>();
}

bool kernel::is_waiting(std::string_view name) const {
  const auto parsed = key::parse(name);
  return parsed && tuples_.is_waiting(*parsed);
}

bool kernel::has_subscriber(std::string_view name) const {
  const auto parsed = key::parse(name);
  return parsed && tuples_.audience().has_subscriber(*parsed);
}

} // namespace rubicon::peis
