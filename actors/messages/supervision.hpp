// The root supervisor: what it is told of all others, and its own plan.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "actors/messages/common.hpp"
#include "apps/streams/stream_end.hpp"
#include "core/address.hpp"
#include "mote/nonvolatile.hpp"
#include "network/channels/channel_message.hpp"
#include "network/sink_event.hpp"
#include "report/report.hpp"
#include "traffic/part.hpp"

namespace rubicon {

/// A mote's battery is at its end, by its use or by the fault plan; it is gone for good.
struct mote_flat {
  mote_address mote;
};
RUBICON_FIELDS(mote_flat, mote);

/// What a mote or sink has written to its flash: it is handed it back when it starts again.
struct store_written {
  mote_address mote;
  mote::nonvolatile content;
};
RUBICON_FIELDS(store_written, mote, content);

/// A gateway lists a mote, or no longer does.
struct listing_changed {
  mote_address mote;
  bool listed = false;
  std::uint32_t incarnation = 0;
  network::leave_cause cause = network::leave_cause::notice;
};
RUBICON_FIELDS(listing_changed, mote, listed, incarnation, cause);

/// Of one island's radios: copies and requests.
struct radio_status {
  island_id island;
  report::radio_report radio;
};
RUBICON_FIELDS(radio_status, island, radio);

/// What one mote knows about the flows of measuring packets it has a hand in.
struct flow_status {
  std::vector<traffic::part> parts;
};
RUBICON_FIELDS(flow_status, parts);

/// Energy of one mote, as its radio and MCU have used it.
struct energy_status {
  mote_address mote;
  report::energy_report energy;
};
RUBICON_FIELDS(energy_status, mote, energy);

/// A mote is carried to another air: its radio here is off for good. What it has used so far.
struct radio_left {
  energy_status used;
};
RUBICON_FIELDS(radio_left, used);

/// What the Transport of a mote, gateway or PC has counted, in one life.
struct message_status {
  mote_address who;   ///< no_mote in the mote part: a gateway or PC
  bool is_pc = false; ///< and no gateway
  report::message_report messages;
};
RUBICON_FIELDS(message_status, who, is_pc, messages);

/// What a mote's or sink's Network has counted.
struct network_status {
  mote_address address;
  bool is_sink = false;
  bool has_clock = false;            ///< it knows the island's time
  std::int64_t clock_ahead_us = 0;   ///< island time minus real time
  std::int64_t clock_doubt_us = 0;   ///< how far off it says that it may be
  bool has_network_time = false;     ///< it knows the time that peers share (CLK-08)
  std::int64_t network_ahead_us = 0; ///< network time, as it knows it, minus real time
  report::network_report network;
  mote_id parent;                            ///< in the tree; 0: none
  std::uint8_t hops = 0;                     ///< to the sink
  bool has_signal = false;                   ///< a frame of its parent has come,
  std::vector<network::channel_id> channels; ///< that begin, pass or end here
  std::int16_t signal_dbm = 0;               ///< the newest so strong
};
RUBICON_FIELDS(network_status, address, is_sink, has_clock, clock_ahead_us, clock_doubt_us,
               has_network_time, network_ahead_us, network, parent, hops, has_signal, channels,
               signal_dbm);

/// What SMEPP Light of a mote has counted, in one life.
struct smepp_status {
  island_id island;
  report::smepp_report smepp;
};
RUBICON_FIELDS(smepp_status, island, smepp);

/// What a sink, a serial line or a gateway's serial port has counted.
struct serial_status {
  island_id island;
  report::serial_report serial;
};
RUBICON_FIELDS(serial_status, island, serial);

/// What a backbone has carried and lost.
struct backbone_status {
  island_id island;
  report::backbone_report backbone;
};
RUBICON_FIELDS(backbone_status, island, backbone);

/// What the gateway's end of a line to real motes has counted.
struct real_line_status {
  island_id island;
  report::real_line_report real;
};
RUBICON_FIELDS(real_line_status, island, real);

struct devices_status {
  island_id island;
  std::vector<mote_id> listed;
  bool has_clock = false;  ///< its kernel has told the network time,
  duration clock_offset{}; ///< which is so much ahead of ecology time
};
RUBICON_FIELDS(devices_status, island, listed, has_clock, clock_offset);

/// How one of several gateways of an island has fared, in one life (GW-14).
struct gateway_status {
  island_id island;
  peer_id gateway;
  std::string name;
  report::lead_report lead;
};
RUBICON_FIELDS(gateway_status, island, gateway, name, lead);

struct peer_status {
  report::peer_report peer;
  std::vector<peer_id> hosts;      ///< known ones, itself included
  std::vector<peer_id> neighbours; ///< at the other ends of its links
  duration clock_offset{};         ///< network time, as it knows it, minus ecology time
};
RUBICON_FIELDS(peer_status, peer, hosts, neighbours, clock_offset);

struct proxy_status {
  report::proxy_report proxy; ///< of one life
  bool ended = false;         ///< which is over
};
RUBICON_FIELDS(proxy_status, proxy, ended);

/// What a program on a mote or PC has counted, in one life.
struct program_status {
  report::program_report program;
  std::uint32_t number = 0;          ///< among the programs of its node
  std::vector<std::string> measured; ///< figures that cannot be added to those of earlier lives
  std::vector<apps::stream_end> streams;
};
RUBICON_FIELDS(program_status, program, number, measured, streams);

/// What a module of a gateway or PC has counted, in one life.
struct module_status {
  std::string peer; ///< its name
  report::cause_counts counters;
};
RUBICON_FIELDS(module_status, peer, counters);

/// Answers a status_request for a sample.
struct sample_status {
  std::uint64_t sample = 0;
  std::string who; ///< a node as the report calls it
  bool has_address = false;
  mote_address address; ///< of a mote or sink, which has a clock to tell of
  bool is_sink = false;
  bool has_clock = false;
  std::int64_t clock_ahead_us = 0; ///< island time minus real time
  /// Vectors that programs have missed, by their number.
  std::vector<std::pair<std::uint32_t, std::uint64_t>> missed;
};
RUBICON_FIELDS(sample_status, sample, who, has_address, address, is_sink, has_clock, clock_ahead_us,
               missed);

/// From an init: the process of a peer of its host is to start. component_started follows, and
/// component_ended when it has ended, by whatever cause.
struct start_component {
  std::string peer;
  std::uint64_t life = 0; ///< the init's name for this life of it
};
RUBICON_FIELDS(start_component, peer, life);

/// From an init: the process is to end, in good order as by SIGINT and SIGTERM, or at once as by
/// SIGKILL.
struct stop_component {
  std::string peer;
  bool at_once = false;
};
RUBICON_FIELDS(stop_component, peer, at_once);

/// From a peer: a link to another process has opened or closed.
struct outside_link_changed {};
RUBICON_FIELDS(outside_link_changed);

/// From a kernel: its tuple `rubicon.debug` says whose messages the debug log is to have.
struct debug_wanted {
  std::string who; ///< actor path
  std::string text;
};
RUBICON_FIELDS(debug_wanted, who, text);

/// The root supervisor, as those below it see it.
struct ecology_interface
    : takes<notable_event, mote_flat, listing_changed, radio_status, energy_status, flow_status,
            message_status, network_status, smepp_status, serial_status, backbone_status,
            real_line_status, devices_status, gateway_status, peer_status, proxy_status,
            program_status, module_status, sample_status, start_component, stop_component,
            actor_failed, request_unmet, store_written, radio_left, outside_link_changed,
            debug_wanted> {};
using ecology_actor = ref<ecology_interface>;

/// To itself: this fault of the description's plan is due.
struct apply_fault {
  std::uint32_t index = 0;
};
RUBICON_FIELDS(apply_fault, index);

/// To itself: a mote that failed starts again.
struct restart_mote {
  mote_address mote;
};
RUBICON_FIELDS(restart_mote, mote);

/// To itself: a sink starts again.
struct restart_sink {
  island_id island;
};
RUBICON_FIELDS(restart_sink, island);

/// To itself: what this fault of the description's plan has begun is over.
struct end_fault {
  std::uint32_t index = 0;
};
RUBICON_FIELDS(end_fault, index);

/// To itself: a program of that mote, in an actor of its own, starts again after a failure.
struct restart_program {
  mote_address mote;
  std::uint32_t number = 0;
};
RUBICON_FIELDS(restart_program, mote, number);

/// To itself: a peer that was ended starts again, or a second one with its id ends.
struct restart_peer {
  std::string name;
};
RUBICON_FIELDS(restart_peer, name);
struct end_duplicate {
  std::string name;
};
RUBICON_FIELDS(end_duplicate, name);

/// To itself: what is judged in the course of the run is due to be looked at.
struct take_sample {};
RUBICON_FIELDS(take_sample);

/// From whoever runs the ecology: the run is over, everybody leaves in good order.
struct end_run {};
RUBICON_FIELDS(end_run);

/// From whoever runs the ecology: ask everybody for their part of the report.
struct collect_report {};
RUBICON_FIELDS(collect_report);

/// From whoever runs the ecology: hand out the report with the parts that have come.
struct deliver_report {};
RUBICON_FIELDS(deliver_report);

/// The root supervisor itself.
struct root_interface : extends<ecology_interface, apply_fault, end_fault, restart_mote,
                                restart_sink, restart_program, restart_peer, end_duplicate,
                                take_sample, collect_report, deliver_report, end_run> {};
using root_actor = ref<root_interface>;

} // namespace rubicon
