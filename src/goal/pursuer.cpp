#include "goal/pursuer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text/decimal.hpp"

namespace rubicon::goal {

namespace {

constexpr std::string_view no_goal = "none"; ///< also: nothing to say yet
constexpr std::string_view idle_state = "idle";
constexpr std::string_view waiting_state = "waiting";

/// Longest unknown goal that an outcome repeats; anybody may write anything.
constexpr std::size_t shown_goal_max = 64;

/// With at most six decimals, so that steps of 0.1 do not show what they are in binary.
std::string number_text(double x) {
  constexpr double millionths = 1e6;
  return shortest_decimal(std::round(x * millionths) / millionths);
}

std::string shown(std::string_view goal) {
  const bool plain = goal.size() <= shown_goal_max &&
                     std::ranges::all_of(goal, [](char c) { return c >= ' ' && c <= '~'; });
  return plain ? std::string(goal) : "?";
}

bool same_source(const source& a, const source& b) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return a.owner == b.owner && std::ranges::equal(a.key, b.key, {}, lower, lower);
}

/// The next value of an output that changes by steps.
std::string stepped(const output_config& x, const std::string& text) {
  const auto value = number_in(text);
  if (x.step == 0 || !value)
    return text;
  auto next = *value + x.step;
  if (x.until)
    next = x.step > 0 ? std::min(next, std::max(*x.until, *value))
                      : std::max(next, std::min(*x.until, *value));
  return number_text(next);
}

} // namespace

std::string_view to_string(goal_outcome x) {
  switch (x) {
  case goal_outcome::succeeded:
    return "succeeded";
  case goal_outcome::failed:
    return "failed";
  case goal_outcome::preempted:
    return "preempted";
  }
  return "unknown";
}

std::string_view to_string(goal_cause x) {
  switch (x) {
  case goal_cause::none:
    return "none";
  case goal_cause::unknown:
    return "unknown";
  case goal_cause::timeout:
    return "timeout";
  case goal_cause::broken:
    return "broken";
  case goal_cause::newer:
    return "newer";
  case goal_cause::cancelled:
    return "cancelled";
  }
  return "unknown";
}

pursuer::pursuer(pursuer_config config, random_stream rng)
    : config_(std::move(config)), rng_(std::move(rng)), inputs_(config_.inputs.size()) {
  for (const auto& x : config_.outputs)
    outputs_.push_back({x.value, {}});
}

outputs pursuer::start(instant now) {
  outputs out;
  for (auto& x : outputs_)
    x.due = now;
  publish_outputs(now, out);
  for (const auto& x : config_.inputs) {
    say(x.name, std::string(no_goal), out);
    out.emplace_back(declare{key_of("mi-" + x.name), x.reference, key_of(x.name)});
  }
  say_state(idle_state, out);
  say("outcome.cause", std::string(to_string(goal_cause::none)), out);
  say("outcome", std::string(no_goal), out);
  say("goal", std::string(no_goal), out);
  return out;
}

outputs pursuer::on_goal(std::string_view text, instant now) {
  outputs out;
  if (text.empty() || text == no_goal) {
    if (goal_) {
      rest(out);
      end(goal_outcome::preempted, goal_cause::cancelled, out);
    }
    return out;
  }
  ++counters_.goals;
  const auto found = std::ranges::find(config_.goals, text, &goal_config::text);
  if (found == config_.goals.end()) {
    ++counters_.unknown;
    publish_end(shown(text), goal_outcome::failed, goal_cause::unknown, out);
    return out;
  }
  if (goal_)
    end(goal_outcome::preempted, goal_cause::newer, out);
  begin(static_cast<std::size_t>(found - config_.goals.begin()), now, out);
  return out;
}

outputs pursuer::on_input(std::size_t input, source from, std::string_view text, instant now) {
  outputs out;
  inputs_[input] = input_value{std::move(from), std::string(text)};
  if (phase_ == phase::waiting && now < timeout_)
    enter_state(now, out);
  return out;
}

void pursuer::on_input_gone(std::size_t input, const source& from) {
  auto& x = inputs_[input];
  if (x && same_source(x->from, from))
    x.reset();
}

void pursuer::on_reference(std::size_t input, const std::optional<source>& to) {
  auto& x = inputs_[input];
  if (x && !(to && same_source(x->from, *to)))
    x.reset();
}

outputs pursuer::on_time(instant now) {
  outputs out;
  while (goal_ && std::min(due_.value_or(timeout_), timeout_) <= now) {
    if (due_ && *due_ <= timeout_) {
      leave_state(now, out);
      continue;
    }
    ++counters_.timed_out;
    rest(out);
    end(goal_outcome::failed, goal_cause::timeout, out);
  }
  publish_outputs(now, out);
  return out;
}

std::optional<instant> pursuer::deadline() const {
  auto next = goal_ ? std::optional(std::min(due_.value_or(timeout_), timeout_)) : std::nullopt;
  for (const auto& x : outputs_)
    next = earliest(next, x.due);
  return next;
}

bool pursuer::holds(const condition& x) const {
  const auto at = std::ranges::find(config_.inputs, x.input, &input_config::name);
  const auto& now = inputs_[static_cast<std::size_t>(at - config_.inputs.begin())];
  if (!now)
    return false;
  if (!x.equals.empty())
    return std::ranges::find(x.equals, now->text) != x.equals.end();
  const auto value = number_in(now->text);
  return value && (!x.above || *value >= *x.above) && (!x.below || *value < *x.below);
}

void pursuer::say(std::string_view name, std::string text, outputs& out) const {
  out.emplace_back(publish{key_of(name), std::move(text)});
}

void pursuer::say_state(std::string_view name, outputs& out) {
  if (published_state_ == name)
    return;
  published_state_ = name;
  say("state", published_state_, out);
}

void pursuer::begin(std::size_t goal, instant now, outputs& out) {
  goal_ = goal;
  state_ = 0;
  timeout_ = now + pursued().timeout;
  out.emplace_back(begun{pursued().text});
  enter_state(now, out);
}

void pursuer::enter_state(instant now, outputs& out) {
  const auto& x = pursued().states[state_];
  due_.reset();
  if (x.needs && !holds(*x.needs)) {
    phase_ = phase::waiting;
    say_state(waiting_state, out);
    return;
  }
  phase_ = phase::busy;
  due_ = now + x.length + (x.jitter > 0s ? rng_.between(0s, x.jitter) : 0s);
  say_state(x.name, out);
}

void pursuer::leave_state(instant now, outputs& out) {
  const auto& x = pursued().states[state_];
  if (x.failure_rate > 0 && rng_.chance(x.failure_rate)) {
    rest(out);
    end(goal_outcome::failed, goal_cause::broken, out);
    return;
  }
  set_outputs(x, out);
  if (++state_ < pursued().states.size()) {
    enter_state(now, out);
    return;
  }
  rest(out);
  end(goal_outcome::succeeded, goal_cause::none, out);
}

void pursuer::set_outputs(const state_config& x, outputs& out) {
  for (const auto& [name, value] : x.sets) {
    const auto at = std::ranges::find(config_.outputs, name, &output_config::name);
    outputs_[static_cast<std::size_t>(at - config_.outputs.begin())].text = value;
    say(name, value, out);
  }
}

void pursuer::publish_outputs(instant now, outputs& out) {
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const auto& how = config_.outputs[i];
    auto& x = outputs_[i];
    for (bool is_published = false; x.due <= now; x.due += how.every) {
      if (!std::exchange(is_published, true)) { // periods that were missed are not made up for
        say(how.name, x.text, out);
        x.text = stepped(how, x.text);
      }
    }
  }
}

/// Does nothing, and says so. Comes before end().
void pursuer::rest(outputs& out) {
  phase_ = phase::idle;
  due_.reset();
  say_state(idle_state, out);
}

void pursuer::end(goal_outcome outcome, goal_cause cause, outputs& out) {
  auto goal = pursued().text;
  goal_.reset();
  publish_end(std::move(goal), outcome, cause, out);
}

void pursuer::publish_end(std::string goal, goal_outcome outcome, goal_cause cause, outputs& out) {
  switch (outcome) {
  case goal_outcome::succeeded:
    ++counters_.succeeded;
    break;
  case goal_outcome::failed:
    ++counters_.failed;
    break;
  case goal_outcome::preempted:
    ++counters_.preempted;
    break;
  }
  say("outcome.cause", std::string(to_string(cause)), out);
  say("outcome", goal + ' ' + std::string(to_string(outcome)), out);
  out.emplace_back(ended{std::move(goal), outcome, cause});
}

} // namespace rubicon::goal
