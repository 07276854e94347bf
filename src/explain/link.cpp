#include <algorithm>

#include "explain/media.hpp"

namespace rubicon::explain {

namespace {

/// Of messages between gateways and PCs (D1.1 5.4).
constexpr std::uint16_t island_message_port = 21;

} // namespace

void link_follower::on_package(const record& r) {
  const auto x = package_of(r.octets);
  const auto what = x ? recognise(*x, r) : std::nullopt;
  if (!what)
    return;
  auto to = r.to;
  if (to.empty()) // the record of a loss names only the sender
    for (const auto& end : ends_[r.id])
      if (end != r.from)
        to = end;
  const bool is_lost = r.what == kind::link_lost || r.unheard;
  const auto hop = all_.hop_for({*what, medium::peis, r.from, to, x->header.destination,
                                 std::max<std::uint32_t>(1, x->header.seqlen)},
                                r.cause, r);
  all_.at(hop).attempts.push_back({r.time,
                                   !is_lost               ? "delivered"
                                   : r.unheard            ? "the peer had ended"
                                   : r.text == "link_cut" ? "the link was cut"
                                                          : "lost on the link",
                                   !is_lost});
  if (is_lost)
    return;
  all_.arrive(hop, x->header.seqnum, to, r);
  const auto about = what->about;
  if (about.is_tuple && x->header.port == peis::port::set && all_.at(hop).arrived &&
      all_.all.known.peer_of(to) == all_.all.tuples[about.index].owner)
    all_.stands_for(r.number, tuples_.reach_owner(about.index, to, hop, r.time));
}

std::optional<sighting> link_follower::recognise(const carried_package& x, const record& r) {
  const auto& header = x.header;
  const bool is_first = header.seqnum == 0;
  if (header.port == peis::port::push || header.port == peis::port::set)
    return tuples_.recognise(is_first ? tuple_of(x) : std::nullopt, r.cause, r);
  if (header.port != island_message_port)
    return std::nullopt;
  if (!is_first)
    return messages_.recognise_rest(r.cause);
  const auto packet = envelope_of(x.data, all_.all.known.speaks_for(header.source),
                                  all_.all.known.speaks_for(header.destination));
  return packet ? messages_.recognise(*packet, r.cause, r) : std::nullopt;
}

// ------------------------------------------------------------------------------------- components

void link_follower::on_asked(const record& r, const sighting& what) {
  requests_[r.number] = {what, peer_id(r.peer)};
}

/// A component's message for another peer; a failure is reported later.
void link_follower::on_send(const record& r) {
  const auto here = all_.all.known.peer_of(r.to);
  const auto packet = here && r.channel == island_message_port
                          ? envelope_of(r.octets, all_.all.known.speaks_for(*here),
                                        all_.all.known.speaks_for(peer_id(r.peer)))
                          : std::nullopt;
  if (const auto what = packet ? messages_.recognise(*packet, r.cause, r) : std::nullopt)
    on_asked(r, *what);
}

void link_follower::on_outcome(const record& r) {
  const auto open = requests_.extract(r.cause);
  if (open.empty() || r.yes)
    return;
  const auto& [what, to] = open.mapped();
  const auto path = names::kernel_path(all_.all.known.of(to));
  const auto& nodes = what.about.is_tuple ? all_.all.tuples[what.about.index].nodes
                                          : all_.all.messages[what.about.index].nodes;
  const bool got_there = std::ranges::any_of(nodes, [&](node_index n) {
    const auto& x = all_.at(n);
    return x.over == medium::peis && x.of == what.of && x.to == path && x.arrived;
  });
  if (got_there) // its acknowledgement did not
    return;
  const auto hop = all_.hop_for({what, medium::peis, r.from, path, to}, r.cause, r);
  all_.at(hop).failure = r.text;
}

} // namespace rubicon::explain
