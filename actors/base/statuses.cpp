#include "actors/base/statuses.hpp"

#include "actors/messages/supervision.hpp"

namespace rubicon {

namespace {

/// What a mote and a sink have in common.
packet_losses losses_of(const mote::packet_service& x) {
  const auto& router = x.router();
  const auto& packets = router.packets().counters();
  const auto& paths = router.paths().counters();
  packet_losses lost;
  lost.channel_lost = paths.packets_lost;
  lost.channel_no_room = paths.refused;
  lost.channel_strays = paths.strays;
  lost.gave_up = packets.gave_up;
  lost.malformed = packets.malformed + paths.malformed + router.counters().malformed +
                   router.counters().unknown_type + x.counters().malformed;
  lost.no_route = packets.no_route + x.counters().unroutable;
  lost.queue_full = packets.queue_full;
  lost.too_far = packets.too_far;
  return lost;
}

/// The same, without what is lost.
network_status status_of(mote_address address, const mote::packet_service& x, instant own,
                         instant now) {
  const auto& router = x.router();
  const auto& packets = router.packets().counters();
  const auto& paths = router.paths().counters();
  network_status status;
  status.address = address;
  status.has_clock = router.clock().synchronised();
  if (status.has_clock) {
    const auto real = std::chrono::floor<island_clock::duration>(now.time_since_epoch());
    status.clock_ahead_us = (router.clock().at(own).time_since_epoch() - real).count();
    status.clock_doubt_us = router.clock().doubt(own).count();
  }
  if (const auto network = router.clock().network_time(own)) {
    status.has_network_time = true;
    status.network_ahead_us = (*network - now.time_since_epoch()) / 1us;
  }
  status.channels = router.paths().table();
  auto& r = status.network;
  r.beacons = router.counters().beacons;
  r.packets = packets.originated;
  r.arrived = packets.arrived;
  r.forwarded = packets.forwarded;
  r.repeated = packets.repeated;
  r.channels_asked = paths.connects;
  r.channels_opened = paths.connected;
  r.channels_flooded = paths.floods;
  r.channels_broken = paths.broken;
  report::add_counters<network::channels_counters>(r.counters, "channels", paths);
  report::add_counters<network::coordinates_counters>(r.counters, "coordinates",
                                                      router.place().counters());
  report::add_counters<network::neighbours_counters>(r.counters, "neighbours",
                                                     router.links().counters());
  report::add_counters<network::collection_counters>(r.counters, "packets", packets);
  report::add_counters<mote::packet_service_counters>(r.counters, "packet_service", x.counters());
  report::add_counters<network::router_counters>(r.counters, "router", router.counters());
  report::add_counters<network::gradient_counters>(r.counters, "tree", router.tree().counters());
  return status;
}

} // namespace

report::radio_report report_of(const radio::radio_counters& x) {
  report::radio_report r;
  r.sent = x.copies.sent;
  r.delivered = x.copies.of(radio::copy_outcome::delivered);
  for (std::size_t i = 0; i < radio::copy_outcomes; ++i) {
    const auto outcome = static_cast<radio::copy_outcome>(i);
    if (outcome != radio::copy_outcome::delivered)
      r.lost[radio::to_string(outcome)] = x.copies.of(outcome);
  }
  r.requests = x.requests.requests;
  r.mac_sent = x.requests.sent;
  for_each_field(x.requests.failed, [&r](std::string_view cause, std::uint64_t count) {
    r.mac_failed[std::string(cause)] = count;
  });
  r.mac_open = x.requests.open;
  r.transmissions = x.transmissions;
  r.acks = x.acks;
  r.acks_received = x.acks_received;
  return r;
}

report::message_report report_of(const transport::messenger_counters& x,
                                 const communication::layer_counters& offers, std::size_t open,
                                 bool ended) {
  report::message_report r;
  r.offered = offers.offered;
  r.refused = {{"not_joined", offers.unjoined},
               {"no_such_receiver", offers.misaddressed},
               {"crowded", x.refused_crowded},
               {"too_long", x.refused - x.refused_crowded}};
  r.reliable_sent = x.reliable_sent;
  r.reliable_acked = x.reliable_acked;
  r.reliable_failed = x.reliable_failed + (ended ? open : 0);
  r.reliable_open = ended ? 0 : open;
  r.unreliable_sent = x.unreliable_sent;
  r.received = x.received;
  r.duplicates = x.duplicates;
  return r;
}

void add_layer(report::cause_counts& to, const communication::layer_totals& x) {
  report::add_counters<communication::layer_counters>(to, "layer", x.layer);
  report::add_counters<stream::streams_counters>(to, "streams", x.streams);
  report::add_counters<synaptic::channels_counters>(to, "synaptic", x.synaptic);
  report::add_counters<transport::messenger_counters>(to, "transport", x.transport);
  report::add_counters<transport::tunnels_counters>(to, "tunnels", x.tunnels);
}

message_status messages_of(mote_address who, const communication::layer& x, bool ended) {
  const auto& messages = x.ports().messages.core();
  message_status status;
  status.who = who;
  status.messages = report_of(messages.counters(), x.counters(), messages.outstanding(), ended);
  return status;
}

packet_losses losses_of(const mote::node& x) {
  const auto& above = x.above().counters();
  auto lost = losses_of(x.packets());
  lost.channel_full = x.counters().channel_full;
  lost.malformed += x.counters().malformed + above.malformed;
  lost.misdirected = x.counters().misdirected;
  lost.paced_out = x.counters().paced_out;
  lost.unclaimed = above.unclaimed;
  lost.unknown_channel = above.unknown_channel;
  lost.unowned = above.unowned;
  return lost;
}

packet_losses losses_of(const mote::sink& x) {
  auto lost = losses_of(x.packets());
  lost.id_taken = x.joining().doubles;
  lost.malformed += x.counters().malformed + x.counters().unknown_type;
  lost.unowned = x.counters().for_sink;
  return lost;
}

network_status status_of(mote_address address, const mote::node& x, instant own, instant now) {
  auto status = status_of(address, x.packets(), own, now);
  auto& r = status.network;
  r.synchronised = status.has_clock ? 1 : 0;
  r.aligned = status.has_network_time ? 1 : 0;
  const auto& router = x.packets().router();
  if (router.tree().has_route()) {
    r.hops_max = router.tree().hops();
    status.hops = router.tree().hops();
    status.parent = router.tree().parent();
  }
  r.state_octets = x.footprint();
  r.lost = lost_of(losses_of(x));
  report::add_counters<mote::node_counters>(r.counters, "node", x.counters());
  add_layer(r.counters, communication::totals_of(x.above()));
  return status;
}

network_status status_of(mote_address address, const mote::sink& x, instant own, instant now) {
  auto status = status_of(address, x.packets(), own, now);
  status.is_sink = true;
  status.network.lost = lost_of(losses_of(x));
  report::add_counters<mote::registrar_counters>(status.network.counters, "registrar", x.joining());
  report::add_counters<mote::sink_counters>(status.network.counters, "sink", x.counters());
  report::add_counters<network::time_reference_counters>(status.network.counters, "time",
                                                         x.time().counters());
  report::add_counters<mote::slot_table_counters>(status.network.counters, "slots",
                                                  x.slots().counters());
  return status;
}

} // namespace rubicon
