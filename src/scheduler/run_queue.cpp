#include "scheduler/run_queue.hpp"

#include <algorithm>
#include <utility>

#include "scheduler/actor.hpp"
#include "scheduler/process.hpp"

namespace rubicon::scheduler {

void run_queue::push(actor& what) {
  caf::intrusive_ptr_add_ref(what.ctrl());
  ready_.push({&what, nullptr});
}

void run_queue::give_turn(std::size_t messages_max) {
  const auto whom = ready_.pop();
  if (whom.own != nullptr)
    give_turn(*whom.own, messages_max);
  else
    give_turn(whom.of_caf, messages_max);
}

void run_queue::give_turn(actor& whom, std::size_t messages_max) {
  const caf::strong_actor_ptr reference(whom.ctrl(), false); // it was made ready with one reference
  if (!whom.has_begun()) {
    if (whom.where() != &owner_) {
      owner_.send(*whom.where(), {reference}, {});
      return;
    }
    remember(whom);
  }
  ++turns_;
  if (whom.take_turn(messages_max) == actor::turn_result::has_more)
    push(whom);
}

void run_queue::give_turn(caf::resumable* whom, std::size_t messages_max) {
  ++turns_;
  if (whom->resume(&unit_, messages_max) == caf::resumable::resume_later)
    push(whom);
  else
    caf::intrusive_ptr_release(whom);
}

void run_queue::remember(actor& whom) {
  if (roster_.size() >= roster_weeded_) {
    std::erase_if(roster_, [](const caf::weak_actor_ptr& x) {
      const auto strong = x.lock();
      return !strong || actor_at(strong)->has_ended();
    });
    roster_weeded_ = std::max<std::size_t>(64, 2 * roster_.size());
  }
  roster_.emplace_back(whom.ctrl());
}

bool run_queue::kill_all() {
  const entered here(&owner_);
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
