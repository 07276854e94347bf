#include "synaptic/arrivals.hpp"

#include <algorithm>

namespace rubicon::synaptic {

namespace {

/// Ticks wrap around.
bool is_after(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::int32_t>(a - b) > 0;
}

} // namespace

arrivals::verdict arrivals::put(const vector_message& x, std::optional<std::uint32_t> tick) {
  has_arrivals_ = true;
  if (!tick || x.tick % divisor_ != 0)
    return verdict::untimely;
  const auto next = *tick + (divisor_ - *tick % divisor_) % divisor_;
  if (is_after(x.tick, next + divisor_))
    return verdict::untimely;
  if (shown_tick_ && !is_after(x.tick, *shown_tick_))
    return x.tick == *shown_tick_ ? verdict::repeated : verdict::late;
  note_run(x.tick);
  auto* to = place_for(x.tick);
  if (to == nullptr)
    return verdict::late;
  const auto missing = to->missing;
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const auto at = x.first + i;
    if (to->has[at])
      continue;
    to->has[at] = true;
    to->values[at] = x.values[i];
    --to->missing;
  }
  if (to->missing == missing)
    return verdict::repeated;
  return is_after(*tick, x.tick) ? verdict::late : verdict::taken;
}

/// A vector of a tick after the last one begins a run of reports.
void arrivals::note_run(std::uint32_t tick) {
  if (!newest_ || is_after(tick, *newest_))
    newest_ = tick;
  if (last_ && is_after(tick, *last_)) {
    first_ = tick;
    last_.reset();
  } else if (!first_) {
    first_ = tick;
  }
}

/// @returns where the vector of that tick is put together; nothing if both places have newer ones
arrivals::vector* arrivals::place_for(std::uint32_t tick) {
  auto* oldest = &coming_[0];
  for (auto& x : coming_) {
    if (x.tick == tick)
      return &x;
    if (oldest->tick && (!x.tick || is_after(*oldest->tick, *x.tick)))
      oldest = &x;
  }
  if (oldest->tick && is_after(*oldest->tick, tick))
    return nullptr;
  *oldest = {tick, std::vector<bool>(shown_.size()), std::vector<float>(shown_.size()),
             shown_.size()};
  return oldest;
}

void arrivals::stop(std::uint32_t last, std::optional<std::uint32_t> tick) {
  has_arrivals_ = true;
  if (newest_ && is_after(*newest_, last))
    return;
  const bool is_ours = tick && !is_after(last, *tick + divisor_);
  last_ = is_ours ? last : tick.value_or(0) - 1; // another clock's: from now on
}

bool arrivals::is_in_run(std::uint32_t tick) const {
  return first_ && !is_after(*first_, tick) && !(last_ && is_after(tick, *last_));
}

arrivals::report arrivals::on_tick(std::uint32_t tick) {
  const auto due = tick - 1;
  if (due % divisor_ != 0 || !is_in_run(due))
    return report::none;
  vector* newest = nullptr;
  for (auto& x : coming_) {
    const bool is_ready = x.tick && x.missing == 0 && !is_after(*x.tick, due);
    if (is_ready && (newest == nullptr || is_after(*x.tick, *newest->tick)))
      newest = &x;
  }
  silence_ = has_arrivals_ ? 0 : silence_ + 1;
  has_arrivals_ = false;
  if (newest == nullptr)
    return report::missed;
  shown_tick_ = newest->tick;
  shown_ = std::move(newest->values);
  for (auto& x : coming_) {
    if (x.tick && !is_after(*x.tick, *shown_tick_))
      x = {};
  }
  return *shown_tick_ == due ? report::updated : report::missed;
}

void arrivals::on_leap(std::uint32_t tick) {
  coming_ = {};
  shown_tick_.reset();
  newest_.reset();
  if (first_ && !last_)
    first_ = tick;
  else
    first_.reset();
  last_.reset();
}

} // namespace rubicon::synaptic
