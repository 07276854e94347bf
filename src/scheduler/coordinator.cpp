#include "scheduler/coordinator.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <limits>
#include <stdexcept>
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

/// Messages that a process sends in a round, except at the start of a run and at its end: larger
/// buffers are released.
constexpr std::size_t sent_capacity_max = 256;

/// In virtual time no time passes while somebody is ready. In wall time it does, so that timeouts
/// that are due must not wait until a flood of messages ends.
constexpr std::size_t wall_turns_per_round = 64;

/// Turns at one instant after which a stop that is requested breaks it off.
constexpr std::uint64_t patience = 10'000;

/// Turns of a round from which on sharing it among threads pays for waking them.
constexpr std::uint64_t turns_worth_sharing = 64;

/// How far one process runs ahead of another at first. Who waits for progress or for Ctrl-C waits
/// for a round; the longer it is, the longer an island runs once its motes are in the cache.
constexpr duration reach_min = 10ms;
constexpr auto round_time = 500ms;

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
      threads_(options_of(system).threads), reach_(reach_min), loop_(options_of(system).loop),
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

void coordinator::link(const process& from, const process& to, duration delay) {
  assert(delay > 0s);
  if (&from != &to)
    horizons_.link(from.number(), to.number(), delay);
}

process* coordinator::sender_here() {
  auto* const x = process::current();
  if (x != nullptr && &x->owner() == this)
    return x;
  return outside_.at_home() ? &supervisor() : nullptr;
}

instant coordinator::arrival(const process& from, const process& to, instant due) const {
  if (to.supervises())
    return due;
  if (from.supervises())
    return cause_ == nullptr || cause_ == &to
               ? due
               : std::max(due, parallel::later(from.now(), supervision_delay));
  if (due - from.now() < horizons_.delay(from.number(), to.number()))
    throw std::logic_error("a message to another process of the simulation without its delay");
  return due;
}

bool coordinator::react_later(add_timeout& x) {
  auto& process = supervisor();
  if (cause_ == nullptr || !x.what.content ||
      x.due >= parallel::later(process.now(), supervision_delay)) // nobody is so far ahead
    return false;
  if (actor_at(x.what.receiver)->where() != &process)
    return false;
  arrivals_.add(process.order_of(x.due), {processes_[cause_->number()].get(), std::move(x.what)});
  return true;
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
  update_next();
  bool stopping = false;
  bool is_stuck = false;
  for (;;) {
    if (outside_.waiting())
      accept_outside();
    take_over_sent();
    if (!stopping && stop_requested_.load(std::memory_order_relaxed)) {
      stopping = true;
      end = supervisor().now();
      for (const auto& x : processes_)
        end = std::max(end, x->now());
    }
    const auto others = next_of_others();
    const auto first = std::min({others, supervisor().next(), next_arrival()});
    const auto next = std::min(first, end);
    say_before(next);
    if (!stopping && !clock_.reached(next)) {
      wait_until(next);
      continue;
    }
    if (first > end || is_stuck) {
      meet(end);
      if (!stopping)
        return stop_cause::reached_end;
      stop_requested_.store(false);
      clock_.halt();
      return stop_cause::requested;
    }
    if (!let_supervise(others))
      let_run(others, end);
    is_stuck = stopping && somebody_is_stuck();
  }
}

bool coordinator::let_supervise(instant others) {
  auto& process = supervisor();
  const auto own = process.next();
  if (own == parallel::never && next_arrival() == parallel::never)
    return false;
  if (own <= next_arrival() && own <= others) {
    together_at_ = own;
    process.run_instant();
    return true;
  }
  if (next_arrival() >= own || next_arrival() >= others)
    return false;
  const entered here(&process);
  process.advance(next_arrival());
  auto arrival = arrivals_.pop();
  cause_ = process.now() == together_at_ ? nullptr : arrival.cause;
  ship(arrival.what, process);
  process.run_instant();
  cause_ = nullptr;
  return true;
}

void coordinator::let_run(instant others, instant end) {
  constexpr duration moment(1);
  const bool ahead = runs_ahead();
  // What the supervisor has done of itself is done to the end before anybody is ahead of it again.
  const auto bound = ahead && others > together_at_
                         ? std::min({supervisor().next(), parallel::later(next_arrival(), moment),
                                     parallel::later(end, moment), parallel::later(others, reach_)})
                         : parallel::later(others, moment);
  const auto safe = horizons_.of(next_);
  round_.clear();
  for (std::size_t i = 1; i < processes_.size(); ++i)
    if (const auto until = std::min(bound, safe[i]); next_[i] < until)
      round_.push_back({processes_[i].get(), until});
  const auto before = turns_so_far();
  const auto started = steady::now();
  if (threads_ > 1 && ahead && round_.size() > 1 && turns_of_round_ >= turns_worth_sharing) {
    if (!workers_) {
      account_ref::share_between_threads();
      workers_ = std::make_unique<parallel::workers>(threads_ - 1);
    }
    workers_->run(round_.size(),
                  [this](std::size_t i) { round_[i].who->run_before(round_[i].end); });
  } else {
    for (const auto& x : round_)
      x.who->run_before(x.end);
  }
  turns_of_round_ = turns_so_far() - before;
  follow_pace(steady::now() - started);
  for (const auto& x : round_)
    next_[x.who->number()] = x.who->next();
  find_first();
}

void coordinator::follow_pace(std::chrono::steady_clock::duration round) {
  if (round > 2 * round_time)
    reach_ = std::max(reach_ / 2, reach_min);
  else if (round < round_time)
    reach_ = std::min(2 * reach_, supervision_delay);
}

std::uint64_t coordinator::turns_so_far() const {
  std::uint64_t sum = 0;
  for (const auto& x : round_)
    sum += x.who->queue().turns();
  return sum;
}

void coordinator::take_over_sent() {
  const auto take = [this](process_output& from) {
    for (auto& x : from.sent) {
      if (x.to->supervises()) {
        arrivals_.add(x.when, {x.from, std::move(x.what)});
      } else {
        auto& next = next_[x.to->number()];
        next = std::min(next, x.when.due);
        next_.front() = std::min(next_.front(), next);
        x.to->timeouts().add(x.when, std::move(x.what));
      }
    }
    from.sent.clear();
    if (from.sent.capacity() > sent_capacity_max)
      from.sent.shrink_to_fit();
    std::ranges::move(from.remarks, std::back_inserter(to_be_said_));
    from.remarks.clear();
  };
  take(supervisor().output());
  for (const auto& x : round_)
    take(x.who->output());
  round_.clear(); // until the next one only the supervisor has something to take over
}

void coordinator::update_next() {
  round_.clear();
  next_.assign(processes_.size(), parallel::never);
  for (std::size_t i = 1; i < processes_.size(); ++i) {
    next_[i] = processes_[i]->next();
    round_.push_back({processes_[i].get(), {}}); // so that what they have sent is taken over
  }
  find_first();
}

/// Each message to the supervisor asks for it: it must not cost a look at all processes then.
void coordinator::find_first() {
  next_.front() = *std::min_element(next_.begin() + 1, next_.end());
}

instant coordinator::next_of_others() {
  if (next_.size() != processes_.size())
    update_next();
  return next_.front();
}

instant coordinator::next_arrival() const {
  return arrivals_.next().value_or(parallel::never);
}

void coordinator::say_before(instant end) {
  const auto due =
      std::ranges::partition(to_be_said_, [end](const auto& x) { return x.when.due < end; });
  std::vector<remark_later> now(std::make_move_iterator(to_be_said_.begin()),
                                std::make_move_iterator(due.begin()));
  to_be_said_.erase(to_be_said_.begin(), due.begin());
  std::ranges::sort(now, [](const auto& a, const auto& b) { return a.when < b.when; });
  for (const auto& x : now)
    x.say();
}

void coordinator::meet(instant at) {
  say_before(parallel::never);
  for (const auto& x : processes_)
    x->advance(at);
}

bool coordinator::somebody_is_stuck() const {
  return std::ranges::any_of(processes_, [](const auto& x) { return !x->queue().empty(); });
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
  update_next();
  const auto end = supervisor().now();
  for (;;) {
    take_over_sent();
    const auto others = next_of_others();
    if (std::min({others, supervisor().next(), next_arrival()}) > end)
      break;
    const bool is_supervisors = let_supervise(others);
    if (!is_supervisors)
      let_run(others, end);
    if (is_supervisors ? !supervisor().queue().empty() : somebody_is_stuck())
      break;
  }
  say_before(parallel::never);
  turns_max_ = std::numeric_limits<std::uint64_t>::max();
  return !somebody_is_stuck();
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
  for (const auto& x : processes_) {
    x->timeouts().close();
    x->output().sent.clear();
  }
  arrivals_.clear();
}

void coordinator::kill_all() {
  for (int round = 0; round < kill_rounds_max; ++round) {
    accept_outside();
    bool any = false;
    for (const auto& x : processes_)
      any = x->queue().kill_all() || any;
    for (const auto& x : processes_)
      x->output().sent.clear();
    if (!any)
      return;
  }
}

void coordinator::detach_io() {
  outside_.detach();
  loop_ = nullptr;
}

std::optional<instant> coordinator::next_timeout() const {
  auto next = next_arrival();
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
