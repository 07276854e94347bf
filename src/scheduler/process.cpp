#include "scheduler/process.hpp"

#include <algorithm>
#include <cassert>

#include <caf/error.hpp>
#include <caf/exit_reason.hpp>

#include "scheduler/coordinator.hpp"

namespace rubicon::scheduler {

namespace {

caf::scheduled_actor* actor_in(caf::resumable* x) {
  return x->subtype() == caf::resumable::scheduled_actor ? static_cast<caf::scheduled_actor*>(x)
                                                         : nullptr;
}

bool ended(const caf::scheduled_actor& x) {
  return x.getf(caf::abstract_actor::is_cleaned_up_flag);
}

/// As exit_reason::kill does, but without the mailbox: an actor that awaits a response would not
/// look into it.
void kill(caf::scheduled_actor& x, caf::execution_unit& unit) {
  x.context(&unit);
  x.quit(caf::make_error(caf::exit_reason::kill));
  x.finalize();
}

} // namespace

process* owner_of(caf::resumable& x) {
  auto* const actor = actor_in(&x);
  const auto* placed = actor != nullptr ? dynamic_cast<traced_base*>(actor) : nullptr;
  return placed != nullptr ? placed->where() : nullptr;
}

entered::entered(process* which) : before_(std::exchange(executed_process, which)) {}

entered::~entered() {
  executed_process = before_;
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
                                  caf::mailbox_element_ptr content) {
  return timeouts_.add_movable(
      order_of(due), actor_message{std::move(receiver), std::move(content), 0, provenance::none()});
}

// -- running

void process::run_before(instant end) {
  const entered here(this);
  while (next() < end) {
    run_instant();
    if (told_supervisor_ == now() || anybody_ready())
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
  timeouts_.fire_next(unit_);
}

void process::give_turn() {
  const entered here(this);
  auto* const what = ready_.pop();
  if (auto* const actor = actor_in(what);
      actor != nullptr && !actor->getf(caf::abstract_actor::is_initialized_flag)) {
    auto* const its = owner_of(*what);
    if (its != nullptr && its != this) {
      send(*its, first_turn(what), {});
      return;
    }
    remember(*actor);
  }
  ++turns_;
  if (what->resume(&unit_, owner_.max_throughput()) == caf::resumable::resume_later)
    ready_.push(what);
  else
    caf::intrusive_ptr_release(what);
  owner_.on_turn();
}

// -- to others

void process::send(process& to, timeout what, std::optional<instant> due) {
  auto when = to.supervises() ? order_as_one(due.value_or(now())) : order_of(due.value_or(now()));
  when.due = owner_.arrival(*this, to, when.due);
  if (to.supervises())
    told_supervisor_ = now();
  sent_.push_back({this, &to, when, std::move(what)});
}

void process::say(std::function<void()> what) {
  if (!owner_.runs_ahead())
    return what();
  to_be_said_.push_back({order_as_one(now()), std::move(what)});
}

bool traced_base::cross(caf::abstract_actor& self, caf::mailbox_element_ptr& x) {
  auto* from = process_->owner().sender_here();
  if (from == nullptr || from == process_)
    return false;
  from->send(*process_, actor_message{caf::strong_actor_ptr(self.ctrl()), std::move(x)}, {});
  return true;
}

// -- ending

void process::remember(const caf::scheduled_actor& actor) {
  if (roster_.size() >= roster_weeded_) {
    std::erase_if(roster_, [](const caf::weak_actor_ptr& x) {
      const auto strong = x.lock();
      return !strong || ended(static_cast<const caf::scheduled_actor&>(*strong->get()));
    });
    roster_weeded_ = std::max<std::size_t>(64, 2 * roster_.size());
  }
  roster_.emplace_back(actor.ctrl());
}

bool process::kill_all() {
  const entered here(this);
  const auto doomed = std::exchange(roster_, {});
  if (doomed.empty() && ready_.empty())
    return false;
  for (const auto& weak : doomed)
    if (const auto x = weak.lock())
      kill(static_cast<caf::scheduled_actor&>(*x->get()), unit_);
  while (!ready_.empty()) {
    auto* const what = ready_.pop();
    if (auto* const actor = actor_in(what))
      kill(*actor, unit_);
    caf::intrusive_ptr_release(what);
  }
  return true;
}

} // namespace rubicon::scheduler
