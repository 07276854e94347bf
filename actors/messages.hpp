// Every message between actors and the typed handle of every kind of actor. Read this first: it
// says who talks to whom about what. Nothing else connects actors (design.md section 2).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <caf/typed_actor.hpp>

#include "actors/inspect.hpp"
#include "actors/program_inspect.hpp"
#include "apps/application.hpp"
#include "communication/remote_messages.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/device_keys.hpp"
#include "core/fields.hpp"
#include "core/time.hpp"
#include "device/transducer.hpp"
#include "mote/nonvolatile.hpp"
#include "network/channel_message.hpp"
#include "network/sink_event.hpp"
#include "peis/bluetooth.hpp"
#include "peis/simulated_media.hpp"
#include "proxy/class_change.hpp"
#include "radio/channel.hpp"
#include "report/report.hpp"
#include "scheduler/trace.hpp"
#include "serial/line.hpp"
#include "traffic/part.hpp"

namespace rubicon {

using scheduler::carried;

/// A timer of one actor has run down. `epoch` tells an outdated expiry from the awaited one,
/// `which` tells the timers of one actor apart.
struct timer_expired {
  std::uint8_t which = 0;
  std::uint64_t epoch = 0;
};
RUBICON_FIELDS(timer_expired, which, epoch);

// ---------------------------------------------------------------------------- supervision, report

/// To everybody at the end of a run: report what you know to the ecology. Or, to sinks, motes and
/// programs in between, to tell what is judged in the course of the run (sample_status).
struct status_request {
  std::uint64_t sample = 0; ///< its number; 0: the whole report
};
RUBICON_FIELDS(status_request, sample);

/// Something a person following the run would want to hear.
struct notable_event {
  std::string who; ///< actor path
  std::string what;
};
RUBICON_FIELDS(notable_event, who, what);

/// From a supervisor below the ecology: an actor of its own has failed, whether or not it starts it
/// again.
struct actor_failed {
  std::string who; ///< actor path
  std::string why;
};
RUBICON_FIELDS(actor_failed, who, why);

/// Something that the file asks for cannot be had. It is a violation of the run.
struct request_unmet {
  std::string who;       ///< actor path
  std::string what;      ///< with the reason, and what to do
  bool ends_run = false; ///< nothing of what follows would be what was asked for
};
RUBICON_FIELDS(request_unmet, who, what, ends_run);

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
  /// Unreliable messages that have arrived here, by source.
  std::vector<std::pair<mote_address, std::uint64_t>> arrivals;
};
RUBICON_FIELDS(message_status, who, is_pc, messages, arrivals);

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
using ecology_actor = caf::typed_actor<
    caf::reacts_to<notable_event>, caf::reacts_to<mote_flat>, caf::reacts_to<listing_changed>,
    caf::reacts_to<radio_status>, caf::reacts_to<energy_status>, caf::reacts_to<flow_status>,
    caf::reacts_to<message_status>, caf::reacts_to<network_status>, caf::reacts_to<smepp_status>,
    caf::reacts_to<serial_status>, caf::reacts_to<real_line_status>, caf::reacts_to<devices_status>,
    caf::reacts_to<gateway_status>, caf::reacts_to<peer_status>, caf::reacts_to<proxy_status>,
    caf::reacts_to<program_status>, caf::reacts_to<sample_status>, caf::reacts_to<start_component>,
    caf::reacts_to<stop_component>, caf::reacts_to<actor_failed>, caf::reacts_to<request_unmet>,
    caf::reacts_to<store_written>, caf::reacts_to<radio_left>, caf::reacts_to<outside_link_changed>,
    caf::reacts_to<debug_wanted>>;

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
using root_actor = ecology_actor::extend<
    caf::reacts_to<apply_fault>, caf::reacts_to<end_fault>, caf::reacts_to<restart_mote>,
    caf::reacts_to<restart_sink>, caf::reacts_to<restart_program>, caf::reacts_to<restart_peer>,
    caf::reacts_to<end_duplicate>, caf::reacts_to<take_sample>, caf::reacts_to<collect_report>,
    caf::reacts_to<deliver_report>, caf::reacts_to<end_run>>;

// ------------------------------------------------------------------------------------------ radio

/// A frame that this radio has received.
struct frame_received {
  payload psdu; ///< IEEE 802.15.4, FCS included; one object for all receivers
  std::int8_t rssi_dbm = 0;
};
RUBICON_FIELDS(frame_received, psdu, rssi_dbm);

/// A request to send has come to its end.
struct radio_done {
  std::uint64_t token = 0;
  radio::send_status status = radio::send_status::sent;
  unsigned transmissions = 0;
  bool arrived = false; ///< its destination has it; only a simulated air knows
  radio::copy_outcome last =
      radio::copy_outcome::out_of_reach; ///< of the last copy at its destination
};
RUBICON_FIELDS(radio_done, token, status, transmissions, arrived, last);

/// The battery that feeds this radio is flat; the radio is off.
struct battery_flat {};
RUBICON_FIELDS(battery_flat);

/// It soon will be: radio::battery_reserve of its charge is left.
struct battery_low {};
RUBICON_FIELDS(battery_low);

/// Whoever owns a radio: a mote or a sink.
using radio_user_actor =
    caf::typed_actor<caf::reacts_to<frame_received>, caf::reacts_to<radio_done>,
                     caf::reacts_to<battery_low>, caf::reacts_to<battery_flat>>;

/// From now on this radio's frames are for `user`; switches the radio on.
struct attach_radio {
  radio::radio_index radio;
  carried<radio_user_actor> user;
};
RUBICON_FIELDS(attach_radio, radio, user);

inline constexpr std::uint8_t no_age = 0xff;

struct radio_send {
  radio::radio_index radio;
  std::uint64_t token = 0;
  mote_id destination;
  std::uint8_t am_type = 0;
  payload octets;
  bool ack = true;
  std::uint8_t age_at = no_age; ///< as in radio::request; the next too
  bool in_slot = false;
};
RUBICON_FIELDS(radio_send, radio, token, destination, am_type, octets, ack, age_at, in_slot);

struct radio_power {
  radio::radio_index radio;
  radio::power state = radio::power::off;
};
RUBICON_FIELDS(radio_power, radio, state);

/// The radio is somewhere else from now on.
struct move_radio {
  radio::radio_index radio;
  position place;
};
RUBICON_FIELDS(move_radio, radio, place);

/// From the fault plan: this transmitter, which is no mote's, sends bursts of noise for so long.
struct make_noise {
  radio::radio_index from;
  double duty = 1; ///< share of the time, 0..1
  duration burst{};
  duration length{};
};
RUBICON_FIELDS(make_noise, from, duty, burst, length);

/// From the fault plan: copies for radios of an island are lost by this chance besides, for so
/// long.
struct lose_frames {
  bool everywhere = true;
  island_id island; ///< if not everywhere
  double loss = 0;  ///< 0..1
  duration length{};
};
RUBICON_FIELDS(lose_frames, everywhere, island, loss, length);

/// From the fault plan: the mote of this radio is carried away. radio_left follows.
struct carry_away {
  radio::radio_index radio;
};
RUBICON_FIELDS(carry_away, radio);

/// From the fault plan: a mote whose radio this is has come, with a battery of which so much is
/// used.
struct bring_radio {
  radio::radio_index radio;
  double used_mah = 0;
};
RUBICON_FIELDS(bring_radio, radio, used_mah);

/// From the plan: a link is another from now on. What is not set stays as it is.
struct change_link {
  mote_address from;
  mote_address to;
  std::optional<double> loss; ///< 0..1
  std::optional<double> gain_db;
};
RUBICON_FIELDS(change_link, from, to, loss, gain_db);

/// The radio medium of one place.
using air_actor = caf::typed_actor<
    caf::reacts_to<attach_radio>, caf::reacts_to<radio_send>, caf::reacts_to<radio_power>,
    caf::reacts_to<move_radio>, caf::reacts_to<make_noise>, caf::reacts_to<lose_frames>,
    caf::reacts_to<carry_away>, caf::reacts_to<bring_radio>, caf::reacts_to<change_link>,
    caf::reacts_to<timer_expired>, caf::reacts_to<status_request>>;

// ----------------------------------------------------------------------------------------- serial

/// Octets that have arrived at one end of a serial line.
struct serial_octets {
  payload octets;
};
RUBICON_FIELDS(serial_octets, octets);

/// Whoever sits at an end of a serial line: a sink or a gateway.
using serial_end_actor = caf::typed_actor<caf::reacts_to<serial_octets>>;

/// From now on octets going `towards` that end are for `user`.
struct attach_serial {
  serial::direction towards = serial::direction::to_pc;
  carried<serial_end_actor> user;
};
RUBICON_FIELDS(attach_serial, towards, user);

struct serial_write {
  serial::direction towards = serial::direction::to_pc;
  payload octets;
};
RUBICON_FIELDS(serial_write, towards, octets);

struct plug_serial {
  bool plugged = true;
};
RUBICON_FIELDS(plug_serial, plugged);

/// From the thread of the loop: what a line has of the outside is there, or not.
struct serial_presence {
  bool there = false;
  std::string why; ///< it is not, in words; may be empty
};
RUBICON_FIELDS(serial_presence, there, why);

/// Octets of a line to real motes, which is beside the cable of a simulated sink.
struct real_octets {
  payload octets;
};
RUBICON_FIELDS(real_octets, octets);

/// Whoever wants to know whether what is at the far end of a line is there.
using line_watcher_actor =
    caf::typed_actor<caf::reacts_to<serial_presence>, caf::reacts_to<real_octets>>;

/// From now on `user` hears when the far end comes and goes, and at once if it is there.
struct watch_line {
  carried<line_watcher_actor> user;
  bool takes_octets = false; ///< those towards the PC are for it, too, as real_octets
};
RUBICON_FIELDS(watch_line, user, takes_octets);

/// A packet between the gateway and a program of TinyOS.
struct serial_packet {
  std::uint64_t token = 0; ///< the sender's name for it
  payload octets;          ///< dispatch octet first
};
RUBICON_FIELDS(serial_packet, token, octets);

/// To the sender of a serial_packet: the sink has acked it, or it is lost.
struct serial_packet_done {
  std::uint64_t token = 0;
};
RUBICON_FIELDS(serial_packet_done, token);

/// Whoever has a sink to give packets to.
using packet_end_actor = caf::typed_actor<caf::reacts_to<serial_packet>>;

struct attach_packets {
  carried<packet_end_actor> user;
};
RUBICON_FIELDS(attach_packets, user);

/// The cable between a sink and its gateway.
using serial_line_actor =
    caf::typed_actor<caf::reacts_to<attach_serial>, caf::reacts_to<serial_write>,
                     caf::reacts_to<plug_serial>, caf::reacts_to<timer_expired>,
                     caf::reacts_to<status_request>, caf::reacts_to<watch_line>>;

/// What stands for the cable where the sink is a real one.
using outside_line_actor =
    serial_line_actor::extend<caf::reacts_to<serial_octets>, caf::reacts_to<serial_presence>>;

/// The PC's end of a cable that other programs find on a pseudo-terminal.
using pty_end_actor =
    serial_end_actor::extend<caf::reacts_to<serial_write>, caf::reacts_to<serial_presence>,
                             caf::reacts_to<status_request>>;

// --------------------------------------------------------------------- motes and their programs

/// The app has carried its mote somewhere; its waypoints, if it has any, count no more.
struct move_mote {
  position place;
};
RUBICON_FIELDS(move_mote, place);

// Programs that use the Mockup interface and are not in their node's actor.

/// The node has this program now. What it offers; and how often it was started before.
struct program_attached {
  communication::remote::limits limits;
  std::uint32_t incarnation = 0;
};
RUBICON_FIELDS(program_attached, limits, incarnation);

/// The node has stopped for good, and all that is on it.
struct program_detached {};
RUBICON_FIELDS(program_detached);

/// Events, and how far the node is with the program's commands.
struct program_events {
  communication::remote::events_batch batch;
};
RUBICON_FIELDS(program_events, batch);

/// A program, as its node sees it.
using program_client_actor =
    caf::typed_actor<caf::reacts_to<program_attached>, caf::reacts_to<program_detached>,
                     caf::reacts_to<program_events>>;

/// A program begins on this node; what it had there before is closed. program_attached follows, if
/// the node still runs.
struct attach_program {
  std::uint32_t number = 0; ///< among the node's programs
  carried<program_client_actor> program;
};
RUBICON_FIELDS(attach_program, number, program);

/// Commands, and how far the program is with the node's events.
struct program_commands {
  std::uint32_t number = 0;
  communication::remote::commands_batch batch;
};
RUBICON_FIELDS(program_commands, number, batch);

/// A mote or PC, as such a program sees it.
using program_node_actor =
    caf::typed_actor<caf::reacts_to<attach_program>, caf::reacts_to<program_commands>>;

/// From the fault plan: the next handler throws.
struct crash_now {};
RUBICON_FIELDS(crash_now);

/// From the fault plan: the battery is flat.
struct end_battery {};
RUBICON_FIELDS(end_battery);

/// From the fault plan: the clock of a mote, sink or kernel is set.
struct step_clock {
  duration by{};
};
RUBICON_FIELDS(step_clock, by);

/// From the plan: a program of the mote reports so often from now on.
struct set_period {
  bool messenger = false;   ///< a messenger; else a sampler
  std::uint16_t number = 0; ///< its AM type, or its channel
  duration period{};
};
RUBICON_FIELDS(set_period, messenger, number, period);

using mote_actor = radio_user_actor::extend<
    caf::reacts_to<attach_program>, caf::reacts_to<program_commands>, caf::reacts_to<move_mote>,
    caf::reacts_to<crash_now>, caf::reacts_to<end_battery>, caf::reacts_to<step_clock>,
    caf::reacts_to<set_period>, caf::reacts_to<timer_expired>, caf::reacts_to<status_request>>;

/// From whoever spawned both: the program's mote runs, for the first time or again.
struct mote_started {
  carried<mote_actor> mote;
};
RUBICON_FIELDS(mote_started, mote);

/// A program in an actor of its own.
using program_actor =
    program_client_actor::extend<caf::reacts_to<mote_started>, caf::reacts_to<timer_expired>,
                                 caf::reacts_to<status_request>>;

using sink_actor =
    radio_user_actor::extend<caf::reacts_to<serial_octets>, caf::reacts_to<crash_now>,
                             caf::reacts_to<step_clock>, caf::reacts_to<timer_expired>,
                             caf::reacts_to<status_request>>;

// ------------------------------------------------------------------------------------- PEIS, links

/// Octets that have come over a PEIS link, in order.
struct link_octets {
  std::uint64_t link = 0;
  payload octets;
};
RUBICON_FIELDS(link_octets, link, octets);

struct link_closed {
  std::uint64_t link = 0;
};
RUBICON_FIELDS(link_closed, link);

/// The far end of an in-process link.
using link_end_actor = caf::typed_actor<caf::reacts_to<link_octets>, caf::reacts_to<link_closed>>;

using peis::link_condition;

/// A link is up. Both ends of a simulated one know it by the same number; a real one has no
/// `other`.
struct link_opened {
  std::uint64_t link = 0;
  carried<link_end_actor> other;
  bool initiator = false;
  std::uint64_t attempt = 0; ///< the initiator's; 0 if nobody asked
  link_condition condition = {};
};
RUBICON_FIELDS(link_opened, link, other, initiator, attempt, condition);

/// From the simulated network: the condition of an open link is another from now on.
struct condition_changed {
  std::uint64_t link = 0;
  link_condition condition = {};
};
RUBICON_FIELDS(condition_changed, link, condition);

/// Nobody took the link that was asked for.
struct attempt_failed {
  std::uint64_t attempt = 0;
};
RUBICON_FIELDS(attempt_failed, attempt);

/// A datagram for all peers.
struct announcement {
  payload octets;
};
RUBICON_FIELDS(announcement, octets);

/// A link's medium has taken so many octets; also to itself, when a simulated link has sent them.
struct link_sent {
  std::uint64_t link = 0;
  std::uint64_t octets = 0;
};
RUBICON_FIELDS(link_sent, link, octets);

/// A peer, as the simulated network sees it.
using lan_user_actor =
    link_end_actor::extend<caf::reacts_to<link_opened>, caf::reacts_to<condition_changed>,
                           caf::reacts_to<attempt_failed>, caf::reacts_to<announcement>>;

/// A peer has started: others reach it at `inproc://id` from now on, until it ends. `station` is
/// its own, no other has or had it.
struct join_lan {
  std::uint64_t station = 0;
  peer_id id;
  bool hears = true; ///< announcements
  carried<lan_user_actor> user;
};
RUBICON_FIELDS(join_lan, station, id, hears, user);

/// A station asks for a link to a peer. link_opened or attempt_failed follows, or nothing if the
/// network carries nothing between them.
struct lan_connect {
  std::uint64_t station = 0;
  std::uint64_t attempt = 0;
  peer_id to;
};
RUBICON_FIELDS(lan_connect, station, attempt, to);

/// An announcement of a station, for all others that hear.
struct lan_announce {
  std::uint64_t station = 0;
  payload octets;
};
RUBICON_FIELDS(lan_announce, station, octets);

/// One end has closed a link, and tells the other end itself.
struct lan_link_ended {
  std::uint64_t link = 0;
};
RUBICON_FIELDS(lan_link_ended, link);

/// From the fault plan: a station's computer is off, or on again.
struct set_lan_power {
  std::uint64_t station = 0;
  bool on = false;
};
RUBICON_FIELDS(set_lan_power, station, on);

/// From the fault plan: peers of two different groups do not hear each other; and between any two
/// of `lossy`, or between all if it is empty, packages are lost.
struct begin_lan_fault {
  std::uint64_t fault = 0; ///< its name
  std::vector<std::vector<peer_id>> groups;
  double loss = 0;
  std::vector<peer_id> lossy;
};
RUBICON_FIELDS(begin_lan_fault, fault, groups, loss, lossy);

struct end_lan_fault {
  std::uint64_t fault = 0;
};
RUBICON_FIELDS(end_lan_fault, fault);

/// The simulated network between the hosts of peers.
using peis_lan_actor =
    caf::typed_actor<caf::reacts_to<join_lan>, caf::reacts_to<lan_connect>,
                     caf::reacts_to<lan_announce>, caf::reacts_to<lan_link_ended>,
                     caf::reacts_to<set_lan_power>, caf::reacts_to<begin_lan_fault>,
                     caf::reacts_to<end_lan_fault>>;

// ------------------------------------------------------------------------- PEIS, simulated
// Bluetooth

/// What an adapter of a peer sees.
struct bluetooth_seen {
  std::string adapter;
  std::vector<peis::seen_device> devices; ///< ascending by address
};
RUBICON_FIELDS(bluetooth_seen, adapter, devices);

/// One of the peers behind a device says who it is; nobody has, if `octets` is empty.
struct hello_answer {
  std::string adapter; ///< of the peer that has asked
  peis::bluetooth_address device;
  payload octets;
};
RUBICON_FIELDS(hello_answer, adapter, device, octets);

/// Who has sent a HELLO.
using hello_sender_actor = caf::typed_actor<caf::reacts_to<hello_answer>>;

/// A HELLO has come to an adapter of this peer: a hello_answer is to go back. `question` is one
/// with the sender's octets.
struct hello_arrived {
  hello_answer question;
  carried<hello_sender_actor> sender;
};
RUBICON_FIELDS(hello_arrived, question, sender);

/// A link over Bluetooth is up.
struct bluetooth_opened {
  link_opened link;
  std::uint64_t rate_bps = 0; ///< 0: unlimited
};
RUBICON_FIELDS(bluetooth_opened, link, rate_bps);

/// A peer, as Bluetooth sees it.
using bluetooth_user_actor =
    link_end_actor::extend<caf::reacts_to<bluetooth_seen>, caf::reacts_to<hello_answer>,
                           caf::reacts_to<hello_arrived>, caf::reacts_to<bluetooth_opened>,
                           caf::reacts_to<attempt_failed>>;

/// A peer has started, and opens adapters of its machine. They stay where they are if others have
/// opened them before.
struct join_bluetooth {
  std::uint64_t station = 0;
  std::string machine;
  std::vector<std::string> adapters;
  position place;
  std::uint16_t port = 0; ///< where it takes links
  carried<bluetooth_user_actor> user;
};
RUBICON_FIELDS(join_bluetooth, station, machine, adapters, place, port, user);

/// A station looks who is there. bluetooth_seen follows.
struct scan_bluetooth {
  std::uint64_t station = 0;
  std::string adapter;
};
RUBICON_FIELDS(scan_bluetooth, station, adapter);

/// A station's HELLO to a device. A hello_answer follows from each peer there.
struct send_hello {
  std::uint64_t station = 0;
  hello_answer question; ///< with the sender's octets
};
RUBICON_FIELDS(send_hello, station, question);

/// A station asks for a link. bluetooth_opened or attempt_failed follows.
struct bluetooth_connect {
  std::uint64_t station = 0;
  std::uint64_t attempt = 0;
  peis::bluetooth_address to;
  std::uint16_t port = 0;
};
RUBICON_FIELDS(bluetooth_connect, station, attempt, to, port);

/// From the fault plan: a machine, with all its adapters, is somewhere else from now on.
struct move_machine {
  std::string machine;
  position place;
};
RUBICON_FIELDS(move_machine, machine, place);

/// Simulated Bluetooth.
using peis_bluetooth_actor =
    caf::typed_actor<caf::reacts_to<join_bluetooth>, caf::reacts_to<scan_bluetooth>,
                     caf::reacts_to<send_hello>, caf::reacts_to<bluetooth_connect>,
                     caf::reacts_to<lan_link_ended>, caf::reacts_to<set_lan_power>,
                     caf::reacts_to<move_machine>>;

// ------------------------------------------------------------------- PEIS, components of a kernel

/// A tuple that the component watches was set (also to an equal value), or deleted.
struct tuple_event {
  std::uint64_t watch = 0; ///< as given in watch_tuples
  peer_id owner;
  std::string key;
  payload value; ///< text without its trailing NUL
  bool deleted = false;
};
RUBICON_FIELDS(tuple_event, watch, owner, key, value, deleted);

/// A message for a port that the component has hooked.
struct peis_message {
  peer_id source;
  std::uint16_t port = 0;
  payload octets;
};
RUBICON_FIELDS(peis_message, source, port, octets);

/// How a request of the component ended; `cause` is empty on success.
struct peis_outcome {
  std::uint64_t token = 0;
  bool success = false;
  std::string cause;
};
RUBICON_FIELDS(peis_outcome, token, success, cause);

/// A component of a PEIS kernel: gateway, proxy, proxy manager, control program.
using peis_client_actor =
    caf::typed_actor<caf::reacts_to<tuple_event>, caf::reacts_to<peis_message>,
                     caf::reacts_to<peis_outcome>>;

/// Sets an own tuple of the kernel (D1.1 3.1.3 setTuple).
struct set_tuple {
  std::string key;
  payload value;
  bool text = true;
};
RUBICON_FIELDS(set_tuple, key, value, text);

struct delete_tuple {
  std::string key;
};
RUBICON_FIELDS(delete_tuple, key);

/// Sets a tuple of another owner (D1.1 3.1.3 setRemoteTuple); a peis_outcome follows.
struct set_remote_tuple {
  carried<peis_client_actor> client;
  std::uint64_t token = 0;
  peer_id owner;
  std::string key;
  payload value;
  bool text = true;
};
RUBICON_FIELDS(set_remote_tuple, client, token, owner, key, value, text);

/// Subscribes to a key, of one owner or any_peer, and calls back (D1.1 3.1.3 subscribe and
/// registerTupleCallback). What matches already is told at once.
struct watch_tuples {
  carried<peis_client_actor> client;
  std::uint64_t watch = 0; ///< the client's own name for it
  peer_id owner;
  std::string key; ///< may hold `*` parts
};
RUBICON_FIELDS(watch_tuples, client, watch, owner, key);

/// Makes an own tuple a meta tuple that points there, unless it is one already (D1.1 3.1.7.4,
/// META-04).
struct declare_meta_tuple {
  std::string key;
  std::string reference; ///< `(META <owner> <key>)`
};
RUBICON_FIELDS(declare_meta_tuple, key, reference);

/// Points a meta tuple of another owner, or of one's own, at a tuple; a peis_outcome follows.
struct set_meta_tuple {
  carried<peis_client_actor> client;
  std::uint64_t token = 0;
  peer_id owner;
  std::string key;
  std::string reference; ///< as above
};
RUBICON_FIELDS(set_meta_tuple, client, token, owner, key, reference);

/// As watch_tuples, to the tuple that a meta tuple points at, whichever that is at the time
/// (META-02).
struct watch_indirectly {
  carried<peis_client_actor> client;
  std::uint64_t watch = 0;
  peer_id owner; ///< of the meta tuple
  std::string key;
};
RUBICON_FIELDS(watch_indirectly, client, watch, owner, key);

/// In lower case, ascending, each once.
struct subscribers_changed {
  std::vector<std::string> keys;
};
RUBICON_FIELDS(subscribers_changed, keys);

using subscribers_watcher_actor = caf::typed_actor<caf::reacts_to<subscribers_changed>>;

/// Asks by which keys and patterns anybody subscribes to own tuples with this first part (in lower
/// case): told now and after each change, to the one who has asked last (TUP-23, GW-10).
struct watch_subscribers {
  carried<subscribers_watcher_actor> watcher;
  std::string first_part;
};
RUBICON_FIELDS(watch_subscribers, watcher, first_part);

/// Network time is so much ahead of ecology time (CLK-06).
struct clock_changed {
  duration offset{};
};
RUBICON_FIELDS(clock_changed, offset);

using clock_watcher_actor = caf::typed_actor<caf::reacts_to<clock_changed>>;

/// Asks for the kernel's clock: told now and after each change, to all who have asked (CLK-08).
struct watch_clock {
  carried<clock_watcher_actor> watcher;
};
RUBICON_FIELDS(watch_clock, watcher);

/// Every package on this port is for the client (D1.1 3.1.3 registerHook).
struct hook_port {
  carried<peis_client_actor> client;
  std::uint16_t port = 0;
};
RUBICON_FIELDS(hook_port, client, port);

/// D1.1 3.1.3 sendMessage; a peis_outcome follows.
struct send_peis_message {
  carried<peis_client_actor> client;
  std::uint64_t token = 0;
  peer_id destination;
  std::uint16_t port = 0;
  payload octets;
  bool reliable = false;
};
RUBICON_FIELDS(send_peis_message, client, token, destination, port, octets, reliable);

/// To every peer that can be reached (D1.1 3.1.3 broadcast); not acknowledged.
struct broadcast_peis_message {
  std::uint16_t port = 0;
  payload octets;
};
RUBICON_FIELDS(broadcast_peis_message, port, octets);

/// From the fault plan: the kernel's process stands still for so long.
struct pause_peer {
  duration length{};
};
RUBICON_FIELDS(pause_peer, length);

/// To itself: a pause is over.
struct resume_peer {};
RUBICON_FIELDS(resume_peer);

/// The run is over: say goodbye to the others. A peer with an init waits for it.
struct leave_network {};
RUBICON_FIELDS(leave_network);

/// The process of a peer is to end in good order. It does so when it does not stand still.
struct quit_peer {};
RUBICON_FIELDS(quit_peer);

/// A peer of this init's host has started.
struct component_started {
  std::string peer;
  std::uint64_t life = 0;
};
RUBICON_FIELDS(component_started, peer, life);

/// Its process has ended, or could not start.
struct component_ended {
  std::string peer;
  std::uint64_t life = 0;
};
RUBICON_FIELDS(component_ended, peer, life);

/// What its kernel tells an init that guards it.
struct kernel_guarded {
  std::string host_name;
  std::string network;
  std::uint16_t port = 0; ///< where it takes TCP links; 0: nowhere
};
RUBICON_FIELDS(kernel_guarded, host_name, network, port);

/// The kernel that an init guards has been asked to end, and waits for quit_peer.
struct quit_wanted {};
RUBICON_FIELDS(quit_wanted);

/// A component that is a process of its own has written something.
struct process_output {
  std::uint64_t component = 0; ///< its place in the init's list
  bool is_error = false;       ///< on standard error
  payload octets;
};
RUBICON_FIELDS(process_output, component, is_error, octets);

struct process_ended {
  std::uint64_t component = 0;
  std::uint64_t life = 0;
  std::string how;
};
RUBICON_FIELDS(process_ended, component, life, how);

/// The peisinit of a host.
using init_actor =
    peis_client_actor::extend<caf::reacts_to<component_started>, caf::reacts_to<component_ended>,
                              caf::reacts_to<kernel_guarded>, caf::reacts_to<quit_wanted>,
                              caf::reacts_to<process_output>, caf::reacts_to<process_ended>,
                              caf::reacts_to<timer_expired>, caf::reacts_to<status_request>>;

/// From its init: the kernel asks it before it ends. kernel_guarded follows.
struct guard_kernel {
  carried<init_actor> init;
};
RUBICON_FIELDS(guard_kernel, init);

/// One PEIS kernel.
using peis_peer_actor = lan_user_actor::extend<
    caf::reacts_to<bluetooth_seen>, caf::reacts_to<hello_answer>, caf::reacts_to<hello_arrived>,
    caf::reacts_to<bluetooth_opened>, caf::reacts_to<link_sent>, caf::reacts_to<set_tuple>,
    caf::reacts_to<delete_tuple>, caf::reacts_to<set_remote_tuple>, caf::reacts_to<watch_tuples>,
    caf::reacts_to<declare_meta_tuple>, caf::reacts_to<set_meta_tuple>,
    caf::reacts_to<watch_indirectly>, caf::reacts_to<watch_subscribers>,
    caf::reacts_to<watch_clock>, caf::reacts_to<hook_port>, caf::reacts_to<send_peis_message>,
    caf::reacts_to<broadcast_peis_message>, caf::reacts_to<pause_peer>, caf::reacts_to<resume_peer>,
    caf::reacts_to<step_clock>, caf::reacts_to<leave_network>, caf::reacts_to<quit_peer>,
    caf::reacts_to<guard_kernel>, caf::reacts_to<timer_expired>, caf::reacts_to<status_request>>;

/// The gateway between an island and the PEIS network.
using gateway_actor =
    peis_client_actor::extend<caf::reacts_to<subscribers_changed>, caf::reacts_to<clock_changed>,
                              caf::reacts_to<serial_octets>, caf::reacts_to<serial_packet>,
                              caf::reacts_to<real_octets>, caf::reacts_to<serial_presence>,
                              caf::reacts_to<timer_expired>, caf::reacts_to<status_request>>;

/// A serial forwarder for programs of TinyOS.
using forwarder_server_actor =
    caf::typed_actor<caf::reacts_to<attach_packets>, caf::reacts_to<serial_packet>,
                     caf::reacts_to<serial_packet_done>, caf::reacts_to<status_request>>;

/// Whether the proxied mote is there, as its gateway says.
struct mote_presence {
  device_presence presence = device_presence::listed;
  std::string cause; ///< one word, if it has left
};
RUBICON_FIELDS(mote_presence, presence, cause);

/// From its manager: this gateway leads the proxied mote's island from now on (GW-14, PXY-14).
struct gateway_changed {
  peer_id gateway;
  std::string name;
};
RUBICON_FIELDS(gateway_changed, gateway, name);

/// From the plan: proxies of a class go by other values from now on.
struct change_class {
  proxy::class_change what;
};
RUBICON_FIELDS(change_class, what);

/// What speaks for one mote.
using proxy_actor =
    peis_client_actor::extend<caf::reacts_to<mote_presence>, caf::reacts_to<gateway_changed>,
                              caf::reacts_to<program_attached>, caf::reacts_to<program_detached>,
                              caf::reacts_to<program_events>, caf::reacts_to<change_class>,
                              caf::reacts_to<timer_expired>, caf::reacts_to<status_request>>;

/// To itself: a proxy that has ended may be started again.
struct restart_proxy {
  mote_address mote;
};
RUBICON_FIELDS(restart_proxy, mote);

using proxy_manager_actor =
    peis_client_actor::extend<caf::reacts_to<restart_proxy>, caf::reacts_to<change_class>,
                              caf::reacts_to<timer_expired>, caf::reacts_to<status_request>>;

/// Control programs on peers: the collector.
using peer_app_actor = peis_client_actor::extend<caf::reacts_to<status_request>>;

/// The same with deadlines: rules, pursuers of goals; a peer's Communication Layer and the programs
/// that use it.
using timed_peer_app_actor = peer_app_actor::extend<caf::reacts_to<timer_expired>>;
using pc_actor =
    timed_peer_app_actor::extend<caf::reacts_to<clock_changed>, caf::reacts_to<attach_program>,
                                 caf::reacts_to<program_commands>>;

} // namespace rubicon

#include "actors/message_ids.hpp" // IWYU pragma: export
