#include "transport/endpoint.hpp"

#include <algorithm>

namespace rubicon::transport {

endpoint::endpoint(endpoint_config config, random_stream dice)
    : config_(config), next_sequence_(static_cast<std::uint16_t>(dice.next())) {}

std::optional<outputs> endpoint::send(ticket id, mote_address destination, std::uint8_t am_type,
                                      bytes payload, bool reliable, instant now) {
  if (destination.mote == own_mote)
    destination.mote = config_.self;
  const bool refused = payload.size() > payload_max ||
                       (reliable && destination.mote == broadcast_mote) ||
                       (reliable && waiting_.size() >= config_.outstanding_max);
  if (refused) {
    ++counters_.refused;
    return std::nullopt;
  }
  segment content{config_.self, next_sequence_++, am_type, reliable, false, std::move(payload)};
  outputs out{wrap(destination, content)};
  if (reliable) {
    ++counters_.reliable_sent;
    waiting_.push_back({id, destination, std::move(content), 1, now + config_.ack_wait});
  } else {
    ++counters_.unreliable_sent;
  }
  return out;
}

outputs endpoint::on_segment(island_id source_island, byte_view octets, instant) {
  auto decoded = decode_segment(octets);
  if (!decoded) {
    ++counters_.malformed;
    return {};
  }
  segment& x = *decoded;
  const mote_address source{source_island, x.source};
  if (x.acknowledgement)
    return on_acknowledgement(source, x.sequence);
  outputs out;
  if (x.reliable) {
    segment ack{config_.self, x.sequence, x.am_type, false, true, {}};
    out.emplace_back(wrap(source, ack));
    if (seen_before(source, x.sequence)) {
      ++counters_.duplicates;
      return out;
    }
  }
  ++counters_.received;
  out.emplace_back(received{source, x.am_type, std::move(x.payload)});
  return out;
}

outputs endpoint::on_acknowledgement(mote_address source, std::uint16_t sequence) {
  // An own_island destination is answered with the island's real number: the mote part and the
  // sequence number, both unique among what is outstanding, decide.
  const auto found = std::find_if(waiting_.begin(), waiting_.end(), [&](const waiting& x) {
    return x.content.sequence == sequence && x.destination.mote == source.mote;
  });
  if (found == waiting_.end()) {
    ++counters_.stray_acks;
    return {};
  }
  ++counters_.reliable_acked;
  const outcome done{found->id, true};
  waiting_.erase(found);
  return {done};
}

outputs endpoint::on_time(instant now) {
  outputs out;
  for (auto x = waiting_.begin(); x != waiting_.end();) {
    if (x->due > now) {
      ++x;
    } else if (x->attempts >= config_.attempts_max) {
      ++counters_.reliable_failed;
      out.emplace_back(outcome{x->id, false});
      x = waiting_.erase(x);
    } else {
      ++counters_.retries;
      out.emplace_back(wrap(x->destination, x->content));
      x->due = now + config_.ack_wait * (1U << x->attempts);
      ++x->attempts;
      ++x;
    }
  }
  return out;
}

std::optional<instant> endpoint::deadline() const {
  std::optional<instant> next;
  for (const auto& x : waiting_)
    next = earliest(next, x.due);
  return next;
}

outputs endpoint::fail_all() {
  outputs out;
  for (const auto& x : waiting_)
    out.emplace_back(outcome{x.id, false});
  counters_.reliable_failed += waiting_.size();
  waiting_.clear();
  return out;
}

to_network endpoint::wrap(mote_address destination, const segment& x) const {
  return {destination, x.am_type, encode(x)};
}

bool endpoint::seen_before(mote_address source, std::uint16_t sequence) {
  auto found = std::find_if(heard_.begin(), heard_.end(),
                            [&](const history& x) { return x.source == source; });
  history entry{source, {}};
  if (found != heard_.end()) {
    entry = std::move(*found);
    heard_.erase(found);
  } else if (heard_.size() >= config_.sources_max) {
    heard_.pop_front();
  }
  auto& sequences = entry.sequences;
  const bool seen = std::find(sequences.begin(), sequences.end(), sequence) != sequences.end();
  if (!seen) {
    sequences.push_back(sequence);
    if (sequences.size() > config_.sequences_per_source)
      sequences.pop_front();
  }
  heard_.push_back(std::move(entry));
  return seen;
}

} // namespace rubicon::transport
