#include "synaptic/channels.hpp"

#include <algorithm>
#include <cassert>

namespace rubicon::synaptic {

std::string_view to_string(failure x) {
  switch (x) {
  case failure::bad_descriptor:
    return "bad_descriptor";
  case failure::illegal_operation:
    return "illegal_operation";
  case failure::no_room:
    return "no_room";
  case failure::already_open:
    return "already_open";
  case failure::bad_argument:
    return "bad_argument";
  case failure::not_open_yet:
    return "not_open_yet";
  case failure::not_active:
    return "not_active";
  case failure::ended:
    return "ended";
  }
  return "unknown";
}

answer channels::start(descriptor channel) {
  auto* x = find(channel);
  if (const auto why = refusal(x, true))
    return {.refused = why};
  x->is_active = true;
  x->stops_left = 0;
  return {.channel = channel};
}

answer channels::stop(descriptor channel) {
  auto* x = find(channel);
  if (const auto why = refusal(x, true))
    return {.refused = why};
  if (!x->is_active)
    return {.refused = failure::not_active};
  answer done{.channel = channel};
  x->is_active = false;
  x->sends = false;
  if (x->last_tick && x->channel) {
    x->stops_left = config_.stop_repeats;
    send_stop(*x, done.todo);
  }
  return done;
}

answer channels::dispose(descriptor channel) {
  auto* x = find(channel);
  if (x == nullptr)
    return {.refused = failure::bad_descriptor};
  auto done = x->is_active ? stop(channel) : answer{.channel = channel};
  drop(channel, done.todo);
  return done;
}

std::optional<failure> channels::write_output(descriptor channel, std::size_t k, float value) {
  auto* x = find(channel);
  if (const auto why = refusal(x, true))
    return why;
  if (k >= x->values.size())
    return failure::bad_argument;
  x->values[k] = value;
  return std::nullopt;
}

std::optional<float> channels::read_input(descriptor channel, std::size_t index) {
  auto* x = find(channel);
  if (refusal(x, false) || index >= x->shape.size) {
    ++counters_.bad_reads;
    return std::nullopt;
  }
  return x->input.shown()[index];
}

/// Vectors of the last tick that on_time() was not called for leave first.
outputs channels::on_tick(std::uint32_t tick, instant now) {
  outputs todo;
  if (sends_at_)
    send_all(todo);
  const bool leaps = tick_ && tick != static_cast<std::uint32_t>(*tick_ + 1);
  if (leaps)
    ++counters_.leaps;
  bool any_sends = false;
  for (auto& x : rows_) {
    if (x.at != phase::open)
      continue;
    if (x.is_out)
      x.sends = x.is_active && tick % x.shape.divisor == 0;
    else if (leaps)
      x.input.on_leap(tick);
    else
      report(x, tick, todo);
    any_sends = any_sends || x.sends || x.stops_left > 0;
  }
  tick_ = tick;
  if (any_sends)
    sends_at_ = now + slot_;
  return todo;
}

void channels::report(row& x, std::uint32_t tick, outputs& todo) {
  switch (x.input.on_tick(tick)) {
  case arrivals::report::none:
    return;
  case arrivals::report::updated:
    ++counters_.updated;
    notify(x, input_status::updated, todo);
    return;
  case arrivals::report::missed:
    ++counters_.missed;
    notify(x, input_status::missed, todo);
    if (x.input.silence() >= config_.silence_max)
      end(x, todo);
    return;
  }
}

void channels::notify(const row& x, input_status status, outputs& todo) {
  for (std::uint8_t i = 0; i < x.shape.size; ++i)
    todo.emplace_back(input_update{x.id, i, status});
}

void channels::send_all(outputs& todo) {
  sends_at_.reset();
  for (auto& x : rows_) {
    if (x.sends)
      send_vector(x, todo);
    else if (x.stops_left > 0)
      send_stop(x, todo, true);
  }
}

void channels::send_vector(row& x, outputs& todo) {
  assert(tick_);
  ++counters_.sent;
  x.sends = false;
  x.last_tick = tick_;
  if (x.channel) {
    for (auto& packet : encode_vector(*tick_, x.values, config_.packet_max))
      todo.emplace_back(send_on_channel{*x.channel, std::move(packet), true});
  } else if (auto* reader = find(false, x.other)) {
    ++counters_.updated;
    reader->input.show(x.values);
    notify(*reader, input_status::updated, todo);
  }
}

/// @pre it has sent a vector, over a channel
void channels::send_stop(row& x, outputs& todo, bool in_slot) {
  --x.stops_left;
  todo.emplace_back(send_on_channel{*x.channel, encode(stop_message{*x.last_tick}), in_slot});
}

std::vector<channels::out_end> channels::out_ends() const {
  std::vector<out_end> found;
  for (const auto& x : rows_)
    if (x.is_out && !x.loops && (x.is_active || is_opening(x)))
      found.push_back({x.channel, x.shape.size});
  return found;
}

outputs channels::on_time(instant now) {
  outputs todo;
  if (sends_at_ && *sends_at_ <= now)
    send_all(todo);
  for (std::size_t i = 0; i < rows_.size();) {
    auto& x = rows_[i];
    const bool is_due = x.due && *x.due <= now;
    if (is_due && (x.at != phase::asking || x.gives_up <= now)) {
      drop(x.id, todo);
      continue;
    }
    if (is_due)
      ask(x, todo, now);
    ++i;
  }
  std::erase_if(early_, [&](const early& x) {
    if (x.due > now)
      return false;
    ++counters_.expired;
    todo.emplace_back(disconnect{x.channel});
    return true;
  });
  return todo;
}

std::optional<instant> channels::deadline() const {
  auto next = sends_at_;
  for (const auto& x : rows_)
    next = earliest(next, x.due);
  for (const auto& x : early_)
    next = earliest(next, x.due);
  return next;
}

std::size_t channels::footprint() const {
  constexpr std::size_t row_size = 24;
  constexpr std::size_t input_size = 17; // three ticks, silence and flags
  constexpr std::size_t vector_size = 4; // the tick it is of
  constexpr std::size_t early_size = 11;
  constexpr std::size_t node_size = 14;
  const std::size_t values_size = config_.size_max * value_size;
  const std::size_t has_size = (config_.size_max + 7U) / 8U;
  const auto out = row_size + values_size;
  const auto in = row_size + input_size + 3 * (vector_size + values_size) + 2 * has_size;
  return config_.channels_max * (out + in) + config_.early_max * early_size + node_size;
}

channels::row* channels::find(descriptor channel) {
  const auto found =
      std::find_if(rows_.begin(), rows_.end(), [&](const row& x) { return x.id == channel; });
  return found == rows_.end() ? nullptr : &*found;
}

channels::row* channels::find(channel_handle handle) {
  const auto found =
      std::find_if(rows_.begin(), rows_.end(), [&](const row& x) { return x.channel == handle; });
  return found == rows_.end() ? nullptr : &*found;
}

channels::row* channels::find(bool is_out, mote_address other) {
  const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const row& x) {
    return x.is_out == is_out && x.other == other && x.at != phase::ended;
  });
  return found == rows_.end() ? nullptr : &*found;
}

/// Why an open out or in end is not what `x` is.
std::optional<failure> channels::refusal(const row* x, bool wants_out) const {
  if (x == nullptr)
    return failure::bad_descriptor;
  if (x->is_out != wants_out)
    return failure::illegal_operation;
  if (x->at == phase::ended)
    return failure::ended;
  if (x->at != phase::open)
    return failure::not_open_yet;
  return std::nullopt;
}

} // namespace rubicon::synaptic
