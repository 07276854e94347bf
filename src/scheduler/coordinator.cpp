#include "scheduler/coordinator.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

#include <caf/exit_reason.hpp>
#include <caf/scheduled_actor.hpp>

#include "io/loop.hpp"
#include "scheduler/printer.hpp"

namespace rubicon::scheduler {

namespace {

using steady = std::chrono::steady_clock;

/// Messages that one actor may handle before the others have their turn.
constexpr std::size_t messages_per_turn = 50;

constexpr unsigned turns_per_look = 16;

/// In virtual time no time passes while somebody is ready. In wall time it does, so that timeouts
/// that are due must not wait until a flood of messages ends.
constexpr std::size_t wall_turns_per_round = 64;

/// Rounds of kill_all(); more than one is needed only if the dying spawn.
constexpr int kill_rounds_max = 100;

coordinator_options options_of(const caf::actor_system& system) {
  const auto* config = dynamic_cast<const coordinator_config*>(&system.config());
  return config != nullptr ? config->options : coordinator_options{};
}

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

coordinator_config::coordinator_config(coordinator_options x) : options(x) {
  load<coordinator>();
}

coordinator::coordinator(caf::actor_system& system)
    : abstract_coordinator(system), outside_(options_of(system).loop),
      clock_(outside_, options_of(system).mode, options_of(system).speed), unit_(*this, system),
      loop_(options_of(system).loop),
      poll_interval_(options_of(system).mode == time_mode::wall ? 1ms : 10ms),
      turns_per_round_(options_of(system).mode == time_mode::wall
                           ? wall_turns_per_round
                           : std::numeric_limits<std::size_t>::max()) {}

coordinator::~coordinator() = default;

caf::actor_system::module* coordinator::make(caf::actor_system& system, caf::detail::type_list<>) {
  return new coordinator(system);
}

coordinator* coordinator::of(caf::actor_system& system) {
  return dynamic_cast<coordinator*>(&system.scheduler());
}

// -- running

stop_cause coordinator::run_until(instant end) {
  assert(outside_.at_home() && end >= now());
  clock_.begin(end);
  for (;;) {
    run_ready();
    if (stop_requested_.load(std::memory_order_relaxed)) {
      stop_requested_.store(false);
      clock_.halt();
      return stop_cause::requested;
    }
    const auto due = clock_.next();
    const auto next = due && *due < end ? *due : end;
    if (!clock_.reached(next)) {
      if (ready_.empty())
        wait_until(next);
    } else if (due && *due <= end) {
      clock_.fire_next(unit_);
      count_turn();
    } else if (ready_.empty()) {
      clock_.advance(end);
      return stop_cause::reached_end;
    }
  }
}

bool coordinator::drain(std::size_t turns_max) {
  accept_outside();
  while (!ready_.empty() && turns_max-- > 0) {
    take_turn(ready_.pop());
    count_turn();
  }
  return ready_.empty();
}

void coordinator::request_stop() {
  stop_requested_.store(true);
  outside_.wake();
}

void coordinator::run_ready() {
  if (outside_.waiting())
    accept_outside();
  for (auto turns = turns_per_round_; turns > 0 && !ready_.empty(); --turns) {
    if (stop_requested_.load(std::memory_order_relaxed))
      return;
    take_turn(ready_.pop());
    count_turn();
  }
}

void coordinator::take_turn(caf::resumable* what) {
  ++resumes_;
  if (const auto* actor = actor_in(what);
      actor != nullptr && !actor->getf(caf::abstract_actor::is_initialized_flag))
    remember(*actor);
  if (what->resume(&unit_, max_throughput()) == caf::resumable::resume_later)
    ready_.push(what);
  else
    caf::intrusive_ptr_release(what);
}

void coordinator::count_turn() {
  if (++turns_since_look_ < turns_per_look)
    return;
  turns_since_look_ = 0;
  if (outside_.waiting())
    accept_outside();
  const auto now = steady::now();
  if (loop_ != nullptr && now - polled_ >= poll_interval_) {
    polled_ = now;
    loop_->poll();
  }
}

void coordinator::wait_until(instant next) {
  assert(loop_ != nullptr);
  loop_->wait_until(clock_.real_time_of(next));
  polled_ = steady::now();
  spare_memory_.give_back(polled_); // only a run in wall time waits, and outlives its floods
}

void coordinator::accept_outside() {
  for (auto& x : outside_.take())
    if (auto* const* what = std::get_if<caf::resumable*>(&x))
      ready_.push(*what);
    else
      std::visit(
          [this]<class Order>(Order& y) {
            if constexpr (!std::is_same_v<Order, caf::resumable*>)
              clock_.apply(std::move(y));
          },
          x);
}

// -- ending

void coordinator::remember(const caf::scheduled_actor& actor) {
  if (roster_.size() >= roster_weeded_) {
    std::erase_if(roster_, [](const caf::weak_actor_ptr& x) {
      const auto strong = x.lock();
      return !strong || ended(static_cast<const caf::scheduled_actor&>(*strong->get()));
    });
    roster_weeded_ = std::max<std::size_t>(64, 2 * roster_.size());
  }
  roster_.emplace_back(actor.ctrl());
}

void coordinator::kill_all() {
  for (int round = 0; round < kill_rounds_max; ++round) {
    accept_outside();
    const auto doomed = std::exchange(roster_, {});
    if (doomed.empty() && ready_.empty())
      return;
    for (const auto& weak : doomed)
      if (const auto x = weak.lock())
        kill(static_cast<caf::scheduled_actor&>(*x->get()), unit_);
    while (!ready_.empty()) {
      auto* what = ready_.pop();
      if (auto* actor = actor_in(what))
        kill(*actor, unit_);
      caf::intrusive_ptr_release(what);
    }
  }
}

void coordinator::detach_io() {
  outside_.detach();
  loop_ = nullptr;
}

statistics coordinator::stats() const {
  return {resumes_, clock_.fired(), clock_.waiting()};
}

// -- what CAF calls

void coordinator::enqueue(caf::resumable* what) {
  if (outside_.at_home())
    ready_.push(what);
  else
    outside_.post(what);
}

void coordinator::init(caf::actor_system_config& config) {
  abstract_coordinator::init(config);
  max_throughput_ = messages_per_turn;
  num_workers_ = 1;
}

void coordinator::start() {
  utility_actors_[printer_id] = make_printer(system());
}

void coordinator::stop() {
  clock_.close();
  kill_all();
  utility_actors_[printer_id] = nullptr;
}

} // namespace rubicon::scheduler
