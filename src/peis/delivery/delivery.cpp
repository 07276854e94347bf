#include "peis/delivery/delivery.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::peis {

namespace {

/// Places of the window that bulk leaves free, so that a long message delays no short one.
constexpr std::size_t reserve_divisor = 8;

} // namespace

std::uint16_t delivery::packages_of(const transfer& x) {
  return std::max<std::uint16_t>(1, x.fragments);
}

bool delivery::add(reliable_message message, id_source& ids) {
  auto& to = flows_[message.destination];
  const auto size = message.content->size();
  if (to.waiting >= config_.waiting_max ||
      (to.waiting > 0 && to.waiting_octets + size > config_.waiting_octets_max))
    return false;
  transfer x;
  if (size > data_max) {
    x.fragments = static_cast<std::uint16_t>((size + data_max - 1) / data_max);
    x.seqid = ids.next_group();
  }
  const auto id = next_transfer_++;
  to.queues[static_cast<std::size_t>(message.class_of_service)].push_back(id);
  ++to.waiting;
  to.waiting_octets += size;
  x.message = std::move(message);
  transfers_.emplace_hint(transfers_.end(), id, std::move(x));
  return true;
}

/// The queue of the highest priority that has a message and may use the window.
const std::deque<std::uint64_t>* delivery::open_queue(const flow& x,
                                                      const delivery_window& window) const {
  if (x.in_flight >= window.packages || x.order.size() >= window.span)
    return nullptr;
  const auto bulk_window = window.packages - window.packages / reserve_divisor;
  for (std::size_t i = 0; i < x.queues.size(); ++i) {
    const bool bulk = i == static_cast<std::size_t>(priority::bulk);
    if (!x.queues[i].empty() && (!bulk || x.in_flight < bulk_window))
      return &x.queues[i];
  }
  return nullptr;
}

std::optional<lane> delivery::next_lane(peer_id destination, bool wide) const {
  const auto at = flows_.find(destination);
  const auto* queue =
      at == flows_.end() ? nullptr : open_queue(at->second, wide ? config_.wide : config_.window);
  if (queue == nullptr)
    return std::nullopt;
  const auto& message = transfers_.at(queue->front()).message;
  return static_cast<lane>(static_cast<std::size_t>(lane::high) +
                           static_cast<std::size_t>(message.class_of_service));
}

std::optional<std::pair<lane, outgoing_package>> delivery::next(peer_id destination, id_source& ids,
                                                                bool wide) {
  const auto where = next_lane(destination, wide);
  if (!where)
    return std::nullopt;
  auto& to = flows_.at(destination);
  auto& queue = to.queues[static_cast<std::size_t>(*where) - static_cast<std::size_t>(lane::high)];
  const auto id = queue.front();
  auto& x = transfers_.at(id);
  const auto ack_id = ids.next();
  auto package = package_of(x, x.begun, ack_id, ids);
  in_flight_.emplace(ack_id, pending{id, x.begun, 1, std::nullopt});
  to.order.push_back(ack_id);
  ++x.begun;
  ++x.unacknowledged;
  ++to.in_flight;
  if (x.begun == packages_of(x)) {
    queue.pop_front();
    on_begun(to, x);
  }
  return std::pair{*where, std::move(package)};
}

outgoing_package delivery::package_of(const transfer& x, std::uint16_t fragment,
                                      std::int32_t ack_id, id_source& ids) const {
  outgoing_package package;
  auto& header = package.header;
  header.id = ids.next();
  header.ack_id = ack_id;
  header.flags = package_flag::reliable;
  if (x.fragments > 0)
    header.flags |= package_flag::bulk;
  if (x.message.class_of_service == priority::high)
    header.flags |= package_flag::high;
  header.source = x.message.source;
  header.destination = x.message.destination;
  header.port = x.message.port;
  package.offset = fragment * data_max;
  header.seqlen = x.fragments;
  header.seqid = x.seqid;
  header.seqnum = fragment;
  package.content = x.message.content;
  package.from = x.message.from;
  return package;
}

void delivery::note_taken(pending& x, instant now) {
  auto& owner = transfers_.at(x.transfer);
  if (owner.is_broken_off() && owner.last_taken + config_.pause_max <= now) {
    owner.paused = true;
    stale_.insert(owner.message.destination);
  }
  owner.last_taken = now;
  owner.taken = static_cast<std::uint16_t>(owner.taken + (std::exchange(x.taken, true) ? 0 : 1));
}

std::optional<peer_id> delivery::destination_of(std::int32_t ack_id) const {
  const auto at = in_flight_.find(ack_id);
  if (at == in_flight_.end())
    return std::nullopt;
  return transfers_.at(at->second.transfer).message.destination;
}

void delivery::on_transmitted(std::int32_t ack_id, instant now) {
  const auto at = in_flight_.find(ack_id);
  if (at == in_flight_.end())
    return;
  auto& x = at->second;
  note_taken(x, now);
  x.due = now + x.attempts * config_.retry_time;
  waits_[x.attempts].push_back({*x.due, ack_id});
}

void delivery::on_dropped(std::int32_t ack_id, instant now) {
  const auto at = in_flight_.find(ack_id);
  if (at == in_flight_.end() || at->second.due)
    return;
  at->second.due = now;
  waits_[0].push_back({now, ack_id});
}

bool delivery::is_current(const wait& x) const {
  const auto at = in_flight_.find(x.ack_id);
  return at != in_flight_.end() && at->second.due == x.until;
}

void delivery::shorten_waits() {
  for (auto& queue : waits_) {
    while (!queue.empty() && !is_current(queue.front()))
      queue.pop_front();
  }
}

/// A transfer waits no more for its first package to leave.
void delivery::on_begun(flow& x, const transfer& which) const {
  --x.waiting;
  x.waiting_octets -= which.message.content->size();
}

void delivery::shorten(flow& x) const {
  while (!x.order.empty() && !in_flight_.contains(x.order.front()))
    x.order.pop_front();
}

std::optional<delivery::acknowledged> delivery::acknowledge(std::int32_t ack_id) {
  const auto at = in_flight_.find(ack_id);
  if (at == in_flight_.end())
    return std::nullopt;
  const auto owner = transfers_.find(at->second.transfer);
  assert(owner != transfers_.end());
  owner->second.taken =
      static_cast<std::uint16_t>(owner->second.taken + (at->second.taken ? 0 : 1));
  in_flight_.erase(at);
  shorten_waits();
  auto& x = owner->second;
  acknowledged done{x.message.destination, std::nullopt};
  const auto to = flows_.find(x.message.destination);
  --to->second.in_flight;
  shorten(to->second);
  if (--x.unacknowledged == 0 && x.begun == packages_of(x)) {
    done.finished = std::move(x.message);
    transfers_.erase(owner);
  }
  if (to->second.idle())
    flows_.erase(to);
  return done;
}

std::optional<delivery::due> delivery::take_due(instant now, id_source& ids) {
  std::deque<wait>* first = nullptr;
  for (auto& queue : waits_) {
    if (!queue.empty() && (first == nullptr || queue.front().until < first->front().until))
      first = &queue;
  }
  if (first == nullptr || first->front().until > now)
    return std::nullopt;
  const auto ack_id = first->front().ack_id;
  first->pop_front();
  auto& x = in_flight_.at(ack_id);
  x.due.reset();
  const auto& owner = transfers_.at(x.transfer);
  due result;
  result.destination = owner.message.destination;
  result.ack_id = ack_id;
  if (x.attempts >= attempts_max) {
    result.failed = fail(x.transfer);
  } else {
    ++x.attempts;
    result.again = package_of(owner, x.fragment, ack_id, ids);
  }
  shorten_waits();
  return result;
}

/// Forgets all that is in flight of a transfer.
void delivery::withdraw(std::uint64_t id, transfer& x, flow& to) {
  for (auto ack_id = to.order.begin(); x.unacknowledged > 0; ++ack_id) {
    const auto at = in_flight_.find(*ack_id);
    if (at == in_flight_.end() || at->second.transfer != id)
      continue;
    in_flight_.erase(at);
    --x.unacknowledged;
    --to.in_flight;
  }
  shorten(to);
  shorten_waits();
}

/// Ends a transfer (ACK-07).
reliable_message delivery::fail(std::uint64_t id) {
  const auto owner = transfers_.find(id);
  auto& x = owner->second;
  const auto to = flows_.find(x.message.destination);
  withdraw(id, x, to->second);
  if (x.begun < packages_of(x)) {
    auto& queue = to->second.queues[static_cast<std::size_t>(x.message.class_of_service)];
    queue.erase(std::find(queue.begin(), queue.end(), id));
    on_begun(to->second, x);
  }
  if (to->second.idle())
    flows_.erase(to);
  auto message = std::move(x.message);
  transfers_.erase(owner);
  return message;
}

std::set<std::uint64_t> delivery::transfers_of(const flow& x) const {
  std::set<std::uint64_t> ids; // a message in flight may wait with its rest
  for (const auto& queue : x.queues)
    ids.insert(queue.begin(), queue.end());
  for (const auto ack_id : x.order) {
    if (const auto at = in_flight_.find(ack_id); at != in_flight_.end())
      ids.insert(at->second.transfer);
  }
  return ids;
}

delivery::anew delivery::begin_anew(peer_id destination, id_source& ids) {
  anew result;
  const auto to = flows_.find(destination);
  if (to == flows_.end())
    return result;
  const auto all = transfers_of(to->second);
  for (auto at = all.rbegin(); at != all.rend(); ++at) { // the oldest comes first again
    auto& x = transfers_.at(*at);
    if (!x.is_broken_off())
      continue;
    if (x.tries >= config_.tries_max) {
      result.failed.push_back(fail(*at));
      continue;
    }
    withdraw(*at, x, to->second);
    if (x.begun == packages_of(x)) {
      to->second.queues[static_cast<std::size_t>(x.message.class_of_service)].push_front(*at);
      ++to->second.waiting;
      to->second.waiting_octets += x.message.content->size();
    }
    x.begun = x.taken = 0;
    x.paused = false;
    x.seqid = ids.next_group();
    ++x.tries;
    ++result.begun;
  }
  return result;
}

std::vector<reliable_message> delivery::fail_all(peer_id destination) {
  const auto to = flows_.find(destination);
  if (to == flows_.end())
    return {};
  std::vector<reliable_message> failed;
  for (const auto id : transfers_of(to->second))
    failed.push_back(fail(id));
  return failed;
}

bool delivery::only_waiting(peer_id destination) const {
  const auto at = flows_.find(destination);
  return at != flows_.end() && at->second.in_flight == 0 && at->second.waiting > 0 &&
         !waits_anew(destination);
}

bool delivery::waits_anew(peer_id destination) const {
  const auto at = flows_.find(destination);
  if (at == flows_.end() || at->second.in_flight > 0)
    return false;
  return std::ranges::any_of(at->second.queues, [this](const auto& queue) {
    return !queue.empty() && transfers_.at(queue.front()).tries > 1; // they are at the front
  });
}

std::optional<instant> delivery::deadline() const {
  std::optional<instant> next;
  for (const auto& queue : waits_) {
    if (!queue.empty())
      next = earliest(next, queue.front().until);
  }
  return next;
}

} // namespace rubicon::peis
