// What the report has of one island: its radios, cables and messages, its motes and gateways.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "report/cause_counts.hpp"

namespace rubicon::report {

/// Two sets of counters. Copies, one for each radio in range of a transmission: sent = delivered +
/// sum of lost. MAC requests: requests = mac_sent + sum of mac_failed + mac_open.
struct radio_report {
  std::uint64_t sent = 0;      ///< [copies] put on the air
  std::uint64_t delivered = 0; ///< [copies] handed to a mote or sink
  /// `weak` (below the receiver's sensitivity, or spoiled by noise alone), `loss` on the way,
  /// `collision`, `captured` (the receiver was busy with another frame, or left this one for a
  /// stronger), `half_duplex` (the receiver was sending), `off`, `filtered` (received, but
  /// addressed to another), `overflow` (no receive slot free), `duplicate` (repeated because an
  /// acknowledgement was missed)
  cause_counts lost;
  std::uint64_t requests = 0; ///< frames that motes and sinks asked to have sent
  /// requests reported as sent; with an acknowledgement where one was asked for
  std::uint64_t mac_sent = 0;
  cause_counts mac_failed;         ///< `no_ack`, `channel_access_failure`, `queue_full`, `aborted`
  std::uint64_t mac_open = 0;      ///< requests not finished when the run ended
  std::uint64_t transmissions = 0; ///< frames put on the air, retries and acknowledgements included
  std::uint64_t acks = 0;          ///< of these, acknowledgements
  std::uint64_t acks_received = 0; ///< [copies] of `delivered` that were acknowledgements
};
RUBICON_FIELDS(radio_report, sent, delivered, lost, requests, mac_sent, mac_failed, mac_open,
               transmissions, acks, acks_received);

struct serial_report {
  std::uint64_t octets_written = 0;  ///< [octets] given to the cables by their ends
  std::uint64_t octets = 0;          ///< [octets] carried by the cables, both ways
  std::uint64_t octets_up = 0;       ///< [octets] of these, towards the PCs
  std::uint64_t frames_sent = 0;     ///< by either end, acknowledgements and repeats included
  std::uint64_t frames_received = 0; ///< good ones, acknowledgements included
  /// frames given up, for example `crc`, `overflow`, `attempts`; a cause that ends in `_octets`
  /// counts octets
  cause_counts lost;
};
RUBICON_FIELDS(serial_report, octets_written, octets, octets_up, frames_sent, frames_received,
               lost);

/// Motes with plain programs of TinyOS, at a line of their own or the sink's, whose own packets do
/// not count. Each packet that came and each input for such a mote has one end: packets = taken +
/// sum of dropped, inputs = inputs_sent + sum of inputs_failed + inputs_open.
struct real_line_report {
  std::uint64_t packets = 0; ///< that came in good frames
  std::uint64_t taken = 0;   ///< of them, made to messages of devices
  /// the others: `out_of_range` (not of the line's addresses), `no_rule` (no `plain` knows them),
  /// `malformed`, `no_data` (802.15.4 frames that carry no active message), `table_full`
  cause_counts dropped;
  std::uint64_t inputs = 0;      ///< for motes behind it
  std::uint64_t inputs_sent = 0; ///< of them, that the base station has acknowledged
  /// `no_ack`, `queue_full`, `refused` (no rule, or not what its form takes), `gateway_ended`
  cause_counts inputs_failed;
  std::uint64_t inputs_open = 0; ///< waiting when the run ended
};
RUBICON_FIELDS(real_line_report, packets, taken, dropped, inputs, inputs_sent, inputs_failed,
               inputs_open);

/// Outcomes of the messages sent, each counted once: sent = arrived + sum of lost + in_transit.
struct carried_report {
  std::uint64_t sent = 0;
  std::uint64_t arrived = 0;
  cause_counts lost = {};       ///< by [cause](losses.md)
  std::uint64_t in_transit = 0; ///< at the end
};
RUBICON_FIELDS(carried_report, sent, arrived, lost, in_transit);

/// Every message that a program offers ends in one count: offered = sum of refused + reliable_sent
/// + unreliable_sent, and reliable_sent + unreliable_sent = arrived + sum of lost + in_transit.
struct message_report {
  std::uint64_t offered = 0; ///< by programs, accepted or not
  /// at once: `not_joined`, `crowded` (too many reliable ones are in flight), `too_long` (or
  /// reliable and for everybody), `no_such_receiver`, `off` (the battery is flat)
  cause_counts refused = {};
  std::uint64_t reliable_sent = 0;   ///< sent with an end-to-end acknowledgement asked for
  std::uint64_t reliable_acked = 0;  ///< acknowledged
  std::uint64_t reliable_failed = 0; ///< given up; the sender is notified
  std::uint64_t reliable_open = 0;   ///< still waiting when the run ended
  std::uint64_t unreliable_sent = 0; ///< sent without an acknowledgement
  /// messages of both kinds that have arrived, each once; one for everybody at its first receiver.
  /// A reliable one may be among them and yet have failed: its acknowledgements were lost
  std::uint64_t arrived = 0;
  cause_counts lost = {};       ///< of those sent, by [cause](losses.md)
  std::uint64_t in_transit = 0; ///< of those sent, neither arrived nor lost when the run ended
  std::uint64_t received = 0;   ///< handed to an application or a gateway here, repeats included
  std::uint64_t duplicates = 0; ///< repeats that were recognised here and suppressed

  /// `arrived` over `offered` without `in_transit`; `null` if that is none
  [[nodiscard]] std::optional<double> delivery() const;
};
RUBICON_FIELDS(message_report, offered, refused, reliable_sent, reliable_acked, reliable_failed,
               reliable_open, unreliable_sent, arrived, lost, in_transit, received, duplicates);

/// What the backbones of an island's further sinks have carried: packets of the Network module,
/// beacons among them.
struct backbone_report {
  std::uint64_t sent = 0; ///< [packets] both ways; up + down + lost + those in transit at the end
  std::uint64_t up = 0;   ///< [packets] that the sink received
  std::uint64_t down = 0; ///< [packets] that further sinks received
  /// [packets] `cut`, `queue_full`, or `end_off`: the sink at the end was out of order
  cause_counts lost;
};
RUBICON_FIELDS(backbone_report, sent, up, down, lost);

/// What the Network modules of an island's motes and its sink have done.
struct network_report {
  std::uint64_t beacons = 0;   ///< sent
  std::uint64_t packets = 0;   ///< begun by a mote or the sink, over the tree; floods count once
  std::uint64_t arrived = 0;   ///< at whom they were for; a flood arrives at each mote
  std::uint64_t forwarded = 0; ///< hops that motes in between made
  /// times a packet was given to the radio again, which had itself repeated it
  std::uint64_t repeated = 0;
  std::uint64_t channels_asked = 0;  ///< channels that a mote wanted to another
  std::uint64_t channels_opened = 0; ///< of them
  /// searches that found no neighbour nearer to the destination, or did not know where it is, and
  /// asked everybody (NET-12)
  std::uint64_t channels_flooded = 0;
  std::uint64_t channels_broken = 0; ///< as a mote on their way saw it
  /// packets of streams and synaptic channels that stay in the island, from end to end
  carried_report channel_packets;
  /// packets and channels that went nowhere, hop by hop: a message that is lost may be several
  /// packets, and one of which another copy arrived is among them too. `queue_full`, `gave_up`
  /// (all repeats failed), `no_route`, `too_far` and `malformed` for packets; `channel_lost`,
  /// `channel_full` and `paced_out` (a newer one took its turn) for packets of channels;
  /// `channel_no_room`, `unclaimed` for channels; `channel_strays`,
  /// `unknown_channel`, `unowned` and `misdirected` for arrivals without a receiver; `id_taken`
  /// for requests to join of a second mote with a member's id
  cause_counts lost;
  /// [by name] all that the modules of motes and sink have counted, `router.sequence_requests`,
  /// `streams.resumed`; none that is 0. What each means stands beside it in the module's header
  /// (`src/network`, `src/mote`, `src/stream`, `src/synaptic`, `src/transport`)
  cause_counts counters;

  backbone_report backbone;          ///< between the sink and further ones
  largest<std::uint64_t> hops_max{}; ///< from a mote to the sink, at the end
  std::uint64_t synchronised = 0;    ///< motes that know the island's time at the end (CLK-01)
  /// largest difference of their island time to the sink's clock at the end
  largest<duration> clock_error_max{};
  /// the same, by how much more than a mote itself said that it may be
  largest<duration> clock_excess_max{};
  /// living motes that know the [network time](gateway.md#time) at the end (CLK-08)
  std::uint64_t aligned = 0;
  /// largest difference of their, and the sink's, network time to that of the gateway's kernel at
  /// the end
  largest<duration> time_error_max{};
  /// the same, by how much more than a mote itself said that it may be
  largest<duration> time_excess_max{};
  /// [octets] of state that the protocols of one mote need with all their tables full, the most of
  /// all motes (SMP-30)
  largest<std::uint64_t> state_octets{};
};
RUBICON_FIELDS(network_report, beacons, packets, arrived, forwarded, repeated, channels_asked,
               channels_opened, channels_flooded, channels_broken, channel_packets, lost, counters,
               backbone, hops_max, synchronised, clock_error_max, clock_excess_max, aligned,
               time_error_max, time_excess_max, state_octets);

/// SMEPP Light of an island's motes. An event counts once for each subscription it is for.
struct smepp_report {
  std::uint64_t programs = 0;        ///< programs `member`
  std::uint64_t members = 0;         ///< of them, members of their group at the end
  std::uint64_t joins = 0;           ///< times that one became a member
  std::uint64_t joins_failed = 0;    ///< the group was not found, or did not let it in
  std::uint64_t commands_failed = 0; ///< other commands of programs that failed
  std::uint64_t frames = 0;          ///< given to the radio
  std::uint64_t octets = 0;          ///< [octets] of them, without the radio's headers
  std::uint64_t events_raised = 0;   ///< [events] by programs, within the rates that are asked for
  std::uint64_t events_suppressed = 0; ///< [events] faster than that
  std::uint64_t events_received = 0;   ///< [events] by the subscribers' programs
  std::uint64_t events_open = 0;       ///< [events] under way at the end
  /// events that went nowhere: `gave_up` (no parent acknowledged it), `queue_full`, `loop`,
  /// `too_far`, `no_subscription` (it was over when the event was on its way), `not_waited_for`
  /// (smepp_receive was not called), `sender_unproven`, `power_lost` (of the mote that had it)
  cause_counts events_lost;
  /// frames that were not taken: `malformed`, `unknown_suite`, `unknown_group`, `wrong_key`,
  /// `tampered`, `replayed`, `unproven` (authentic, but perhaps a recording). A neighbour's radio
  /// has acknowledged them all the same: an event in one of them is in no other count
  cause_counts refused;
  /// [by name] all that the parts of SMEPP Light have counted; none that is 0. What each means
  /// stands beside it in `src/smepp`
  cause_counts counters;
  /// [octets] of state that SMEPP Light of one mote needs with all tables full
  largest<std::uint64_t> state_octets{};

  /// Events that are in none of the counts above: lost with a frame in `refused`.
  [[nodiscard]] std::uint64_t events_missing() const;
};
RUBICON_FIELDS(smepp_report, programs, members, joins, joins_failed, commands_failed, frames,
               octets, events_raised, events_suppressed, events_received, events_open, events_lost,
               refused, counters, state_octets);

/// What a mote used.
struct energy_report {
  /// since it was switched on, until its battery was flat or the run ended; the sum of the next two
  /// durations, and of the last four
  duration elapsed{};
  double used_mah = 0;       ///< [mAh] charge used
  double battery_mah = 0;    ///< [mAh] charge of its full battery
  duration mcu_active{};     ///< processor awake
  duration mcu_sleep{};      ///< processor asleep
  duration radio_off{};      ///< radio off
  duration radio_listen{};   ///< radio on, nothing on the air
  duration radio_receive{};  ///< radio receiving a frame
  duration radio_transmit{}; ///< radio sending a frame
};
RUBICON_FIELDS(energy_report, elapsed, used_mah, battery_mah, mcu_active, mcu_sleep, radio_off,
               radio_listen, radio_receive, radio_transmit);

/// How well the motes of an island have kept its time, all through a virtual run: each is compared
/// with the sink's clock every 10 s (CLK-01).
struct clock_report {
  std::uint64_t judged = 0;    ///< judgements of motes that know the island's time
  std::uint64_t below_1ms = 0; ///< of them, those less than 1 ms off
  /// of them, those farther off than the mote itself said that it may be, by more than 1 ms
  std::uint64_t outside = 0;
  duration outside_longest{}; ///< the longest that one was so
  duration error_max{};       ///< largest difference of all,
  std::string error_max_mote; ///< whose it was; empty: none was judged
  instant error_max_at{};     ///< and when

  /// [ratio] of the judgements, those less than 1 ms off; `null` without any
  [[nodiscard]] std::optional<double> share_precise() const;
};
RUBICON_FIELDS(clock_report, judged, below_1ms, outside, outside_longest, error_max, error_max_mote,
               error_max_at);

struct mote_report {
  mote_address address;           ///< which mote
  std::string name;               ///< its name, unique in its island
  std::string type;               ///< name of its mote type, else the number
  bool joins = true;              ///< whether it is to join; `false` with `stack = "mac"`
  bool joined = false;            ///< it joined at least once
  bool alive = false;             ///< it has power at the end
  std::uint32_t incarnations = 0; ///< times it started
  /// why it is not listed: `battery`, `silence`, `leave`, ...; empty while it is
  std::string left_cause;
  energy_report energy;         ///< what it used
  message_report messages = {}; ///< as above, of its programs, in all its lives
  /// the mote that it sends by at the end, or the sink; 0: it has no route to the sink
  mote_id parent = {};
  std::uint8_t hops = 0;              ///< to the sink, at the end; a backbone counts as one
  bool further_sink = false;          ///< it is a further sink of its island
  std::optional<int> signal_dbm = {}; ///< of its parent's newest frame; `null` if none has come
  /// the longest, after its first join and while it had power, that its gateway did not list it, or
  /// got none of its messages
  duration silence = {};
  instant silence_from = {}; ///< when that began
};
RUBICON_FIELDS(mote_report, address, name, type, joins, joined, alive, incarnations, left_cause,
               energy, messages, parent, hops, further_sink, signal_dbm, silence, silence_from);

/// How one of several gateways of an island has led it (GW-14).
struct lead_report {
  std::uint64_t led = 0; ///< times that it took the lead
  duration leading{};    ///< for how long in all
  largest<bool> leads{}; ///< at the end: no life that has ended does
};
RUBICON_FIELDS(lead_report, led, leading, leads);

struct gateway_report {
  peer_id id;
  std::string name;
  lead_report lead; ///< in all its lives
};
RUBICON_FIELDS(gateway_report, id, name, lead);

struct island_report {
  // Compiled once: they are large.
  island_report();
  ~island_report();
  island_report(const island_report&);
  island_report& operator=(const island_report&);
  island_report(island_report&&) noexcept;
  island_report& operator=(island_report&&) noexcept;

  island_id id;
  std::string name;
  radio_report radio; ///< of radios of this island
  serial_report serial;
  real_line_report real;
  message_report messages; ///< of its motes and gateway
  network_report network;
  clock_report clock;
  smepp_report smepp;
  std::vector<gateway_report> gateways; ///< in the order of the file; empty: it has one
  std::vector<mote_report> motes;       ///< ascending by id, the sink excluded
};
RUBICON_FIELDS(island_report, id, name, radio, serial, real, messages, network, clock, smepp,
               gateways, motes);

} // namespace rubicon::report
