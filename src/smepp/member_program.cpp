#include "smepp/member_program.hpp"

#include <algorithm>

#include "core/codec.hpp"

namespace rubicon::smepp {

namespace {

constexpr duration pause_min = 5s; ///< between two looks for the group,
constexpr duration pause_max = 60s;

/// Groups that can be entered without a key are looked for, and joined, without one.
std::optional<key> credential(const group_description& x) {
  return x.is_closed || x.is_private ? x.master : std::nullopt;
}

} // namespace

member_program::member_program(member_config config, group_description description, instant begin,
                               random_stream rng)
    : config_(std::move(config)), description_(std::move(description)), rng_(rng), begin_(begin),
      pause_(pause_min), planned_(config_.subscribes.size()) {}

void member_program::start(environment at) {
  if (config_.leaves) {
    leave_at_ = begin_ + *config_.leaves;
    has_left_ = *leave_at_ <= at.now; // in a life before
  }
  for (const auto& [id, g] : at.own.groups().all())
    if (g.description.name == description_.name)
      return enter(id, "is back in", at);
  if (has_left_)
    return;
  if (!config_.creates) {
    look_at_ = at.now + rng_.between(0s, pause_min);
    return;
  }
  const auto made = at.own.smepp_createGroup(description_, at.now, at.out);
  if (const auto* const id = std::get_if<group_id>(&made))
    return enter(*id, "has created", at);
  ++counters_.joins_failed;
  at.host.notify("cannot create group " + config_.group + ": " +
                 std::string(to_string(std::get<failure>(made))));
}

// ---- to join

void member_program::look(environment& at) {
  look_at_.reset();
  at.own.smepp_getGroups({.name = description_.name, .master = credential(description_)}, at.now,
                         at.out);
}

/// Not all at once, nor forever as often.
void member_program::look_again(environment& at) {
  ++counters_.joins_failed;
  look_at_ = at.now + rng_.between(pause_ / 2, pause_);
  pause_ = std::min(2 * pause_, pause_max);
}

void member_program::on(const getGroups_result& x, environment& at) {
  if (group_ || joining_ != group_id{} || look_at_ || has_left_)
    return;
  found_ = x.groups;
  try_next(at);
}

/// Whoever can make groups can make one of this name: it has to be as the file says.
bool member_program::is_wanted(const group_description& x) const {
  return x.name == description_.name && x.is_closed == description_.is_closed &&
         x.is_private == description_.is_private &&
         x.management.period == description_.management.period;
}

void member_program::try_next(environment& at) {
  while (!found_.empty()) {
    const auto id = found_.front();
    found_.erase(found_.begin());
    if (const auto found = at.own.smepp_getGroupDescription(id); found && is_wanted(*found)) {
      joining_ = id;
      at.own.smepp_joinGroup(id, credential(description_), at.now, at.out);
      return;
    }
  }
  look_again(at);
}

void member_program::on(const joinGroup_result& x, environment& at) {
  if (x.group != joining_)
    return;
  joining_ = {};
  if (!x.error)
    return enter(x.group, "has joined", at);
  if (counters_.joins_failed == 0)
    at.host.notify("is not let into group " + config_.group + ": " +
                   std::string(to_string(*x.error)));
  try_next(at);
}

void member_program::enter(group_id group, const char* how, environment& at) {
  group_ = group;
  pause_ = pause_min;
  ++counters_.joins;
  at.host.notify(how + (" group " + config_.group));
  for (std::size_t i = 0; i < planned_.size(); ++i)
    planned_[i] = {std::max(at.now, begin_ + config_.subscribes[i].from), false};
  const auto* const g = at.own.groups().find(group);
  for (const auto& x : at.own.events().all())
    if (x.group == group)
      sample(event_management::info(x, *g), at);
}

void member_program::leave_behind(environment& at) {
  at.host.notify("has left group " + config_.group);
  group_.reset();
  tasks_.clear();
  std::ranges::fill(planned_, planned_subscription{});
}

void member_program::on(const peerJoined& /*x*/, environment& /*at*/) {}

void member_program::on(const peerLeft& x, environment& at) {
  if (group_ != x.group || at.own.groups().find(x.group) != nullptr)
    return;
  leave_behind(at);
  if (!has_left_) // it was put out
    look_at_ = at.now + rng_.between(0s, pause_min);
}

// ---- subscriptions

void member_program::subscribe(std::size_t number, environment& at) {
  constexpr duration again = 2s;
  auto& own = planned_[number];
  const auto& x = config_.subscribes[number];
  const auto until = x.until ? std::optional(begin_ + *x.until) : std::nullopt;
  own.due = until;
  if (until && *until <= at.now)
    return own.due.reset();
  if (const auto error =
          at.own.smepp_subscribe(x.event, *group_, x.expires, x.rate, at.now, at.out)) {
    if (counters_.refused++ == 0)
      at.host.notify("cannot subscribe to " + x.event + ": " + std::string(to_string(*error)));
    own.due = at.now + again;
    return;
  }
  own.is_subscribed = true;
  ++counters_.subscribed;
  static_cast<void>(at.own.smepp_receive(*group_, x.event, x.frequency, at.now, at.out));
  for (const auto& each : at.own.events().all()) // its own events are for it, too
    if (each.group == *group_ && each.depth == 0 && each.name == x.event)
      sample(event_management::info(each, *at.own.groups().find(*group_)), at);
}

void member_program::withdraw(std::size_t number, environment& at) {
  auto& own = planned_[number];
  own = {};
  const auto& event = config_.subscribes[number].event;
  static_cast<void>(at.own.smepp_unsubscribe(event, *group_, at.now, at.out));
  std::erase_if(tasks_,
                [&](const task& x) { return at.own.events().find(*group_, x.id) == nullptr; });
}

void member_program::on(const receive_result& x, environment& at) {
  if (group_ != x.group)
    return;
  const auto wanted = std::ranges::find(config_.subscribes, x.name, &wanted_event::event);
  if (wanted == config_.subscribes.end())
    return;
  ++counters_.received;
  if (!wanted->channel)
    return;
  ++counters_.forwarded;
  at.host.forward(*wanted->channel, x.value);
}

// ---- events

void member_program::on(const subscribed& x, environment& at) {
  if (group_ == x.group)
    sample(x.what, at);
}

void member_program::on(const unsubscribed& x, environment& /*at*/) {
  if (group_ == x.group)
    std::erase_if(tasks_, [&](const task& each) { return each.id == x.id; });
}

void member_program::sample(const subscription_info& x, environment& at) {
  const auto what = std::ranges::find(config_.raises, x.name, &raised_event::event);
  if (what == config_.raises.end())
    return;
  std::erase_if(tasks_, [&](const task& each) { return each.id == x.id; });
  task added{x.id, &*what, at.now};
  if (x.interval > duration{})
    added.due = next_sample(added, at).value_or(at.now);
  else
    added.due = at.now + rng_.between(0s, what->every);
  tasks_.push_back(added);
}

/// The next moment at which all producers sample (SMP-16), by the group's time as it is known now.
std::optional<instant> member_program::next_sample(const task& x, const environment& at) const {
  const auto* const g = at.own.groups().find(*group_);
  const auto* const known = at.own.events().find(*group_, x.id);
  if (g == nullptr || known == nullptr)
    return std::nullopt;
  if (known->interval <= duration{})
    return at.now + x.what->every;
  // A corrected clock may show the moment that has passed once more: half an interval is another.
  const auto offset = event_management::info(*known, *g).offset;
  const auto from = std::max(at.now, x.due + known->interval / 2);
  if (from <= offset)
    return offset;
  return offset + ((from - offset) / known->interval + 1) * known->interval;
}

void member_program::raise(task& x, environment& at) {
  byte_writer value;
  if (!x.what->transducer) {
    value.big(++number_);
  } else if (const auto count = at.host.read(*x.what->transducer)) {
    value.big(*count);
  } else {
    ++counters_.refused;
    return;
  }
  if (at.own.smepp_event(*group_, x.what->event, value.finish(), at.now, at.out))
    ++counters_.refused;
  else
    ++counters_.raised;
}

// ---- time

void member_program::on_signal(const signal& x, environment at) {
  std::visit([&](const auto& each) { on(each, at); }, x);
}

void member_program::on_time(environment at) {
  if (look_at_ && *look_at_ <= at.now)
    look(at);
  if (leave_at_ && *leave_at_ <= at.now) {
    leave_at_.reset();
    has_left_ = true;
    look_at_.reset();
    if (group_ && at.own.smepp_leaveGroup(*group_, at.now, at.out))
      ++counters_.refused;
  }
  if (!group_)
    return;
  for (std::size_t i = 0; i < planned_.size(); ++i) {
    if (!planned_[i].due || *planned_[i].due > at.now)
      continue;
    if (planned_[i].is_subscribed)
      withdraw(i, at);
    else
      subscribe(i, at);
  }
  // Two subscriptions to one event at one moment are served by one event.
  std::vector<const raised_event*> raised;
  for (auto& x : tasks_) {
    if (x.due > at.now)
      continue;
    if (std::ranges::find(raised, x.what) == raised.end()) {
      raised.push_back(x.what);
      raise(x, at);
    }
    x.due = next_sample(x, at).value_or(at.now + x.what->every);
  }
}

std::optional<instant> member_program::deadline() const {
  auto first = earliest(look_at_, leave_at_);
  if (!group_)
    return first;
  for (const auto& x : planned_)
    first = earliest(first, x.due);
  for (const auto& x : tasks_)
    first = earliest(first, x.due);
  return first;
}

} // namespace rubicon::smepp
