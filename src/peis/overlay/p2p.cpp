// Packages: receiving, forwarding, sending (peis-wire.md 6 to 8).
#include "peis/overlay/p2p.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "peis/wire/acknowledgement.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t octets_per_work = 512; // copied for each link that a package goes to

/// The class in which a package of somebody else goes on.
lane lane_of(const package_header& header) {
  if (header.port == port::acknowledgements)
    return lane::acknowledgements;
  if ((header.flags & package_flag::high) != 0)
    return lane::high;
  return (header.flags & package_flag::bulk) != 0 ? lane::bulk : lane::normal;
}

} // namespace

p2p::p2p() = default;
p2p::~p2p() = default;
p2p::p2p(p2p&&) noexcept = default;
p2p& p2p::operator=(p2p&&) noexcept = default;

p2p::p2p(p2p_config config, random_stream rng, instant now)
    : config_(std::move(config)), rng_(rng), ids_(rng_), strangers_(config_.routing_period),
      seen_(config_.tables.seen, rng_), assembly_(config_.assembly),
      acknowledger_(config_.ack_delay), delivery_(config_.reliable),
      bluetooth_(config_.bluetooth, now), traffic_(config_.tables.routes, now),
      probes_(config_.tables.probes, config_.probe_timeout),
      clock_({config_.time_master, config_.clock_period, config_.clock_offset, config_.clock_ppb},
             config_.id, now),
      next_manager_(now + config_.connections.manager_period), next_merge_(now),
      next_announcement_(now),
      next_period_(now + rng_.between(config_.routing_period / 2, config_.routing_period)),
      last_trigger_(now - config_.trigger_gap), latest_(now),
      routing_rate_(config_.tables.routing_work_per_second, 1s, 2s),
      asking_rate_(config_.tables.questions_per_second, 1s, 1s) {
  queues_ = std::make_shared<queues_memory>(queues_memory{config_.queues_octets_max});
  self_.id = config_.id;
  self_.magic = ids_.next();
  rivalry_ = id_rivalry(self_.magic, now);
  self_.host_name = config_.host_name;
  self_.full_name = config_.name + '@' + config_.host_name + '!' + std::to_string(config_.process);
  keep_addresses(config_.addresses);
  self_.cluster = self_.id.value;
  self_.marked = true;
  routing_ = routing_table(self_.id, self_.magic, config_.metric_limit, config_.tables.routes);
  const auto& wanted = config_.connections;
  for (const auto* urls : {&wanted.always, &wanted.seeds}) {
    for (const auto& url : *urls)
      standing_.push_back({url, urls == &wanted.seeds, wanted.always_retry, now, false, {}, {}});
  }
}

void p2p::keep_addresses(std::vector<low_level_address> all) {
  config_.addresses = all;
  if (config_.connections.leaf) // other hosts are not to come (LEA-01)
    std::erase_if(all, [](const auto& x) { return !x.loopback; });
  all.resize(std::min(all.size(), low_level_addresses_max));
  self_.addresses = std::move(all);
}

void p2p::set_addresses(std::vector<low_level_address> all, instant now) {
  const auto before = self_.addresses;
  keep_addresses(std::move(all));
  if (self_.addresses == before || left_)
    return;
  next_announcement_ = now;
  for (auto& [id, x] : connections_)
    if (x.neighbour)
      tell_neighbour(x, port::host_record, encode(host_record_message{self_, false}));
}

void p2p::on_time(instant now) {
  latest_ = now;
  settle(rivalry_.on_time(now), now);
  if (rivalry_.is_away() && !left_)
    return;
  if (!left_ && now >= next_period_)
    on_period(now);
  counters_.messages_incomplete += assembly_.on_time(now);
  check_silence(now);
  apply_tables(now);
  watch_life(now);
  tend_connections(now);
  if (!left_)
    tend_doubts(now);
}

std::optional<instant> p2p::deadline() const {
  if (rivalry_.is_away() && !left_)
    return rivalry_.deadline();
  auto next = earliest(acknowledger_.deadline(), delivery_.deadline());
  next = earliest(next, rivalry_.deadline());
  next = earliest(next, assembly_.deadline());
  next = earliest(next, next_silence_check_);
  next = earliest(next, input_deadline());
  next = earliest(next, next_tables_);
  next = earliest(next, life_deadline());
  if (!left_)
    next = earliest(next, next_doubt_);
  next = earliest(next, connections_deadline());
  if (left_)
    return next;
  if (const auto question = strangers_.next())
    next = earliest(next, std::max(question->first, asking_rate_.free_at()));
  return earliest(earliest(next, next_trigger_), next_period_);
}

/// The steps of peis-wire.md 7, in its order.
void p2p::on_package(link_id from, const package_header& header, byte_view data, instant now) {
  ++counters_.packages_received;
  if (!is_legal(header)) {
    ++counters_.illegal;
    return;
  }
  if (header.source == self_.id) {
    ++counters_.own;
    hear_own_id(from, header, data, now);
    return;
  }
  if (is_impersonation(from, header, now)) {
    ++counters_.claims_refused; // before it counts as seen: the true one may still come
    return;
  }
  probes_.end(header.source);
  if (!seen_.insert(header.source, header.id, from)) {
    ++counters_.seen;
    return;
  }
  if (header.type == package_type::direct)
    note_heard(header.source, from);
  const bool mine = header.type == package_type::direct && header.destination == self_.id;
  if (mine && header.seqlen > 0 && !assembly_.accepts(header, from)) {
    ++counters_.fragments_refused; // not acknowledged: it comes again
    return;
  }
  if (mine && header.reliable() && header.port != port::acknowledgements)
    acknowledge(header, now);
  if (mine && header.ack_id != header.id && header.ack_id != 0 &&
      !seen_.insert(header.source, header.ack_id, from)) {
    ++counters_.repeated;
    return;
  }
  if (mine && header.seqlen > 0) {
    on_fragment(from, header, data, now);
    return;
  }
  const bool is_trace = header.port == port::trace || header.port == port::trace_reply;
  if (header.type == package_type::direct && header.seqlen == 0 && is_trace) {
    on_trace(header, data);
    return;
  }
  if (header.type == package_type::direct && !mine) {
    if (header.seqlen == 0 && header.port == port::host_query && answer_query(from, header, data))
      return;
  } else {
    serve(from, header, data, now);
  }
  if (header.type != package_type::link && !mine && !intercepts(header, data))
    forward(from, header, data);
}

void p2p::on_fragment(link_id from, const package_header& header, byte_view data, instant now) {
  auto whole = assembly_.add(header, data, now, from);
  if (whole && header.port == port::host_query)
    static_cast<void>(answer_query(from, header, *whole));
  else if (whole)
    events_.push_back(arrived{header.port, header.source, false, from, std::move(*whole)});
}

void p2p::acknowledge(const package_header& header, instant now) {
  const auto full = acknowledger_.add(header.source, header.ack_id, now);
  if (!full.empty())
    send_acknowledgements(header.source, full);
}

void p2p::send_acknowledgements(peer_id to, const std::vector<std::int32_t>& ids) {
  const auto way = any_route_to(to);
  if (!way) {
    ++counters_.no_route;
    return;
  }
  counters_.acks_sent += ids.size();
  ++counters_.ack_packages_sent;
  tell_host(to, *way, lane::acknowledgements, port::acknowledgements, encode_acknowledgement(ids));
}

/// A package of the network's own for the other end of a link.
void p2p::tell_neighbour(connection& to, std::uint16_t port, bytes data) {
  auto content = std::make_shared<const message_octets>(message_octets{std::move(data), {}});
  const auto header = fresh_header(package_type::link, port);
  count_drop(enqueue(to, lane::control, {header, std::move(content), 0}));
}

/// A package of the network's own for one host, which nobody waits for.
void p2p::tell_host(peer_id to, link_id way, lane where, std::uint16_t port, bytes data) {
  auto content = std::make_shared<const message_octets>(message_octets{std::move(data), {}});
  auto header = fresh_header(package_type::direct, port);
  header.destination = to;
  count_drop(enqueue(connections_.at(way), where, {header, std::move(content), 0}));
}

void p2p::on_acknowledgement(byte_view data) {
  const auto ids = decode_acknowledgement(data);
  if (!ids) {
    ++counters_.malformed;
    return;
  }
  std::optional<peer_id> opened;
  for (const auto id : *ids) {
    auto done = delivery_.acknowledge(id);
    if (!done)
      continue;
    ++counters_.acks_received;
    if (opened && *opened != done->destination)
      pump(*opened);
    opened = done->destination;
    if (done->finished) {
      ++counters_.messages_delivered;
      on_message_ended(*done->finished);
      if (done->finished->request != no_request)
        events_.push_back(delivered{done->finished->request});
    }
  }
  if (opened)
    pump(*opened);
}

/// A package for us, for the neighbours of its sender, or for everybody.
void p2p::serve(link_id from, const package_header& header, byte_view data, instant now) {
  switch (header.port) {
  case port::routing:
    if (header.type == package_type::link)
      on_routing(from, data, now);
    else
      ++counters_.malformed;
    return;
  case port::trace: // a direct one has been handled
  case port::trace_reply:
    ++counters_.malformed;
    return;
  case port::heartbeat:
    if (header.type == package_type::link)
      on_heartbeat(connections_.at(from), data, now);
    else
      ++counters_.malformed;
    return;
  case port::clock:
    on_clock(from, header, data, now);
    return;
  case port::acknowledgements:
    on_acknowledgement(data);
    return;
  case port::host_query:
    static_cast<void>(answer_query(from, header, data));
    return;
  case port::host_record:
    on_host_record(from, header, data, now);
    return;
  case port::dead_host:
    on_dead_host(header, data, now);
    return;
  }
  if (header.type != package_type::link)
    events_.push_back(arrived{header.port, header.source, header.type == package_type::broadcast,
                              from, to_bytes(data)});
}

void p2p::forward(link_id from, package_header header, byte_view data) {
  if (header.hops >= hops_max) {
    ++counters_.hops;
    return;
  }
  ++header.hops;
  const bool timed =
      header.type == package_type::broadcast && header.port == port::clock && measures_way(header);
  auto content = std::make_shared<const message_octets>(
      message_octets{timed ? clock_after(from, data) : to_bytes(data), {}});
  if (header.type == package_type::broadcast) {
    ++counters_.packages_forwarded;
    flood(header, content, from);
    return;
  }
  const auto way = any_route_to(header.destination);
  if (!way) {
    ++counters_.no_route;
    rubicon::note_loss(loss::gateway_stopped);
    return;
  }
  ++counters_.packages_forwarded;
  const outgoing_package next{header, std::move(content), 0};
  traffic_.count(next);
  count_drop(enqueue(connections_.at(*way), lane_of(header), next));
}

package_header p2p::fresh_header(package_type type, std::uint16_t port) {
  package_header header;
  header.id = header.ack_id = ids_.next();
  header.type = type;
  header.source = self_.id;
  header.port = port;
  return header;
}

cause p2p::enqueue(connection& to, lane where, outgoing_package x) {
  const auto origin = serving_.value_or(own_origin);
  const auto verdict = to.queue.admission(where, 1, header_size + x.length(), origin, rng_);
  if (verdict == cause::none)
    to.queue.push(where, std::move(x), origin);
  return verdict;
}

void p2p::count_drop(cause why) {
  if (why != cause::none)
    rubicon::note_loss(why == cause::no_route ? loss::gateway_stopped : loss::package_lost);
  if (why == cause::queue_full)
    ++counters_.queue_full;
  else if (why == cause::early_drop)
    ++counters_.early_drop;
}

/// To every open link but one, or to those that want all and some others at random. Services
/// of the kernel go before those of users.
cause p2p::flood(const package_header& header, const std::shared_ptr<const message_octets>& content,
                 std::optional<link_id> except) {
  const auto where = header.port < port::user_first ? lane::high : lane::normal;
  std::vector<connection*> chosen;
  std::vector<connection*> others;
  for (auto& [link, x] : connections_) {
    if (x.open && link != except)
      (config_.broadcast_fanout == 0 || x.always() ? chosen : others).push_back(&x);
  }
  for (unsigned i = 0; i < config_.broadcast_fanout && !others.empty(); ++i) {
    const auto lot = others.begin() + static_cast<std::ptrdiff_t>(rng_.below(others.size()));
    chosen.push_back(*lot);
    others.erase(lot);
  }
  work_.add(chosen.size() * (1 + content->size() / octets_per_work));
  cause worst = cause::none;
  for (auto* x : chosen) {
    const auto verdict = enqueue(*x, where, {header, content, 0});
    count_drop(verdict);
    worst = verdict == cause::none ? worst : verdict;
  }
  return worst;
}

cause p2p::broadcast(std::uint16_t port, payload octets) {
  if (octets.size() > data_max)
    return cause::too_long;
  if (left_)
    return cause::left;
  auto content = std::make_shared<const message_octets>(message_octets{std::move(octets), {}});
  return flood(fresh_header(package_type::broadcast, port), content, {});
}

std::optional<link_id> p2p::way_to(peer_id destination) const {
  const auto direct = neighbours_.find(destination);
  return direct != neighbours_.end() ? direct->second : routing_.way_to(destination);
}

/// The way, or where the peer was last heard: an answer does not wait for routes to somebody who
/// has just come (P2P-09).
std::optional<link_id> p2p::any_route_to(peer_id destination) const {
  if (const auto way = way_to(destination))
    return way;
  const auto heard = heard_over_.find(destination);
  return heard == heard_over_.end() ? std::nullopt : std::optional(heard->second);
}

void p2p::send(posting x) {
  const auto way = any_route_to(x.destination);
  auto why = cause::none;
  if (left_)
    why = cause::left;
  else if (x.content.size() > fragments_max * data_max)
    why = cause::too_long;
  else if (!way)
    why = cause::no_route;
  else if (!x.reliable)
    why = send_unreliable(x, *way);
  if (why == cause::none && !x.reliable && x.id != no_request)
    events_.push_back(delivered{x.id});
  if (why == cause::none && x.reliable) {
    const auto destination = x.destination;
    const auto service = x.content.size() > data_max ? priority::bulk : x.class_of_service;
    const auto head = x.content.head;
    if (delivery_.add({self_.id, destination, x.port, service, x.id,
                       std::make_shared<const message_octets>(std::move(x.content)),
                       x.for_neighbour},
                      ids_)) {
      if (x.for_neighbour) {
        ++answers_open_;
        ++answers_[*x.for_neighbour];
      }
      pump(destination);
      return;
    }
    x.content.head = head;
    why = cause::queue_full;
  }
  if (why != cause::none) {
    count_drop(why);
    events_.push_back(undelivered{x.id, x.destination, x.port, x.content.head, why});
  }
}

/// All of its packages are queued, or none.
cause p2p::send_unreliable(const posting& x, link_id way) {
  auto& queue = connections_.at(way).queue;
  const auto size = x.content.size();
  const auto count = std::max<std::size_t>(1, (size + data_max - 1) / data_max);
  const auto where = count > 1 ? lane::bulk
                               : static_cast<lane>(static_cast<std::size_t>(lane::high) +
                                                   static_cast<std::size_t>(x.class_of_service));
  if (const auto verdict = queue.admission(where, count, size + count * header_size,
                                           serving_.value_or(own_origin), rng_);
      verdict != cause::none)
    return verdict;
  const auto content = std::make_shared<const message_octets>(x.content);
  const auto seqid = ids_.next_group();
  for (std::size_t i = 0; i < count; ++i) {
    auto header = fresh_header(package_type::direct, x.port);
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
    queue.push(where, next, serving_.value_or(own_origin));
  }
  return cause::none;
}

/// Queues what the window to a destination and the queue on its way have room for.
void p2p::pump(peer_id destination) {
  const auto way = any_route_to(destination);
  if (!way) {
    if (delivery_.only_waiting(destination)) {
      for (const auto& x : delivery_.fail_all(destination))
        fail(x, cause::no_route);
    } else if (delivery_.waits_anew(destination)) {
      stalled_.insert(destination); // until there is a way, or the host is given up
    }
    return;
  }
  auto& link = connections_.at(*way);
  auto& queue = link.queue;
  const bool wide = link.neighbour == destination && link.beat.has_value();
  while (const auto where = delivery_.next_lane(destination, wide)) {
    if (!queue.has_room(*where)) {
      stalled_.insert(destination);
      return;
    }
    auto x = delivery_.next(destination, ids_, wide);
    traffic_.count(x->second);
    queue.push(x->first, std::move(x->second));
  }
}

void p2p::repeat_due(instant now) {
  while (auto due = delivery_.take_due(now, ids_)) {
    const auto way = any_route_to(due->destination);
    if (due->failed) {
      fail(*due->failed, way ? cause::too_many_retries : cause::connection_dead);
      pump(due->destination);
    } else if (!way || enqueue(connections_.at(*way), lane::acknowledgements,
                               std::move(*due->again)) != cause::none) {
      delivery_.on_unsendable(due->ack_id, now);
    } else {
      ++counters_.retransmissions;
    }
  }
}

void p2p::begin_anew(const std::set<peer_id>& destinations) {
  for (const auto destination : destinations) {
    auto outcome = delivery_.begin_anew(destination, ids_);
    counters_.messages_begun_anew += outcome.begun;
    for (const auto& x : outcome.failed)
      fail(x, cause::too_many_retries);
    stalled_.insert(destination); // flush() goes on with it
  }
}

void p2p::fail(const reliable_message& x, cause why) {
  ++counters_.messages_failed;
  on_message_ended(x);
  events_.push_back(undelivered{x.request, x.destination, x.port, x.content->head, why});
}

} // namespace rubicon::peis
