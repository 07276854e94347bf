#include "peis/links/link_input.hpp"

#include <algorithm>
#include <cstdint>

#include "peis/wire/package.hpp"

namespace rubicon::peis {

namespace {

/// Work that a link may be behind its turns; what it owes beyond is left to its budget.
constexpr std::int64_t deficit_max = 16;

/// Share of packages missed, as real kernels average it, here over packages instead of time.
void note_counter(connection_input& x, std::uint32_t counter) {
  constexpr double smoothing = 0.01;
  const auto expected = x.counter ? *x.counter + 1 : counter;
  const auto missed = std::min<std::uint32_t>(counter - expected, 100);
  if (counter - expected < 0x80000000U) {
    for (std::uint32_t i = 0; i < missed; ++i)
      x.loss += smoothing * (1 - x.loss);
    x.loss -= smoothing * x.loss;
    x.counter = counter;
  }
}

} // namespace

void link_input::on_octets(connection& x, byte_view octets, instant now) {
  own_.counters.octets_received += octets.size();
  x.in.octets += octets.size();
  x.in.last_octets = now;
  x.in.decoder.feed(octets);
  fed_ = x.id;
  latest_ = now;
  if (std::exchange(x.in.waits, true))
    return;
  ready_.push_back(x.id);
}

std::optional<link_id> link_input::next(instant now) {
  while (!resting_.empty() && resting_.begin()->first <= now) {
    ready_.push_back(resting_.begin()->second);
    resting_.erase(resting_.begin());
  }
  const auto quantum = static_cast<std::int64_t>(own_.config.turn_quantum);
  while (turn_work_ < own_.config.turn_work && !ready_.empty()) {
    const auto link = ready_.front();
    ready_.pop_front();
    auto* x = links_.find(link);
    if (x == nullptr)
      continue;
    x->in.credit = std::min(x->in.credit + quantum, quantum);
    if (x->in.credit > 0)
      return link;
    ready_.push_back(link);
    turn_work_ += 1;
  }
  return std::nullopt;
}

void link_input::note_package(connection& x, const received_package& package, instant now) {
  x.in.last_package = now;
  note_counter(x.in, package.header.counter);
  x.in.budget.charge_package(header_size + package.data.size(), now);
}

void link_input::finish(connection& x, bool more, instant now, events& out) {
  x.in.waits = more;
  if (!more) {
    x.in.credit = std::min<std::int64_t>(x.in.credit, 0);
    if (std::exchange(x.in.held, false))
      out.push_back(read_link{x.id, true});
  } else if (x.in.budget.is_within(now)) {
    ready_.push_back(x.id);
  } else {
    ++own_.counters.rests;
    resting_.emplace(x.in.budget.free_at(), x.id);
  }
}

void link_input::spend(link_id link, work_units work) {
  turn_work_ += work;
  auto* x = links_.find(link);
  if (x == nullptr)
    return;
  const auto least = -deficit_max * static_cast<std::int64_t>(own_.config.turn_quantum);
  const auto cost = static_cast<std::int64_t>(std::min<work_units>(work, 1U << 30));
  x->in.credit = std::max(x->in.credit - cost, least);
}

void link_input::charge(link_id link, work_units work, instant now) {
  if (work == 0)
    return;
  own_.counters.work += work;
  spend(link, work);
  if (auto* x = links_.find(link))
    x->in.budget.charge_work(work, now);
}

std::optional<link_id> link_input::end_turn(instant now, events& out) {
  turn_work_ = 0;
  latest_ = now;
  auto* x = fed_ ? links_.find(*fed_) : nullptr;
  fed_.reset();
  if (x == nullptr || !x->in.waits)
    return std::nullopt;
  x->in.decoder.keep_rest();
  if (x->in.decoder.kept() > own_.config.input_max)
    return x->id;
  if (!std::exchange(x->in.held, true)) {
    ++own_.counters.held;
    out.push_back(read_link{x->id, false});
  }
  return std::nullopt;
}

void link_input::on_link_closed(const connection& gone) {
  if (gone.in.waits)
    std::erase_if(resting_, [&gone](const auto& x) { return x.second == gone.id; });
}

std::optional<instant> link_input::deadline() const {
  if (!ready_.empty())
    return latest_;
  return resting_.empty() ? std::nullopt : std::optional(resting_.begin()->first);
}

} // namespace rubicon::peis
