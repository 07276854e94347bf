#include "scheduler/process.hpp"

#include <algorithm>
#include <cassert>

#include "scheduler/actor.hpp"
#include "scheduler/coordinator.hpp"

namespace rubicon::scheduler {

entered::entered(process* which)
    : before_(std::exchange(executed_process, which)),
      pool_before_(
          std::exchange(envelope_pool::current, which != nullptr ? &which->envelopes_ : nullptr)) {}

entered::~entered() {
  executed_process = before_;
  envelope_pool::current = pool_before_;
}

process::process(coordinator& owner, caf::actor_system& system, std::size_t number)
    : owner_(owner), number_(number), unit_(*this, system) {}

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
    if (sent_supervisor_at_ == now() || anybody_ready())
      return;
  }
}

void process::run_instant() {
  const entered here(this);
  const auto at = next();
  advance(at);
  const auto before = turns_;
  for (;;) {
    while (!ready_.empty()) {
      if (owner_.gives_up(turns_ - before))
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
  const auto whom = ready_.pop();
  if (whom.own != nullptr)
    give_turn(*whom.own);
  else
    give_turn(whom.of_caf);
  owner_.on_turn();
}

void process::give_turn(actor& whom) {
  const caf::strong_actor_ptr reference(whom.ctrl(), false); // it was made ready with one reference
  if (!whom.has_begun()) {
    if (whom.where() != this) {
      send(*whom.where(), {reference}, {});
      return;
    }
    remember(whom);
  }
  ++turns_;
  if (whom.take_turn(owner_.max_throughput()) == actor::turn_result::has_more)
    make_ready(whom);
}

void process::give_turn(caf::resumable* whom) {
  ++turns_;
  if (whom->resume(&unit_, owner_.max_throughput()) == caf::resumable::resume_later)
    make_ready(whom);
  else
    caf::intrusive_ptr_release(whom);
}

void process::make_ready(actor& what) {
  caf::intrusive_ptr_add_ref(what.ctrl());
  ready_.push({&what, nullptr});
}

// -- to others

void process::send(process& to, timeout what, std::optional<instant> due) {
  auto when = to.supervises() ? order_as_one(due.value_or(now())) : order_of(due.value_or(now()));
  when.due = owner_.arrival(*this, to, when.due);
  if (to.supervises())
    sent_supervisor_at_ = now();
  sent_.push_back({this, &to, when, std::move(what)});
}

void process::say(std::function<void()> what) {
  if (!owner_.runs_ahead())
    return what();
  to_be_said_.push_back({order_as_one(now()), std::move(what)});
}

// -- ending

void process::remember(actor& whom) {
  if (roster_.size() >= roster_weeded_) {
    std::erase_if(roster_, [](const caf::weak_actor_ptr& x) {
      const auto strong = x.lock();
      return !strong || actor_at(strong)->has_ended();
    });
    roster_weeded_ = std::max<std::size_t>(64, 2 * roster_.size());
  }
  roster_.emplace_back(whom.ctrl());
}

bool process::kill_all() {
  const entered here(this);
  const auto doomed = std::exchange(roster_, {});
  if (doomed.empty() && ready_.empty())
    return false;
  for (const auto& weak : doomed)
    if (const auto x = weak.lock())
      actor_at(x)->kill();
  while (!ready_.empty()) {
    const auto whom = ready_.pop();
    if (whom.own != nullptr) {
      const caf::strong_actor_ptr reference(whom.own->ctrl(), false);
      whom.own->kill();
    } else {
      caf::intrusive_ptr_release(whom.of_caf); // ends with the actor system
    }
  }
  return true;
}

} // namespace rubicon::scheduler
