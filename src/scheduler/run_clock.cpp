#include "scheduler/run_clock.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <caf/actor_system.hpp>
#include <caf/error.hpp>
#include <caf/sec.hpp>
#include <caf/system_messages.hpp>

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

/// Hands a timeout that has fired to whom it is for.
struct shipper {
  caf::execution_unit& unit;

  void operator()(actor_message& x) const {
    const acting_on sent(x.from);
    x.receiver->enqueue(std::move(x.content), &unit);
  }

  void operator()(actor_timeout& x) const {
    if (x.key.kind == timeout_kind::request)
      x.self->get()->eq_impl(x.mid, x.self, &unit, caf::make_error(caf::sec::request_timeout));
    else
      x.self->get()->eq_impl(caf::make_message_id(), x.self, &unit,
                             caf::timeout_msg{static_cast<caf::atom_value>(x.key.what), x.id});
  }

  void operator()(group_message& x) const {
    x.target.get()->enqueue(std::move(x.sender), caf::make_message_id(), std::move(x.content),
                            &unit);
  }
};

} // namespace

run_clock::run_clock(outside& others, time_mode mode, double speed)
    : others_(others), mode_(mode), speed_(mode == time_mode::wall && speed == 0 ? 1 : speed) {
  assert(speed >= 0);
}

// -- run control

void run_clock::begin(instant end) {
  horizon_ns_.store(end.time_since_epoch().count(), std::memory_order_relaxed);
  if (mode_ == time_mode::virtual_time) {
    anchor_ecology_ns_ = latest_ns_.load(std::memory_order_relaxed);
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
  return x.time_since_epoch().count() <= latest_ns_.load(std::memory_order_relaxed) ||
         steady::now() >= real_time_of(x);
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

void run_clock::advance(instant x) {
  const auto ns = x.time_since_epoch().count();
  if (ns > latest_ns_.load(std::memory_order_relaxed))
    latest_ns_.store(ns, std::memory_order_relaxed);
}

void run_clock::fire_next(caf::execution_unit& unit) {
  const auto due = *timers_.next();
  advance(due);
  do {
    const auto which = timers_.front();
    auto what = timers_.pop();
    if (const auto* x = std::get_if<actor_timeout>(&what))
      forget_key(x->key, which);
    ++fired_;
    std::visit(shipper{unit}, what);
  } while (timers_.next() == due);
}

void run_clock::close() {
  closed_ = true;
  keys_.clear();
  timers_.clear();
}

// -- messages that may be moved

movable_message run_clock::schedule(instant due, caf::strong_actor_ptr receiver,
                                    caf::mailbox_element_ptr content) {
  assert(others_.at_home());
  if (closed_)
    return {};
  const auto number = ++movable_messages_;
  return {timers_.add(not_past(due), actor_message{std::move(receiver), std::move(content), number,
                                                   provenance::none()}),
          number};
}

bool run_clock::move(const movable_message& x, instant due) {
  if (!pending(x))
    return false;
  timers_.move(x.slot, not_past(due));
  return true;
}

void run_clock::cancel(const movable_message& x) {
  if (pending(x))
    timers_.cancel(x.slot);
}

bool run_clock::pending(const movable_message& x) const {
  assert(others_.at_home());
  if (x.number == 0 || !timers_.pending(x.slot))
    return false;
  const auto* message = std::get_if<actor_message>(&timers_[x.slot]);
  return message != nullptr && message->number == x.number;
}

// -- the table of timeouts

instant run_clock::not_past(instant due) const {
  return std::max(due, instant(duration(latest_ns_.load(std::memory_order_relaxed))));
}

void run_clock::add(instant due, timeout what) {
  if (closed_)
    return;
  const auto* x = std::get_if<actor_timeout>(&what);
  if (x == nullptr) {
    timers_.add(not_past(due), std::move(what));
    return;
  }
  const auto key = x->key;
  if (key.kind == timeout_kind::ordinary)
    apply(cancel_timeout{key});
  keys_.emplace(key, timers_.add(not_past(due), std::move(what)));
}

void run_clock::forget_key(const timeout_key& key, ticket which) {
  auto [i, end] = keys_.equal_range(key);
  i = std::find_if(i, end, [=](const auto& x) { return x.second == which; });
  assert(i != end);
  keys_.erase(i);
}

void run_clock::apply(add_timeout x) {
  add(x.due, std::move(x.what));
}

// What is cancelled may hold the last reference to an actor, whose end cancels its timeouts: keys
// go first, and no iterator lives across a cancellation.
void run_clock::apply(const cancel_timeout& x) {
  if (const auto i = keys_.find(x.key); i != keys_.end()) {
    const auto which = i->second;
    keys_.erase(i);
    timers_.cancel(which);
  }
}

void run_clock::apply(const cancel_actor& x) {
  for (;;) {
    const auto i = keys_.lower_bound(timeout_key{x.actor});
    if (i == keys_.end() || i->first.actor != x.actor)
      return;
    const auto which = i->second;
    keys_.erase(i);
    timers_.cancel(which);
  }
}

void run_clock::apply(const cancel_everything&) {
  keys_.clear();
  timers_.clear();
}

template <class Order>
void run_clock::ask(Order x) {
  if (others_.at_home())
    apply(std::move(x));
  else
    others_.post(std::move(x));
}

// -- caf::actor_clock

run_clock::time_point run_clock::now() const noexcept {
  const auto latest = latest_ns_.load(std::memory_order_relaxed);
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
