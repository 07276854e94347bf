#include "traffic/program.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <string>

#include "traffic/packet.hpp"

namespace rubicon::traffic {

namespace {

bool is_broadcast(std::pair<mote_id, mote_id> flow) {
  return flow.second == broadcast_mote;
}

} // namespace

program::program(const program_config& config, mote_address self, random_stream rng)
    : relay_(config.relay), receives_(config.receives), self_(self) {
  for (const auto& x : config.senders) {
    assert(x.payload >= payload_min && x.payload <= payload_max);
    senders_.push_back({x, schedule(x, random_stream(rng.next()))});
    static_cast<void>(flow_of({self.mote, x.to}));
  }
}

outputs program::start(instant now) {
  const auto since_run_start = now.time_since_epoch();
  next_number_ = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(since_run_start).count());
  next_token_ = static_cast<std::uint64_t>(since_run_start.count());
  for (auto& x : senders_)
    x.times.start(now);
  return on_time(now);
}

outputs program::on_time(instant now) {
  outputs out;
  for (auto& x : senders_)
    x.times.on_time(now);
  for (;;) { // the most overdue first; of equals the first in the file
    std::optional<std::size_t> next;
    for (std::size_t i = 0; i < senders_.size(); ++i) {
      const auto due = senders_[i].times.due();
      if (due && *due <= now && (!next || *due < *senders_[*next].times.due()))
        next = i;
    }
    if (!next)
      return out;
    originate(*next, now, out);
  }
}

void program::originate(std::size_t place, instant now, outputs& out) {
  auto& [config, times] = senders_[place];
  const flow_key key{self_.mote, config.to};
  ++flow_of(key).sent;
  times.on_request(now);
  const packet x{self_.mote, config.to, next_number_++ & number_max, now,
                 config.payload - am_overhead};
  const auto to_all = is_broadcast(key);
  const auto next_hop = to_all ? broadcast_mote : config.via.value_or(config.to);
  if (!submit({key, place, now}, {0, next_hop, encode(x), config.ack && !to_all}, out))
    times.on_answer(now, now);
}

/// @returns false if there were too many; then it counts as lost
bool program::submit(const request& x, transmit frame, outputs& out) {
  static_cast<void>(flow_of(x.flow));
  if (open_.size() >= open_max) {
    lose(x.flow, "queue_full");
    return false;
  }
  frame.token = next_token_++;
  open_.emplace(frame.token, x);
  out.push_back(std::move(frame));
  return true;
}

outputs program::on_packet(mote_id source, byte_view payload, instant now) {
  const auto x = decode_packet(payload);
  if (!x) {
    ++undecodable_;
    return {};
  }
  const flow_key key{x->origin, x->target};
  std::optional<novelty> news;
  if (flows_.contains(key) || flows_.size() < flows_max)
    news = memory_.note(x->origin, source, x->number);
  if (!news) {
    ++undecodable_;
    return {};
  }
  const auto for_me = x->target == self_.mote;
  if (!for_me && !is_broadcast(key))
    return relay(key, *news, payload, now);
  if (*news != novelty::fresh || (x->origin == self_.mote && !for_me)) // a broadcast of its own
    return {};
  if (receives_ && !stopped_) {
    auto& flow = flow_of(key);
    ++flow.delivered;
    flow.octets += payload.size() + am_overhead;
    flow.delay.add(now - x->requested);
  } else if (for_me) {
    lose(key, stopped_ ? "aborted" : "no_receiver");
  }
  return {};
}

/// Passes on a packet for somebody else, or counts why not.
outputs program::relay(flow_key key, novelty news, byte_view payload, instant now) {
  outputs out;
  if (news == novelty::repeated)
    return out;
  if (stopped_)
    lose(key, "aborted");
  else if (news == novelty::returned || key.first == self_.mote)
    lose(key, "loop");
  else if (!relay_)
    lose(key, "no_relay");
  else
    static_cast<void>(
        submit({key, {}, now}, {0, relay_->next, to_bytes(payload), relay_->ack}, out));
  return out;
}

outputs program::on_done(std::uint64_t token, const outcome& x, instant now) {
  const auto found = open_.find(token);
  if (found == open_.end())
    return {};
  const auto ended = found->second;
  open_.erase(found);
  flow_of(ended.flow).transmissions += x.transmissions;
  if (!x.arrived)
    lose(ended.flow, x.cause.empty() ? "unknown" : x.cause);
  if (!ended.sender || stopped_)
    return {};
  senders_[*ended.sender].times.on_answer(ended.made, now);
  return on_time(now);
}

void program::stop(instant now) {
  stopped_ = true;
  for (auto& x : senders_)
    x.times.end(now);
}

std::optional<instant> program::deadline() const {
  std::optional<instant> first;
  for (const auto& x : senders_)
    first = earliest(first, x.times.due());
  return first;
}

std::vector<part> program::parts(instant now) const {
  auto flows = flows_;
  for (const auto& [token, x] : open_) {
    if (stopped_ && !is_broadcast(x.flow))
      ++flows.at(x.flow).lost["aborted"];
  }
  std::map<flow_key, schedule::span> active; // of all senders of a flow together
  for (const auto& x : senders_) {
    if (const auto span = x.times.active(now)) {
      auto& all = active.try_emplace({self_.mote, x.config.to}, *span).first->second;
      all = {std::min(all.from, span->from), std::max(all.until, span->until)};
    }
  }
  std::vector<part> result;
  for (auto& [key, flow] : flows) {
    if (const auto span = active.find(key); span != active.end())
      flow.active = span->second.until - span->second.from;
    result.push_back(std::move(flow));
  }
  return result;
}

part& program::flow_of(flow_key key) {
  auto& x = flows_[key];
  x.from = {self_.island, key.first};
  x.to = {self_.island, key.second};
  return x;
}

void program::lose(flow_key key, std::string_view cause) {
  auto& flow = flow_of(key);
  if (!is_broadcast(key))
    ++flow.lost[std::string(cause)];
}

} // namespace rubicon::traffic
