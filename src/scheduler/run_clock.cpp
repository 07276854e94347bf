#include "scheduler/run_clock.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <caf/actor_system.hpp>

#include "scheduler/actor.hpp"
#include "scheduler/coordinator.hpp"

namespace rubicon::scheduler {

namespace {

using steady = std::chrono::steady_clock;

std::int64_t real_ns() {
  return duration(steady::now().time_since_epoch()).count();
}

[[noreturn]] void refuse() {
  throw std::logic_error(
      "a timeout of CAF's in a world of ours: use timer, or actor::delayed_send");
}

} // namespace

run_clock::run_clock(outside& others, process& supervisor, time_mode mode, double speed)
    : others_(others), supervisor_(supervisor), mode_(mode),
      speed_(mode == time_mode::wall && speed == 0 ? 1 : speed) {
  assert(speed >= 0);
}

// -- run control

void run_clock::begin(instant end) {
  horizon_ns_.store(end.time_since_epoch().count(), std::memory_order_relaxed);
  if (mode_ == time_mode::virtual_time) {
    anchor_ecology_ns_ = supervisor_.now().time_since_epoch().count();
    if (speed_ > 0)
      anchor_real_ns_.store(real_ns(), std::memory_order_relaxed);
  } else if (!started_) {
    anchor_real_ns_.store(real_ns(), std::memory_order_relaxed);
    started_ = true;
  }
}

void run_clock::halt() {
  horizon_ns_.store(now().time_since_epoch().count(), std::memory_order_relaxed);
}

bool run_clock::reached(instant x) const {
  if (mode_ == time_mode::virtual_time && speed_ == 0)
    return true;
  return x <= supervisor_.now() || steady::now() >= real_time_of(x);
}

run_clock::real_time run_clock::real_time_of(instant x) const {
  const real_time anchor{duration(anchor_real_ns_.load(std::memory_order_relaxed))};
  const auto latest_answer = steady::now() + 1h;
  const auto passed_ns =
      std::ceil(static_cast<double>(x.time_since_epoch().count() - anchor_ecology_ns_) / speed_);
  if (passed_ns >= static_cast<double>((latest_answer - anchor).count()))
    return latest_answer;
  return anchor + duration(static_cast<std::int64_t>(passed_ns));
}

process& run_clock::here() const {
  auto* const x = process::current();
  return x != nullptr && &x->owner() == &supervisor_.owner() ? *x : supervisor_;
}

// -- what other threads asked for

void run_clock::apply(add_timeout x) {
  auto& process = here();
  if (process.supervises() && process.owner().rounds().react_later(x))
    return;
  const auto& receiver = *actor_at(x.what.receiver);
  if (receiver.where() != &process)
    process.send(*receiver.where(), std::move(x.what), x.due);
  else
    process.timeouts().add(process.order_of(x.due), std::move(x.what));
}

void run_clock::schedule(instant due, timeout what) {
  if (supervisor_.owner().sender_here() != nullptr)
    apply({due, std::move(what)});
  else
    others_.post(add_timeout{due, std::move(what)});
}

// -- caf::actor_clock

run_clock::time_point run_clock::now() const noexcept {
  const auto latest = here().now().time_since_epoch().count();
  if (mode_ == time_mode::virtual_time)
    return time_point(duration(latest));
  const auto horizon = horizon_ns_.load(std::memory_order_relaxed);
  if (latest >= horizon)
    return time_point(duration(latest));
  const auto passed = real_ns() - anchor_real_ns_.load(std::memory_order_relaxed);
  const auto scaled = static_cast<double>(passed) * speed_;
  const auto time = scaled < static_cast<double>(horizon)
                        ? std::min(horizon, static_cast<std::int64_t>(scaled))
                        : horizon;
  return time_point(duration(std::max(latest, time)));
}

void run_clock::set_ordinary_timeout(time_point, caf::abstract_actor*, caf::atom_value,
                                     std::uint64_t) {
  refuse();
}

void run_clock::set_multi_timeout(time_point, caf::abstract_actor*, caf::atom_value,
                                  std::uint64_t) {
  refuse();
}

void run_clock::set_request_timeout(time_point, caf::abstract_actor*, caf::message_id) {
  refuse();
}

void run_clock::cancel_ordinary_timeout(caf::abstract_actor*, caf::atom_value) {}
void run_clock::cancel_request_timeout(caf::abstract_actor*, caf::message_id) {}
void run_clock::cancel_timeouts(caf::abstract_actor*) {}

void run_clock::schedule_message(time_point, caf::strong_actor_ptr, caf::mailbox_element_ptr) {
  refuse();
}

void run_clock::schedule_message(time_point, caf::group, caf::strong_actor_ptr, caf::message) {
  refuse();
}

void run_clock::cancel_all() {}

run_clock& run_clock_of(caf::actor_system& system) {
  return dynamic_cast<run_clock&>(system.clock());
}

} // namespace rubicon::scheduler
