#include "scheduler/run_clock.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <caf/actor_system.hpp>

#include "scheduler/coordinator.hpp"

namespace rubicon::scheduler {

namespace {

using steady = std::chrono::steady_clock;

std::int64_t real_ns() {
  return duration(steady::now().time_since_epoch()).count();
}

timeout_key receive_key(const caf::abstract_actor* self, timeout_kind kind, caf::atom_value type) {
  return {self->id(), kind, static_cast<std::uint64_t>(type)};
}

timeout_key request_key(const caf::abstract_actor* self, caf::message_id id) {
  return {self->id(), timeout_kind::request, id.integer_value()};
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
  if (process.supervises() && process.owner().react_later(x))
    return;
  auto* const message = std::get_if<actor_message>(&x.what);
  const auto* const placed =
      message != nullptr ? dynamic_cast<const traced_base*>(message->receiver->get()) : nullptr;
  if (placed != nullptr && placed->where() != nullptr && placed->where() != &process)
    process.send(*placed->where(), std::move(x.what), x.due);
  else
    process.timeouts().add(process.order_of(x.due), std::move(x.what));
}

void run_clock::apply(const cancel_timeout& x) {
  here().timeouts().cancel(x.key);
}

void run_clock::apply(const cancel_actor& x) {
  here().timeouts().cancel(x.actor);
}

void run_clock::apply(const cancel_everything&) {
  here().timeouts().clear();
}

template <class Order>
void run_clock::ask(Order x) {
  if (process::current() != nullptr || others_.at_home())
    apply(std::move(x));
  else
    others_.post(std::move(x));
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

void run_clock::set_ordinary_timeout(time_point t, caf::abstract_actor* self, caf::atom_value type,
                                     std::uint64_t id) {
  ask(add_timeout{to_instant(t), actor_timeout{caf::strong_actor_ptr(self->ctrl()),
                                               receive_key(self, timeout_kind::ordinary, type),
                                               id,
                                               {}}});
}

void run_clock::set_multi_timeout(time_point t, caf::abstract_actor* self, caf::atom_value type,
                                  std::uint64_t id) {
  ask(add_timeout{to_instant(t), actor_timeout{caf::strong_actor_ptr(self->ctrl()),
                                               receive_key(self, timeout_kind::multi, type),
                                               id,
                                               {}}});
}

void run_clock::set_request_timeout(time_point t, caf::abstract_actor* self, caf::message_id id) {
  ask(add_timeout{to_instant(t), actor_timeout{caf::strong_actor_ptr(self->ctrl()),
                                               request_key(self, id), 0, id}});
}

void run_clock::cancel_ordinary_timeout(caf::abstract_actor* self, caf::atom_value type) {
  ask(cancel_timeout{receive_key(self, timeout_kind::ordinary, type)});
}

void run_clock::cancel_request_timeout(caf::abstract_actor* self, caf::message_id id) {
  ask(cancel_timeout{request_key(self, id)});
}

void run_clock::cancel_timeouts(caf::abstract_actor* self) {
  ask(cancel_actor{self->id()});
}

void run_clock::schedule_message(time_point t, caf::strong_actor_ptr receiver,
                                 caf::mailbox_element_ptr content) {
  ask(add_timeout{to_instant(t), actor_message{std::move(receiver), std::move(content)}});
}

void run_clock::schedule_message(time_point t, caf::group target, caf::strong_actor_ptr sender,
                                 caf::message content) {
  ask(add_timeout{to_instant(t),
                  group_message{std::move(target), std::move(sender), std::move(content)}});
}

void run_clock::cancel_all() {
  ask(cancel_everything{});
}

run_clock& run_clock_of(caf::actor_system& system) {
  return dynamic_cast<run_clock&>(system.clock());
}

} // namespace rubicon::scheduler
