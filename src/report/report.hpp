// The report at the end of a run. Actors fill the parts they know; nothing here knows an actor.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "config/plan/labels.hpp"
#include "config/run/variation.hpp"
#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/delay_histogram.hpp"
#include "core/time.hpp"

namespace rubicon::report {

/// Counts by cause; ordered by name, so that equal runs print equal reports.
using cause_counts = std::map<std::string, std::uint64_t>;

/// Adds the counters of a module to those of others, each as `module.name`, those by cause as
/// `module.name.cause`, unless it is 0. What is no count is left out. The struct is always named:
/// tests/architecture/counters_shown looks for it.
template <described Counters>
void add_counters(cause_counts& sum, const std::string& module, const Counters& x) {
  // Most counters of most modules are 0: only those that are not cost the making of a name.
  const auto add = [&](std::string_view field, std::uint64_t count, std::string_view cause = {}) {
    if (count == 0)
      return;
    auto name = module;
    name.append(1, '.').append(field);
    if (!cause.empty())
      name.append(1, '.').append(cause);
    sum[std::move(name)] += count;
  };
  for_each_field(x, [&](std::string_view field, const auto& counted) {
    if constexpr (std::is_convertible_v<decltype(counted), std::uint64_t>)
      add(field, counted);
    else if constexpr (requires { counted.begin()->second > 0; })
      for (const auto& [cause, count] : counted)
        add(field, count, cause);
  });
}

/// The sum over all causes.
[[nodiscard]] std::uint64_t total(const cause_counts& x);

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

struct peis_report {
  std::uint64_t peers = 0;    ///< PEIS peers, gateways included
  std::uint64_t packages = 0; ///< sent over a link, forwarded ones included
  std::uint64_t tuples = 0;   ///< own tuples of all peers at the end
  /// packages given up, for example `queue_full`, `early_drop`, `no_route`, `hops`
  cause_counts lost;
};
RUBICON_FIELDS(peis_report, peers, packages, tuples, lost);

/// Outcomes of the messages sent, each counted once: sent = arrived + sum of lost + in_transit.
struct carried_report {
  std::uint64_t sent = 0;
  std::uint64_t arrived = 0;
  cause_counts lost = {};       ///< by [cause](losses.md)
  std::uint64_t in_transit = 0; ///< at the end
};
RUBICON_FIELDS(carried_report, sent, arrived, lost, in_transit);

/// Losses of one cause at one place.
struct loss_report {
  std::string what;  ///< `message`; `channel` or `tunnel`: packets of streams and synaptic channels
  std::string cause; ///< as in [losses.md](losses.md)
  std::string place; ///< who had the last copy: `kitchen/climate-7`, `kitchen/sink`; empty: unknown
  std::uint64_t count = 0; ///< [number] so many
};
RUBICON_FIELDS(loss_report, what, cause, place, count);

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

/// One actuation as its proxy saw it: exactly one outcome each.
struct actuation_report {
  std::uint64_t requested = 0;
  std::uint64_t acknowledged = 0;
  std::uint64_t sent = 0;      ///< to motes with plain programs, which acknowledge nothing
  largest<duration> slowest{}; ///< of those, from the word in the tuple to the acknowledgement
  delay_histogram latency;     ///< the same, of each
  cause_counts failed;
};
RUBICON_FIELDS(actuation_report, requested, acknowledged, sent, slowest, latency, failed);

/// [s] A quantile of the latency, never above the slowest: the histogram knows it within 0.8 %.
[[nodiscard]] double latency_s(const actuation_report& x, double q);

struct proxy_report {
  std::string name; ///< its key prefix, `kitchen.climate-7`
  std::string proxy_class;
  std::string status;                                      ///< active or lost
  std::vector<std::pair<std::string, std::string>> values; ///< name and `22.3 C`, by name
  actuation_report actuations;
  /// how old its readings are expected to be when they come, of its [fields](gateway.md#of-a-proxy)
  /// the greatest; `null` if nothing that it reads holds a time
  duration latency{};
  std::uint64_t late = 0; ///< [readings] that were older than was published at that moment
};
RUBICON_FIELDS(proxy_report, name, proxy_class, status, values, actuations, latency, late);

struct peer_report {
  // Compiled once: they are large.
  peer_report();
  ~peer_report();
  peer_report(const peer_report&);
  peer_report& operator=(const peer_report&);
  peer_report(peer_report&&) noexcept;
  peer_report& operator=(peer_report&&) noexcept;

  peer_id id;              ///< its PEIS id
  std::string name;        ///< its name
  std::uint64_t links = 0; ///< open links at the end
  /// hosts it knows at the end; one that can be reached counts only if its record is that of its
  /// present incarnation
  std::uint64_t hosts_known = 0;
  std::uint64_t tuples = 0;       ///< its own tuples at the end
  peis_report peis;               ///< of `packages` and `lost`, this peer's
  bool alive = true;              ///< it runs at the end; if not, the figures are 0
  std::uint32_t incarnations = 1; ///< times it started; the figures are of the last
  std::uint64_t links_opened = 0; ///< links it has had
  /// those that have ended: `far_end` closed or reset it, or why this peer closed it
  cause_counts links_closed = {};
  std::uint64_t attempts = 0;        ///< links it asked for
  std::uint64_t attempts_failed = 0; ///< of these, refused or not answered
  std::int32_t cluster = 0;          ///< [number] lowest PEIS id that it can reach at the end
  /// what its [limits](security.md#limits) have refused or put off: `over_budget` (times a
  /// neighbour was not read until it was within its budget again), `turns` (times a link was not
  /// read until its turn came), `hosts_refused`, `routes_refused`, `tables_put_off`,
  /// `questions_refused`, `fragments_refused`, `greetings_evicted`, `newcomers_referred`,
  /// `connections_refused`, `connections_foreign` (links and announcements from none of its
  /// `networks`), `announcements_foreign` (of peers with no address there),
  /// `claims_refused` (said by others in the name of a neighbour that is
  /// alive), `rivals_refused` (claimed its id); of the tuple space `tuples_full` (tuples of others,
  /// or written by others, without room), `tuples_malformed`, `subscriptions_full`, `strangers`
  /// (messages of unknown hosts), `appends_refused`, `orphans` (own tuples removed
  /// because their writers are gone), `stale_removed`, `resyncs` (a host missed too many values:
  /// all it wants was looked at again), `values_overtaken` (a newer one took their place while they
  /// waited for room on their way to a subscriber), `pushes_given_up`, `absent_forgotten` (hosts
  /// whose subscriptions were kept for their return, and no longer); none that is 0
  cause_counts limits = {};
  cause_counts counters = {}; ///< all that its kernel counts, `part.name`; none that is 0
};
RUBICON_FIELDS(peer_report, id, name, links, hosts_known, tuples, peis, alive, incarnations,
               links_opened, links_closed, attempts, attempts_failed, cluster, limits, counters);

/// What the modules of a gateway or PC count: its gateway, proxies and their managers, rules,
/// tunnels; or the plain programs of a mote, or a base station. In all their lives.
struct module_report {
  std::string who;       ///< its peer; the mote, `lab/node-2`; or `sink/lab`
  cause_counts counters; ///< `module.name`; none that is 0
};
RUBICON_FIELDS(module_report, who, counters);

/// Packets of the measuring apps from one mote to another, counted from the origin's request to its
/// MAC to delivery.
struct flow_report {
  mote_address from;      ///< the sender
  mote_address to;        ///< the target; `island/65535` for a broadcast
  std::string from_name;  ///< the sender's name, `lab/node-2`
  std::string to_name;    ///< the target's name, `lab/sink`; `lab/*` for a broadcast
  std::uint64_t sent = 0; ///< [packets] that the sender asked its medium access to send
  /// [packets] that arrived, each once; a broadcast once at each mote with a receiver
  std::uint64_t delivered = 0;
  /// [ratio] `delivered` / `sent`; 0 if nothing was sent, `null` for a broadcast, which has no one
  /// receiver
  double pdr = 0;
  /// [bit/s] MAC payload delivered, over the time in which the sender sent
  double goodput_bps = 0;
  /// [ms] mean delay of what was delivered; 0 if nothing was, as the next two
  double delay_mean_ms = 0;
  double delay_p50_ms = 0; ///< [ms] median delay
  double delay_p95_ms = 0; ///< [ms] delay within which 95 % of them arrived
  /// [number] transmissions, repeats and those of relays included, / `sent`
  double tx_per_packet = 0;
  /// packets lost, on whichever hop: how the MAC failed (`no_ack`, `channel_access_failure`,
  /// `queue_full`, `aborted`); without acknowledgement the outcome of the copy (the causes of
  /// `radio`, or `out_of_reach`); or what a mote could not do with it (`no_relay`, `no_receiver`,
  /// `loop`)
  cause_counts lost;
  /// [packets] in flight when the run ended, or when a mote that had them crashed
  std::uint64_t open = 0;
};
RUBICON_FIELDS(flow_report, from, to, from_name, to_name, sent, delivered, pdr, goodput_bps,
               delay_mean_ms, delay_p50_ms, delay_p95_ms, tx_per_packet, lost, open);

/// What a program on a mote or PC has counted or measured.
struct program_report {
  std::string who; ///< its node, `kitchen/climate-7` or `robot`
  std::string kind;
  std::vector<std::pair<std::string, double>> figures; ///< in the program's order
};
RUBICON_FIELDS(program_report, who, kind, figures);

/// A stream of records from the program that writes it to the one that reads it, over all their
/// lives and however often it was opened. produced = read + open + missing.
struct stream_report {
  std::uint16_t stream = 0;   ///< [number] its number
  std::string from;           ///< the writer's node; empty if no node of this run writes it
  std::string to;             ///< the reader's node
  std::uint64_t produced = 0; ///< [records] that the writer's program had, written or not
  std::uint64_t written = 0;  ///< [records] of those, taken by the writer's Stream System
  std::uint64_t read = 0;     ///< [records] that the reader's program got
  /// [records] in flight at the end: newer than the newest that was read, by at most 30 s
  std::uint64_t open = 0;
  std::uint64_t missing = 0;      ///< [records] all others
  std::uint64_t openings = 0;     ///< at the reader
  std::uint64_t opens_failed = 0; ///< at the writer
  /// the longest that the reader's program went without a record, from its first one to the end
  duration pause{};
  /// from when both its programs were there, for the first time, to its first record; to the end if
  /// there was none
  duration first_after{};

  /// `read` / (`produced` - `open`); `null` if that is nothing
  [[nodiscard]] std::optional<double> delivery() const;
};
RUBICON_FIELDS(stream_report, stream, from, to, produced, written, read, open, missing, openings,
               opens_failed, pause, first_after);

/// How an expectation of the file has come out.
struct expectation_report {
  enum class verdict : std::uint8_t { met, unmet, unjudged };

  std::string text; ///< `delivery kitchen >= 99%`
  verdict outcome = verdict::unjudged;
  std::string measured;                  ///< `97.3%: 12 of 446 lost`
  instant at;                            ///< when it was decided
  std::vector<std::string> explain = {}; ///< arguments of `rubicon explain` behind the record;
                                         ///< empty: a record does not show it
  std::string command = {};              ///< that shows more; empty if it is met
};
RUBICON_FIELDS(expectation_report, text, outcome, measured, at, explain, command);

/// Something a person following the run would want to hear.
struct logged_event {
  instant at;
  std::string who;  ///< actor path, `kitchen/climate-7`
  std::string what; ///< `joined`, `left: battery`, `relay on`
};
RUBICON_FIELDS(logged_event, at, who, what);

struct violation {
  instant at;
  std::string invariant;
  std::string detail;
};
RUBICON_FIELDS(violation, at, invariant, detail);

struct actor_report {
  std::uint64_t spawned = 0;
  std::uint64_t restarted = 0;
  std::vector<std::string> failures; ///< `kitchen/climate-7: what()`, in order, at most 100
  std::uint64_t changes_refused = 0; ///< asked for while the run was on, and impossible
};
RUBICON_FIELDS(actor_report, spawned, restarted, failures, changes_refused);

struct run_report {
  // Compiled once: they are large.
  run_report();
  ~run_report();
  run_report(const run_report&);
  run_report& operator=(const run_report&);
  run_report(run_report&&) noexcept;
  run_report& operator=(run_report&&) noexcept;

  std::string ecology;
  std::uint64_t seed = 0;
  std::string mode; ///< virtual or wall
  duration simulated{};
  double wall_s = 0;        ///< the only figure that differs between equal virtual runs
  std::uint64_t events = 0; ///< messages delivered to actors
  std::string trace_hash;   ///< 16 hexadecimal digits
  bool interrupted = false; ///< ended by a signal before its time
  std::string ended_by;     ///< the mote whose flat battery ended it, by `until`; empty: none did
  bool complete = false;    ///< the parts below were collected, and the run came to its end
  std::string reason;       ///< why it is not complete; empty if it is
  actor_report actors;
  std::vector<island_report> islands;   ///< ascending by id
  std::vector<peer_report> peers;       ///< ascending by id, gateways included
  std::vector<proxy_report> proxies;    ///< ascending by name
  std::vector<flow_report> flows;       ///< ascending by from, then to
  std::vector<program_report> programs; ///< ascending by node
  std::vector<module_report> modules;   ///< of gateways and PCs, ascending by name
  std::vector<stream_report> streams;   ///< ascending by reader, then number
  message_report pc_messages;           ///< of programs on PCs that are no gateways
  carried_report
      tunnels; ///< packets of streams and synaptic channels to and from other islands, PCs
  std::vector<loss_report> losses; ///< of messages, channels and tunnels, by place; the most first
  std::vector<logged_event> event_log; ///< in order of time, at most event_log_max
  std::uint64_t event_log_left_out = 0;
  std::vector<violation> violations;
  std::vector<expectation_report> expectations; ///< in the order of the file

  [[nodiscard]] std::uint64_t motes_configured() const; ///< that are to join
  [[nodiscard]] std::uint64_t motes_measuring() const;  ///< that are not
  [[nodiscard]] std::uint64_t motes_joined() const;     ///< ever
  [[nodiscard]] std::uint64_t motes_left() const;       ///< joined once and not listed at the end
  [[nodiscard]] std::uint64_t motes_alive() const;      ///< of both kinds

  // Sums over all islands, messages of PCs too; over all peers, of which the tuples count that are
  // their own.
  [[nodiscard]] radio_report radio() const;
  [[nodiscard]] serial_report serial() const;
  [[nodiscard]] message_report messages() const;
  [[nodiscard]] peis_report peis() const;
  [[nodiscard]] double used_mah() const;
};
RUBICON_FIELDS(run_report, ecology, seed, mode, simulated, wall_s, events, trace_hash, interrupted,
               ended_by, complete, reason, actors, islands, peers, proxies, flows, programs,
               modules, streams, pc_messages, tunnels, losses, event_log, event_log_left_out,
               violations, expectations);

inline constexpr std::size_t event_log_max = 400;

/// One JSON object as docs/report.md describes it, with a newline at its end.
[[nodiscard]] std::string to_json(const run_report& x);

/// The same with the labels of the file that was run, and what its seed has decided of it.
[[nodiscard]] std::string to_json(const run_report& x, const config::label_table& labels,
                                  const config::variation& varied = {});

/// The report a person reads. `width` is the terminal's, in characters (no line is longer, below 60
/// it counts as 60); `colour` adds ANSI escapes. Names and values are printable()
[[nodiscard]] std::string to_text(const run_report& x, std::size_t width = 100,
                                  bool colour = false);

} // namespace rubicon::report
