#include "peis/p2p/package_handler.hpp"

#include <memory>
#include <utility>

#include "core/account/message_ledger.hpp"

namespace rubicon::peis {

namespace {

/// The class in which a package of another host goes on.
lane lane_of(const package_header& header) {
  if (header.port == port::acknowledgements)
    return lane::acknowledgements;
  if ((header.flags & package_flag::high) != 0)
    return lane::high;
  return (header.flags & package_flag::bulk) != 0 ? lane::bulk : lane::normal;
}

} // namespace

/// The steps of peis-wire.md 7, in its order.
void package_handler::on_package(link_id from, const package_header& header, byte_view data,
                                 const occasion& x) {
  auto& counters = to_.own.counters;
  ++counters.packages_received;
  if (!is_legal(header)) {
    ++counters.illegal;
    return;
  }
  if (header.source == to_.own.self.id) {
    ++counters.own;
    to_.duplicates.on_package(from, header, data, x);
    return;
  }
  if (to_.guard.is_impersonation(from, header, x.now)) {
    ++counters.claims_refused; // before it counts as seen: the true one may still come
    return;
  }
  if (!is_new(from, header, x))
    return;
  const bool direct = header.type == package_type::direct;
  const bool mine = direct && header.destination == to_.own.self.id;
  if (mine && header.seqlen > 0) {
    on_fragment(from, header, data, x);
    return;
  }
  const bool is_trace = header.port == port::trace || header.port == port::trace_reply;
  if (direct && header.seqlen == 0 && is_trace) {
    to_.tracer.on_trace(header, data, x);
    return;
  }
  if (!direct || mine)
    serve(from, header, data, x);
  else if (header.seqlen == 0 && header.port == port::host_query &&
           to_.inquiry.answer(from, header, data, x.out))
    return;
  if (header.type != package_type::link && !mine && !is_consumed(header, data, x.out))
    forward(from, header, data);
}

/// Acknowledges what asks for it, even if it has come before.
bool package_handler::is_new(link_id from, const package_header& header, const occasion& x) {
  auto& counters = to_.own.counters;
  to_.tracer.end_probe(header.source);
  to_.updates.on_sign_of_life(header.source, x);
  if (!to_.seen.insert(header.source, header.id, from)) {
    ++counters.seen;
    return false;
  }
  if (header.type == package_type::direct)
    to_.routes.note_source(header.source, from);
  const bool mine = header.type == package_type::direct && header.destination == to_.own.self.id;
  if (!mine)
    return true;
  if (header.seqlen > 0 && !to_.messages.accepts(header, from)) {
    ++counters.fragments_refused; // not acknowledged: it comes again
    return false;
  }
  if (header.reliable() && header.port != port::acknowledgements)
    to_.messages.acknowledge(header, x.origin, x.now);
  if (header.ack_id != header.id && header.ack_id != 0 &&
      !to_.seen.insert(header.source, header.ack_id, from)) {
    ++counters.repeated;
    return false;
  }
  return true;
}

void package_handler::on_fragment(link_id from, const package_header& header, byte_view data,
                                  const occasion& x) {
  auto whole = to_.messages.add(header, data, from, x.now);
  if (whole && header.port == port::host_query)
    static_cast<void>(to_.inquiry.answer(from, header, *whole, x.out));
  else if (whole)
    x.out.push_back(arrived{header.port, header.source, false, from, std::move(*whole)});
}

/// A package for us, for the neighbours of its sender, or for all hosts.
void package_handler::serve(link_id from, const package_header& header, byte_view data,
                            const occasion& x) {
  switch (header.port) {
  case port::routing:
  case port::heartbeat:
    serve_neighbour(from, header, data, x);
    return;
  case port::trace: // a direct one has been handled
  case port::trace_reply:
    ++to_.own.counters.malformed;
    return;
  case port::clock:
    to_.clock.on_message(from, header, data, x.now);
    return;
  case port::acknowledgements:
    to_.messages.on_acknowledgement(data, x.out);
    return;
  case port::host_query:
    static_cast<void>(to_.inquiry.answer(from, header, data, x.out));
    return;
  case port::host_record:
    to_.names.on_record(from, header, data, x);
    return;
  case port::dead_host:
    to_.records.on_dead_host(header, data, x);
    return;
  }
  if (header.type != package_type::link)
    x.out.push_back(arrived{header.port, header.source, header.type == package_type::broadcast,
                            from, to_bytes(data)});
}

void package_handler::serve_neighbour(link_id from, const package_header& header, byte_view data,
                                      const occasion& x) {
  if (header.type != package_type::link)
    ++to_.own.counters.malformed;
  else if (header.port == port::routing)
    to_.updates.on_page(from, data, x);
  else
    to_.beats.on_heartbeat(to_.links.at(from), data, x.now);
}

bool package_handler::is_consumed(const package_header& header, byte_view data, events& out) {
  if (!to_.hooks.consume(header, data, out))
    return false;
  ++to_.own.counters.intercepted;
  return true;
}

void package_handler::forward(link_id from, package_header header, byte_view data) {
  auto& counters = to_.own.counters;
  if (header.hops >= hops_max) {
    ++counters.hops;
    return;
  }
  ++header.hops;
  auto content = std::make_shared<const message_octets>(
      message_octets{to_.clock.relayed(from, header, data), {}});
  if (header.type == package_type::broadcast) {
    ++counters.packages_forwarded;
    to_.sender.flood(header, content, from, from);
    return;
  }
  const auto hop = to_.routes.any_hop(header.destination);
  if (!hop) {
    ++counters.no_route;
    rubicon::note_loss(loss::gateway_stopped);
    return;
  }
  ++counters.packages_forwarded;
  const outgoing_package next{header, std::move(content), 0};
  to_.traffic.count(next);
  to_.sender.send(to_.links.at(*hop), lane_of(header), next, from);
}

} // namespace rubicon::peis
