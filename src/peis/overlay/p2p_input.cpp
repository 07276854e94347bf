// Whose octets are handled next, and how many at a time: no neighbour keeps the others waiting.
#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

/// Work that a link may be behind its turns; what it owes beyond is left to its budget.
constexpr std::int64_t deficit_max = 16;

} // namespace

void p2p::on_link_octets(link_id link, byte_view octets, instant now) {
  const auto at = connections_.find(link);
  if (at == connections_.end())
    return;
  auto& x = at->second;
  counters_.octets_received += octets.size();
  x.octets_in += octets.size();
  x.last_octets = now;
  x.decoder.feed(octets);
  fed_ = link;
  latest_ = now;
  if (std::exchange(x.waits, true))
    return;
  ready_.push_back(link);
}

bool p2p::serve_next(instant now) {
  while (!resting_.empty() && resting_.begin()->first <= now) {
    ready_.push_back(resting_.begin()->second);
    resting_.erase(resting_.begin());
  }
  const auto quantum = static_cast<std::int64_t>(config_.turn_quantum);
  while (turn_work_ < config_.turn_work && !ready_.empty()) {
    const auto link = ready_.front();
    ready_.pop_front();
    const auto at = connections_.find(link);
    if (at == connections_.end())
      continue;
    auto& x = at->second;
    x.credit = std::min(x.credit + quantum, quantum);
    if (x.credit > 0) {
      serve_link(x, now);
      return true;
    }
    ready_.push_back(link);
    turn_work_ += 1;
  }
  return false;
}

/// Handles what a link has brought until its credit is used up or there is no whole package left.
void p2p::serve_link(connection& from, instant now) {
  const auto link = from.id;
  const auto begun = std::exchange(serving_, link);
  // What is decoded must outlive the connection, which a package may close.
  auto decoder = std::exchange(from.decoder, {});
  if (!from.open) {
    if (const auto request = decoder.take_connect_request())
      accept(from, *request, now);
  }
  bool more = false;
  auto at = connections_.find(link);
  for (; at != connections_.end() && at->second.open; at = connections_.find(link)) {
    auto& x = at->second;
    more = x.credit <= 0 || !x.budget.is_within(now);
    const auto package = more ? std::nullopt : decoder.next();
    if (!package)
      break;
    x.last_heard = now;
    note_counter(x, package->header.counter);
    x.budget.charge_package(header_size + package->data.size(), now);
    const acting_on its(carries_content(package->header.port)
                            ? package_comes(name_of(package->header))
                            : provenance());
    on_package(link, package->header, package->data, now);
    charge(link, work_.take(), now);
    spend(link, 1);
  }
  serving_ = begun;
  if (at == connections_.end())
    return;
  const bool broken = decoder.broken();
  at->second.decoder = std::move(decoder);
  if (broken) {
    ++counters_.links_broken;
    close(link, close_cause::bad_stream, now);
  } else {
    queue_again(at->second, more && at->second.decoder.has_more(), now);
  }
}

void p2p::queue_again(connection& x, bool more, instant now) {
  x.waits = more;
  if (!more) {
    x.credit = std::min<std::int64_t>(x.credit, 0);
    if (std::exchange(x.held, false))
      events_.push_back(read_link{x.id, true});
  } else if (x.budget.is_within(now)) {
    ready_.push_back(x.id);
  } else {
    ++counters_.rests;
    resting_.emplace(x.budget.free_at(), x.id);
  }
}

void p2p::spend(link_id link, work_units work) {
  turn_work_ += work;
  const auto at = connections_.find(link);
  if (at == connections_.end())
    return;
  auto& x = at->second;
  const auto least = -deficit_max * static_cast<std::int64_t>(config_.turn_quantum);
  const auto cost = static_cast<std::int64_t>(std::min<work_units>(work, 1U << 30));
  x.credit = std::max(x.credit - cost, least);
}

void p2p::charge(link_id link, work_units work, instant now) {
  if (work == 0)
    return;
  counters_.work += work;
  spend(link, work);
  const auto at = connections_.find(link);
  if (at != connections_.end())
    at->second.budget.charge_work(work, now);
}

/// What is left of the newest octets is kept, and no more is wanted until it has been handled.
void p2p::end_turn(instant now) {
  turn_work_ = 0;
  latest_ = now;
  const auto at = fed_ ? connections_.find(*fed_) : connections_.end();
  fed_.reset();
  if (at == connections_.end() || !at->second.waits)
    return;
  auto& x = at->second;
  x.decoder.keep_rest();
  if (x.decoder.kept() > config_.input_max) {
    ++counters_.links_broken;
    close(x.id, close_cause::over_budget, now);
  } else if (!std::exchange(x.held, true)) {
    ++counters_.held;
    events_.push_back(read_link{x.id, false});
  }
}

std::optional<instant> p2p::input_deadline() const {
  if (!ready_.empty())
    return latest_;
  return resting_.empty() ? std::nullopt : std::optional(resting_.begin()->first);
}

} // namespace rubicon::peis
