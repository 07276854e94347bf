#include "scheduler/process_rounds.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "core/account/provenance.hpp"
#include "scheduler/actor.hpp"

namespace rubicon::scheduler {

namespace {

/// Messages that a process sends in a round, except at the start of a run and at its end: larger
/// buffers are released.
constexpr std::size_t sent_capacity_max = 256;

/// Turns of a round from which on sharing it among threads pays for waking them.
constexpr std::uint64_t turns_worth_sharing = 64;

/// Who waits for progress or for Ctrl-C waits for a round; the longer it is, the longer an island
/// runs once its motes are in the cache.
constexpr auto round_time = 500ms;

} // namespace

// -- what processes send each other

void process_rounds::link(const process& from, const process& to, duration delay) {
  assert(delay > 0s);
  if (&from != &to)
    horizons_.link(from.number(), to.number(), delay);
}

instant process_rounds::arrival(const process& from, const process& to, instant due) const {
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

bool process_rounds::react_later(add_timeout& x) {
  auto& process = supervisor();
  if (cause_ == nullptr || !x.what.content ||
      x.due >= parallel::later(process.now(), supervision_delay)) // nobody is so far ahead
    return false;
  if (actor_at(x.what.receiver)->where() != &process)
    return false;
  arrivals_.add(process.order_of(x.due), {processes_[cause_->number()].get(), std::move(x.what)});
  return true;
}

instant process_rounds::next_arrival() const {
  return arrivals_.next().value_or(parallel::never);
}

void process_rounds::take_over(process_output& from) {
  for (auto& x : from.sent) {
    if (x.to->supervises()) {
      arrivals_.add(x.when, {x.from, std::move(x.what)});
    } else {
      assert(x.to->number() < next_.size());
      auto& next = next_[x.to->number()];
      next = std::min(next, x.when.due);
      first_of_others_ = std::min(first_of_others_, next);
      x.to->timeouts().add(x.when, std::move(x.what));
    }
  }
  from.sent.clear();
  if (from.sent.capacity() > sent_capacity_max)
    from.sent.shrink_to_fit();
  std::ranges::move(from.remarks, std::back_inserter(to_be_said_));
  from.remarks.clear();
}

void process_rounds::drop_sent() {
  for (const auto& x : processes_)
    x->output().sent.clear();
  arrivals_.clear();
}

// -- rounds

void process_rounds::begin() {
  round_.clear();
  next_.assign(processes_.size(), parallel::never);
  for (std::size_t i = 1; i < processes_.size(); ++i) {
    next_[i] = processes_[i]->next();
    round_.push_back({processes_[i].get(), {}}); // so that what they have sent is taken over
  }
  first_of_others_ = *std::ranges::min_element(next_);
}

instant process_rounds::next() {
  if (next_.size() != processes_.size()) // the supervisor has added one
    begin();
  take_over(supervisor().output());
  for (const auto& x : round_)
    take_over(x.who->output());
  round_.clear(); // if the supervisor is next, only it has something to take over afterwards
  return std::min({first_of_others_, supervisor().next(), next_arrival()});
}

void process_rounds::run_next(instant end, bool ahead) {
  const auto others = first_of_others_;
  if (!let_supervise(others))
    let_run(others, end, ahead);
}

bool process_rounds::let_supervise(instant others) {
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

void process_rounds::let_run(instant others, instant end, bool ahead) {
  constexpr duration moment(1);
  // What the supervisor has done of itself is done to the end before anybody is ahead of it again.
  const auto bound = ahead && others > together_at_
                         ? std::min({supervisor().next(), parallel::later(next_arrival(), moment),
                                     parallel::later(end, moment), parallel::later(others, reach_)})
                         : parallel::later(others, moment);
  const auto safe = horizons_.of(next_);
  for (std::size_t i = 1; i < processes_.size(); ++i)
    if (const auto until = std::min(bound, safe[i]); next_[i] < until)
      round_.push_back({processes_[i].get(), until});
  run_round(ahead);
  for (const auto& x : round_)
    next_[x.who->number()] = x.who->next();
  first_of_others_ = *std::ranges::min_element(next_);
}

/// @param may_share among threads
void process_rounds::run_round(bool may_share) {
  const auto before = turns_so_far();
  const auto started = std::chrono::steady_clock::now();
  if (threads_ > 1 && may_share && round_.size() > 1 && turns_of_round_ >= turns_worth_sharing) {
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
  follow_pace(std::chrono::steady_clock::now() - started);
}

void process_rounds::follow_pace(std::chrono::steady_clock::duration round) {
  if (round > 2 * round_time)
    reach_ = std::max(reach_ / 2, reach_min);
  else if (round < round_time)
    reach_ = std::min(2 * reach_, supervision_delay);
}

std::uint64_t process_rounds::turns_so_far() const {
  std::uint64_t sum = 0;
  for (const auto& x : round_)
    sum += x.who->queue().turns();
  return sum;
}

bool process_rounds::is_stuck() const {
  return !supervisor().queue().empty() ||
         std::ranges::any_of(round_, [](const auto& x) { return !x.who->queue().empty(); });
}

void process_rounds::say_before(instant end) {
  const auto due =
      std::ranges::partition(to_be_said_, [end](const auto& x) { return x.when.due < end; });
  std::vector<remark_later> now(std::make_move_iterator(to_be_said_.begin()),
                                std::make_move_iterator(due.begin()));
  to_be_said_.erase(to_be_said_.begin(), due.begin());
  std::ranges::sort(now, [](const auto& a, const auto& b) { return a.when < b.when; });
  for (const auto& x : now)
    x.say();
}

void process_rounds::meet(instant at) {
  say_before(parallel::never);
  for (const auto& x : processes_)
    x->advance(at);
}

} // namespace rubicon::scheduler
