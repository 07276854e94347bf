#include "scheduler/process.hpp"

#include <algorithm>
#include <cassert>

#include "scheduler/coordinator.hpp"

namespace rubicon::scheduler {

entered::entered(process* which)
    : before_(std::exchange(executed_process, which)),
      pool_before_(std::exchange(envelope_pool::current,
                                 which != nullptr ? &which->envelopes() : nullptr)) {}

entered::~entered() {
  executed_process = before_;
  envelope_pool::current = pool_before_;
}

process::process(coordinator& owner, caf::actor_system& system, std::size_t number)
    : owner_(owner), number_(number), queue_(*this, system) {}

void process::advance(instant x) {
  if (x > now())
    now_ns_.store(x.time_since_epoch().count(), std::memory_order_relaxed);
}

parallel::event_order process::order_of(instant due) {
  return {std::max(due, now()), acting_ != nullptr ? acting_->path_hash() : number_, sequence_++};
}

parallel::event_order process::order_as_one(instant due) {
  return {std::max(due, now()), number_, sequence_++};
}

movable_message process::schedule(instant due, caf::strong_actor_ptr receiver,
                                  envelope_ptr content) {
  return timeouts_.add_movable(order_of(due),
                               {receiver, std::move(content), receiver, 0, provenance::none()});
}

// -- running

void process::run_before(instant end) {
  const entered here(this);
  while (next() < end) {
    run_instant();
    if (sent_supervisor_at_ == now() || !queue_.empty())
      return;
  }
}

void process::run_instant() {
  const entered here(this);
  const auto at = next();
  advance(at);
  const auto before = queue_.turns();
  for (;;) {
    while (!queue_.empty()) {
      if (owner_.gives_up(queue_.turns() - before))
        return;
      give_turn();
    }
    if (timeouts_.next().value_or(parallel::never) > at)
      return;
    fire_next();
  }
}

void process::fire_next() {
  const entered here(this);
  advance(*timeouts_.next());
  timeouts_.fire_next(*this);
}

void process::give_turn() {
  const entered here(this);
  queue_.give_turn(owner_.max_throughput());
  owner_.on_turn();
}

// -- to others

void process::send(process& to, timeout what, std::optional<instant> due) {
  auto when = to.supervises() ? order_as_one(due.value_or(now())) : order_of(due.value_or(now()));
  when.due = owner_.rounds().arrival(*this, to, when.due);
  if (to.supervises())
    sent_supervisor_at_ = now();
  output_.sent.push_back({this, &to, when, std::move(what)});
}

void process::say(std::function<void()> what) {
  if (!owner_.runs_ahead())
    return what();
  output_.remarks.push_back({order_as_one(now()), std::move(what)});
}

} // namespace rubicon::scheduler
