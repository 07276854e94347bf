#include "scheduler/coordinator.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>
#include <variant>

#include "io/loop.hpp"
#include "scheduler/actor.hpp"
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

/// Turns at one instant after which a stop that is requested breaks it off.
constexpr std::uint64_t patience = 10'000;

/// Rounds of kill_all(); more than one is needed only if the dying spawn.
constexpr int kill_rounds_max = 100;

coordinator_options options_of(const caf::actor_system& system) {
  const auto* config = dynamic_cast<const coordinator_config*>(&system.config());
  return config != nullptr ? config->options : coordinator_options{};
}

} // namespace

coordinator_config::coordinator_config(coordinator_options x) : options(x) {
  load<coordinator>();
}

coordinator::coordinator(caf::actor_system& system)
    : abstract_coordinator(system), outside_(options_of(system).loop),
      clock_(outside_, *processes_.emplace_back(std::make_unique<process>(*this, system, 0)),
             options_of(system).mode, options_of(system).speed),
      rounds_(processes_, options_of(system).threads), loop_(options_of(system).loop),
      poll_interval_(options_of(system).mode == time_mode::wall ? 1ms : 10ms),
      wall_(options_of(system).mode == time_mode::wall),
      in_order_(options_of(system).in_order || options_of(system).speed > 0) {}

coordinator::~coordinator() = default;

caf::actor_system::module* coordinator::make(caf::actor_system& system, caf::detail::type_list<>) {
  return new coordinator(system);
}

coordinator* coordinator::of(caf::actor_system& system) {
  return dynamic_cast<coordinator*>(&system.scheduler());
}

void coordinator::trace(trace_recorder* x) {
  trace_ = x;
  for (const auto& each : processes_)
    each->watch().trace = &x->add_part();
}

// -- processes

process& coordinator::add_process() {
  if (wall_)
    return supervisor();
  auto& added =
      *processes_.emplace_back(std::make_unique<process>(*this, system(), processes_.size()));
  added.advance(supervisor().now());
  if (trace_ != nullptr)
    added.watch().trace = &trace_->add_part();
  return added;
}

process* coordinator::sender_here() {
  auto* const x = process::current();
  if (x != nullptr && &x->owner() == this)
    return x;
  return outside_.at_home() ? &supervisor() : nullptr;
}

// -- running

stop_cause coordinator::run_until(instant end) {
  assert(outside_.at_home() && end >= now());
  clock_.begin(end);
  return processes_.size() == 1 ? run_alone(end) : run_together(end);
}

stop_cause coordinator::run_alone(instant end) {
  auto& process = supervisor();
  const entered here(&process);
  for (;;) {
    run_ready();
    if (processes_.size() > 1) // whoever had its turn has added one
      return run_together(end);
    if (stop_requested_.load(std::memory_order_relaxed)) {
      stop_requested_.store(false);
      clock_.halt();
      return stop_cause::requested;
    }
    const auto due = process.timeouts().next().value_or(parallel::never);
    const auto next = std::min(due, end);
    if (!clock_.reached(next)) {
      if (process.queue().empty())
        wait_until(next);
    } else if (due <= end && due != parallel::never) {
      process.fire_next();
      on_turn();
    } else if (process.queue().empty()) {
      process.advance(end);
      return stop_cause::reached_end;
    }
  }
}

void coordinator::run_ready() {
  if (outside_.waiting())
    accept_outside();
  auto turns = wall_ ? wall_turns_per_round : std::numeric_limits<std::size_t>::max();
  for (; turns > 0 && !supervisor().queue().empty() && processes_.size() == 1; --turns) {
    if (stop_requested_.load(std::memory_order_relaxed))
      return;
    supervisor().give_turn();
  }
}

stop_cause coordinator::run_together(instant end) {
  rounds_.begin();
  bool stopping = false;
  bool is_stuck = false;
  for (;;) {
    if (outside_.waiting())
      accept_outside();
    if (!stopping && stop_requested_.load(std::memory_order_relaxed)) {
      stopping = true;
      end = latest_now();
    }
    const auto first = rounds_.next();
    const auto next = std::min(first, end);
    rounds_.say_before(next);
    if (!stopping && !clock_.reached(next)) {
      wait_until(next);
      continue;
    }
    if (first > end || is_stuck) {
      rounds_.meet(end);
      if (!stopping)
        return stop_cause::reached_end;
      stop_requested_.store(false);
      clock_.halt();
      return stop_cause::requested;
    }
    rounds_.run_next(end, runs_ahead());
    is_stuck = stopping && rounds_.is_stuck();
  }
}

instant coordinator::latest_now() const {
  instant latest{};
  for (const auto& x : processes_)
    latest = std::max(latest, x->now());
  return latest;
}

bool coordinator::gives_up(std::uint64_t turns) const {
  return turns >= turns_max_ ||
         (turns >= patience && stop_requested_.load(std::memory_order_relaxed));
}

bool coordinator::drain(std::size_t turns_max) {
  accept_outside();
  if (processes_.size() > 1)
    return drain_together(turns_max);
  const entered here(&supervisor());
  while (!supervisor().queue().empty() && turns_max-- > 0)
    supervisor().give_turn();
  return supervisor().queue().empty();
}

bool coordinator::drain_together(std::size_t turns_max) {
  turns_max_ = turns_max;
  rounds_.begin();
  const auto end = supervisor().now();
  while (rounds_.next() <= end) {
    rounds_.run_next(end, runs_ahead());
    if (rounds_.is_stuck())
      break;
  }
  rounds_.say_before(parallel::never);
  turns_max_ = std::numeric_limits<std::uint64_t>::max();
  return !rounds_.is_stuck();
}

void coordinator::request_stop() {
  stop_requested_.store(true);
  outside_.wake();
}

void coordinator::on_turn() {
  if (!outside_.at_home() || ++turns_since_look_ < turns_per_look)
    return;
  turns_since_look_ = 0;
  if (processes_.size() == 1 && outside_.waiting())
    accept_outside();
  const auto now = steady::now();
  if (loop_ != nullptr && now - polled_ >= poll_interval_) {
    polled_ = now;
    const entered here(&supervisor()); // what callbacks send
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
  const entered here(&supervisor());
  for (auto& x : outside_.take()) {
    if (auto* const* of_caf = std::get_if<caf::resumable*>(&x))
      supervisor().queue().push(*of_caf);
    else
      clock_.apply(std::move(std::get<add_timeout>(x)));
  }
}

// -- ending

void coordinator::close_clock() {
  for (const auto& x : processes_)
    x->timeouts().close();
  rounds_.drop_sent();
}

void coordinator::kill_all() {
  for (int round = 0; round < kill_rounds_max; ++round) {
    accept_outside();
    bool any = false;
    for (const auto& x : processes_)
      any = x->queue().kill_all() || any;
    rounds_.drop_sent();
    if (!any)
      return;
  }
}

void coordinator::detach_io() {
  outside_.detach();
  loop_ = nullptr;
}

std::optional<instant> coordinator::next_timeout() const {
  auto next = rounds_.next_arrival();
  for (const auto& x : processes_)
    next = std::min(next, x->timeouts().next().value_or(parallel::never));
  return next == parallel::never ? std::nullopt : std::optional(next);
}

statistics coordinator::stats() const {
  statistics sum;
  for (const auto& x : processes_) {
    sum.resumes += x->queue().turns();
    sum.timeouts += x->timeouts().fired();
    sum.waiting += x->timeouts().size();
  }
  return sum;
}

// -- what CAF calls

void coordinator::enqueue(caf::resumable* what) {
  if (outside_.at_home())
    supervisor().queue().push(what);
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
  close_clock();
  kill_all();
  utility_actors_[printer_id] = nullptr;
}

} // namespace rubicon::scheduler
