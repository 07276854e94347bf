#include "peis/links/message_delivery.hpp"

#include <algorithm>

#include "core/account/message_ledger.hpp"
#include "peis/wire/acknowledgement.hpp"

namespace rubicon::peis {

message_delivery::message_delivery(own_peer& own, link_table& links, const overlay& routes,
                                   package_sender& sender, traffic_meter& traffic)
    : own_(own), links_(links), overlay_(routes), sender_(sender), traffic_(traffic),
      assembly_(own.config.assembly), acknowledger_(own.config.ack_delay),
      reliable_(own.config.reliable) {}

void message_delivery::send(posting x, link_id origin, events& out) {
  const auto hop = overlay_.any_hop(x.destination);
  auto why = cause::none;
  if (own_.left)
    why = cause::left;
  else if (x.content.size() > fragments_max * data_max)
    why = cause::too_long;
  else if (!hop)
    why = cause::no_route;
  else if (!x.reliable)
    why = send_unreliable(x, *hop, origin);
  if (why == cause::none && !x.reliable && x.id != no_request)
    out.push_back(delivered{x.id});
  if (why == cause::none && x.reliable) {
    if (add_reliable(x)) {
      pump(x.destination, out);
      return;
    }
    why = cause::queue_full;
  }
  if (why != cause::none) {
    sender_.count_drop(why);
    out.push_back(undelivered{x.id, x.destination, x.port, x.content.head, why});
  }
}

/// The head stays in the posting, for undelivered.
bool message_delivery::add_reliable(posting& x) {
  const auto service = x.content.size() > data_max ? priority::bulk : x.class_of_service;
  const auto head = x.content.head;
  const bool added =
      reliable_.add({own_.self.id, x.destination, x.port, service, x.id,
                     std::make_shared<const message_octets>(std::move(x.content)), x.for_neighbour},
                    own_.ids);
  if (added && x.for_neighbour) {
    ++answers_open_;
    ++answers_[*x.for_neighbour];
  }
  x.content.head = head;
  return added;
}

/// All of its packages are queued, or none.
cause message_delivery::send_unreliable(const posting& x, link_id hop, link_id origin) {
  auto& queue = links_.at(hop).out.queue;
  const auto size = x.content.size();
  const auto count = std::max<std::size_t>(1, (size + data_max - 1) / data_max);
  const auto where = count > 1 ? lane::bulk
                               : static_cast<lane>(static_cast<std::size_t>(lane::high) +
                                                   static_cast<std::size_t>(x.class_of_service));
  if (const auto verdict =
          queue.admission(where, count, size + count * header_size, origin, own_.rng);
      verdict != cause::none)
    return verdict;
  const auto content = std::make_shared<const message_octets>(x.content);
  const auto seqid = own_.ids.next_group();
  for (std::size_t i = 0; i < count; ++i) {
    auto header = own_.fresh_header(package_type::direct, x.port);
    header.destination = x.destination;
    if (where == lane::high)
      header.flags = package_flag::high;
    if (count > 1) {
      header.flags = package_flag::bulk;
      header.seqlen = static_cast<std::uint16_t>(count);
      header.seqid = seqid;
      header.seqnum = static_cast<std::uint16_t>(i);
    }
    const outgoing_package next{header, content, i * data_max};
    traffic_.count(next);
    queue.push(where, next, origin);
  }
  return cause::none;
}

/// Queues what the window to a destination and the queue of its next hop have room for.
void message_delivery::pump(peer_id destination, events& out) {
  const auto hop = overlay_.any_hop(destination);
  if (!hop) {
    if (reliable_.only_waiting(destination)) {
      for (const auto& x : reliable_.fail_all(destination))
        fail(x, cause::no_route, out);
    } else if (reliable_.waits_anew(destination)) {
      stalled_.insert(destination); // until there is a route, or the host is given up
    }
    return;
  }
  auto& link = links_.at(*hop);
  auto& queue = link.out.queue;
  const bool wide = link.neighbour == destination && link.signs.beat.has_value();
  while (const auto where = reliable_.next_lane(destination, wide)) {
    if (!queue.has_room(*where)) {
      stalled_.insert(destination);
      return;
    }
    auto x = reliable_.next(destination, own_.ids, wide);
    traffic_.count(x->second);
    queue.push(x->first, std::move(x->second));
  }
}

void message_delivery::repeat_due(instant now, events& out) {
  while (auto due = reliable_.take_due(now, own_.ids)) {
    const auto hop = overlay_.any_hop(due->destination);
    if (due->failed) {
      fail(*due->failed, hop ? cause::too_many_retries : cause::connection_dead, out);
      pump(due->destination, out);
    } else if (!hop || sender_.enqueue(links_.at(*hop), lane::acknowledgements,
                                       std::move(*due->again), own_origin) != cause::none) {
      reliable_.on_unsendable(due->ack_id, now);
    } else {
      ++own_.counters.retransmissions;
    }
  }
}

void message_delivery::begin_anew(const std::set<peer_id>& destinations, events& out) {
  for (const auto destination : destinations) {
    auto outcome = reliable_.begin_anew(destination, own_.ids);
    own_.counters.messages_begun_anew += outcome.begun;
    for (const auto& x : outcome.failed)
      fail(x, cause::too_many_retries, out);
    stalled_.insert(destination); // continue_stalled() goes on with it
  }
}

void message_delivery::begin_stale_anew(events& out) {
  begin_anew(reliable_.take_stale(), out);
}

void message_delivery::continue_stalled(events& out) {
  for (const auto destination : std::exchange(stalled_, {}))
    pump(destination, out);
}

void message_delivery::fail(const reliable_message& x, cause why, events& out) {
  ++own_.counters.messages_failed;
  on_ended(x);
  out.push_back(undelivered{x.request, x.destination, x.port, x.content->head, why});
}

void message_delivery::on_ended(const reliable_message& x) {
  const auto open = x.for_neighbour ? answers_.find(*x.for_neighbour) : answers_.end();
  if (open == answers_.end())
    return;
  --answers_open_;
  if (--open->second == 0)
    answers_.erase(open);
}

bool message_delivery::may_answer(link_id from) const {
  const auto max = own_.config.tables.answers;
  const auto open = answers_.find(from);
  return answers_open_ < max && (open == answers_.end() ? 0 : open->second) < max - answers_open_;
}

void message_delivery::acknowledge(const package_header& header, link_id origin, instant now) {
  const auto full = acknowledger_.add(header.source, header.ack_id, now);
  if (!full.empty())
    send_acknowledgements(header.source, full, origin);
}

void message_delivery::acknowledge_due(instant now) {
  for (const auto& [to, ids] : acknowledger_.take(now))
    send_acknowledgements(to, ids, own_origin);
}

void message_delivery::send_acknowledgements(peer_id to, const std::vector<std::int32_t>& ids,
                                             link_id origin) {
  const auto hop = overlay_.any_hop(to);
  if (!hop) {
    ++own_.counters.no_route;
    return;
  }
  own_.counters.acks_sent += ids.size();
  ++own_.counters.ack_packages_sent;
  sender_.send_to_host(to, *hop, lane::acknowledgements, port::acknowledgements,
                       encode_acknowledgement(ids), origin);
}

void message_delivery::on_acknowledgement(byte_view data, events& out) {
  const auto ids = decode_acknowledgement(data);
  if (!ids) {
    ++own_.counters.malformed;
    return;
  }
  std::optional<peer_id> opened;
  for (const auto id : *ids) {
    auto done = reliable_.acknowledge(id);
    if (!done)
      continue;
    ++own_.counters.acks_received;
    if (opened && *opened != done->destination)
      pump(*opened, out);
    opened = done->destination;
    if (done->finished) {
      ++own_.counters.messages_delivered;
      on_ended(*done->finished);
      if (done->finished->request != no_request)
        out.push_back(delivered{done->finished->request});
    }
  }
  if (opened)
    pump(*opened, out);
}

/// What has not left over a link that is gone. Real kernels may have taken parts of messages, which
/// they drop before the rest comes over another link.
void message_delivery::on_link_closed(connection& gone, instant now, events& out) {
  std::set<peer_id> broken_off;
  const auto drop = [&](std::int32_t ack_id) {
    if (const auto to = reliable_.destination_of(ack_id); to && gone.out.paced)
      broken_off.insert(*to);
    reliable_.on_dropped(ack_id, now);
  };
  for (const auto& [end, ack_id] : gone.out.leaving)
    drop(ack_id);
  while (const auto x = gone.out.queue.pop()) {
    if (x->header.reliable() && x->header.source == own_.self.id) {
      drop(x->header.ack_id);
    } else {
      ++own_.counters.queued_lost;
      rubicon::note_loss(x->from, loss::package_lost);
    }
  }
  if (gone.out.paced && gone.neighbour)
    broken_off.insert(*gone.neighbour);
  begin_anew(broken_off, out);
}

void message_delivery::on_host_gone(peer_id host, events& out) {
  for (const auto& x : reliable_.fail_all(host))
    fail(x, cause::host_gone, out);
  acknowledger_.drop(host);
  assembly_.drop(host);
  stalled_.erase(host);
}

std::optional<instant> message_delivery::deadline() const {
  return earliest(earliest(acknowledger_.deadline(), reliable_.deadline()), assembly_.deadline());
}

} // namespace rubicon::peis
