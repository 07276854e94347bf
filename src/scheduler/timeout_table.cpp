#include "scheduler/timeout_table.hpp"

#include <utility>

#include "scheduler/actor.hpp"
#include "scheduler/process.hpp"

namespace rubicon::scheduler {

void ship(timeout& x, process& here) {
  auto* const receiver = actor_at(x.receiver);
  if (!x.content) {
    here.queue().push(*receiver);
    return;
  }
  const acting_on sent(x.from);
  receiver->deliver(std::move(x.content), actor_at(x.sender));
}

void timeout_table::fire_next(process& here) {
  const auto due = *timers_.next();
  do {
    auto what = timers_.pop();
    ++fired_;
    ship(what, here);
  } while (timers_.next() == due);
}

void timeout_table::add(const parallel::event_order& when, timeout what) {
  if (!closed_)
    timers_.add(when, std::move(what));
}

movable_message timeout_table::add_movable(const parallel::event_order& when, timeout what) {
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
  return x.number != 0 && timers_.pending(x.slot) && timers_[x.slot].number == x.number;
}

void timeout_table::clear() {
  timers_.clear();
}

void timeout_table::close() {
  closed_ = true;
  clear();
}

} // namespace rubicon::scheduler
