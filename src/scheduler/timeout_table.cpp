#include "scheduler/timeout_table.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include <caf/error.hpp>
#include <caf/sec.hpp>
#include <caf/system_messages.hpp>

namespace rubicon::scheduler {

namespace {

/// Hands a timeout that has fired to whom it is for.
struct shipper {
  caf::execution_unit& unit;

  void operator()(actor_message& x) const {
    const acting_on sent(x.from);
    x.receiver->enqueue(std::move(x.content), &unit);
  }

  void operator()(actor_timeout& x) const {
    if (x.key.kind == timeout_kind::request)
      x.self->get()->eq_impl(x.mid, x.self, &unit, caf::make_error(caf::sec::request_timeout));
    else
      x.self->get()->eq_impl(caf::make_message_id(), x.self, &unit,
                             caf::timeout_msg{static_cast<caf::atom_value>(x.key.what), x.id});
  }

  void operator()(group_message& x) const {
    x.target.get()->enqueue(std::move(x.sender), caf::make_message_id(), std::move(x.content),
                            &unit);
  }

  void operator()(first_turn& x) const { unit.exec_later(x.take()); }
};

} // namespace

void ship(timeout& x, caf::execution_unit& unit) {
  std::visit(shipper{unit}, x);
}

void timeout_table::fire_next(caf::execution_unit& unit) {
  const auto due = *timers_.next();
  do {
    const auto which = timers_.front();
    auto what = timers_.pop();
    if (const auto* x = std::get_if<actor_timeout>(&what))
      forget_key(x->key, which);
    ++fired_;
    ship(what, unit);
  } while (timers_.next() == due);
}

void timeout_table::add(const parallel::event_order& when, timeout what) {
  if (closed_)
    return;
  const auto* x = std::get_if<actor_timeout>(&what);
  if (x == nullptr) {
    timers_.add(when, std::move(what));
    return;
  }
  const auto key = x->key;
  if (key.kind == timeout_kind::ordinary)
    cancel(key);
  keys_.emplace(key, timers_.add(when, std::move(what)));
}

movable_message timeout_table::add_movable(const parallel::event_order& when, actor_message what) {
  if (closed_)
    return {};
  const auto number = what.number = ++movable_messages_;
  return {timers_.add(when, std::move(what)), number};
}

bool timeout_table::move(const movable_message& x, const parallel::event_order& when) {
  if (!pending(x))
    return false;
  timers_.move(x.slot, when);
  return true;
}

void timeout_table::cancel(const movable_message& x) {
  if (pending(x))
    timers_.cancel(x.slot);
}

bool timeout_table::pending(const movable_message& x) const {
  if (x.number == 0 || !timers_.pending(x.slot))
    return false;
  const auto* message = std::get_if<actor_message>(&timers_[x.slot]);
  return message != nullptr && message->number == x.number;
}

void timeout_table::forget_key(const timeout_key& key, ticket which) {
  auto [i, end] = keys_.equal_range(key);
  i = std::find_if(i, end, [=](const auto& x) { return x.second == which; });
  assert(i != end);
  keys_.erase(i);
}

// What is cancelled may hold the last reference to an actor, whose end cancels its timeouts: keys
// go first, and no iterator lives across a cancellation.
void timeout_table::cancel(const timeout_key& x) {
  if (const auto i = keys_.find(x); i != keys_.end()) {
    const auto which = i->second;
    keys_.erase(i);
    timers_.cancel(which);
  }
}

void timeout_table::cancel(caf::actor_id x) {
  for (;;) {
    const auto i = keys_.lower_bound(timeout_key{x});
    if (i == keys_.end() || i->first.actor != x)
      return;
    const auto which = i->second;
    keys_.erase(i);
    timers_.cancel(which);
  }
}

void timeout_table::clear() {
  keys_.clear();
  timers_.clear();
}

void timeout_table::close() {
  closed_ = true;
  clear();
}

} // namespace rubicon::scheduler
