#include "peis/hosts/route_tracer.hpp"

#include <memory>
#include <utility>
#include <variant>

#include "peis/wire/trace.hpp"

namespace rubicon::peis {

namespace {

constexpr duration trace_timeout = 5s;

} // namespace

route_tracer::route_tracer(own_peer& own, link_table& links, overlay& routes,
                           package_sender& sender)
    : own_(own), links_(links), overlay_(routes), sender_(sender),
      probes_(own.config.tables.probes, own.config.probe_timeout) {}

/// Each attempt takes another way: one of them may have lost it.
void route_tracer::send(peer_id destination, std::size_t attempt) {
  const auto hops = overlay_.hops_to(destination);
  if (!hops.empty())
    sender_.send_to_host(destination, hops[attempt % hops.size()], lane::high, port::trace,
                         encode(trace_message{{own_.self.id}}), own_origin);
}

void route_tracer::trace(peer_id destination, request_id id, instant now) {
  traces_.push_back({destination, id, now + trace_timeout});
  send(destination, 0);
}

void route_tracer::end_late_traces(const occasion& x) {
  std::erase_if(traces_, [&](const open_trace& each) {
    if (each.deadline > x.now)
      return false;
    x.out.push_back(traced{each.id, each.destination, {}});
    return true;
  });
}

void route_tracer::probe_unsound(instant now) {
  for (const auto host : overlay_.routes().take_unsound()) {
    if (overlay_.reachable(host))
      probes_.begin(host, now);
    else
      probes_.extend(host, now); // what has just come must not end with what was asked before
  }
}

std::vector<way_disproved> route_tracer::probe_due(instant now) {
  std::vector<way_disproved> silent;
  for (const auto& each : probes_.on_time(now)) {
    if (const auto* next = std::get_if<probe_host>(&each))
      send(next->host, next->attempt);
    else
      silent.push_back(std::get<way_disproved>(each));
  }
  return silent;
}

/// Everybody who sees a trace adds itself. One that passes goes on as a package of its own; the
/// destination sends it back as a reply.
void route_tracer::on_trace(const package_header& header, byte_view data, const occasion& x) {
  auto message = decode_trace(data);
  if (!message) {
    ++own_.counters.malformed;
    return;
  }
  const bool mine = header.destination == own_.self.id;
  if (mine && header.port == port::trace_reply) {
    message->hosts.push_back(own_.self.id);
    // The message names no question: it answers all that were asked about its source.
    std::erase_if(traces_, [&](const open_trace& each) {
      if (each.destination != header.source)
        return false;
      x.out.push_back(traced{each.id, each.destination, message->hosts});
      return true;
    });
    return;
  }
  const auto destination = mine ? header.source : header.destination;
  const auto hop = overlay_.any_hop(destination);
  if (!hop || message->hosts.size() >= trace_hosts_max) {
    ++(hop ? own_.counters.hops : own_.counters.no_route);
    return;
  }
  message->hosts.push_back(own_.self.id);
  auto content = std::make_shared<const message_octets>(message_octets{encode(*message), {}});
  auto next = own_.fresh_header(package_type::direct, mine ? port::trace_reply : header.port);
  next.destination = destination;
  if (!mine) {
    next.source = header.source;
    next.hops = 2;
  }
  sender_.send(links_.at(*hop), lane::high, {next, std::move(content), 0}, x.origin);
}

std::optional<instant> route_tracer::deadline() const {
  auto next = probes_.deadline();
  for (const auto& x : traces_)
    next = earliest(next, x.deadline);
  return next;
}

} // namespace rubicon::peis
