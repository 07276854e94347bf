// What a run tells at its end. Actors fill the parts they know; nothing here knows an actor.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/delay_histogram.hpp"
#include "core/fields.hpp"
#include "core/time.hpp"

namespace rubicon::runtime {

/// Counts by cause; ordered by name, so that equal runs print equal reports.
using cause_counts = std::map<std::string, std::uint64_t>;

/// Adds the counters of a module to those of others, each as `module.name`, unless it is 0.
template <described Counters>
void add_counters(cause_counts& sum, const std::string& module, const Counters& x) {
  for_each_field(x, [&](std::string_view name, std::uint64_t count) {
    if (count > 0)
      sum[module + '.' + std::string(name)] += count;
  });
}

/// The sum over all causes.
[[nodiscard]] std::uint64_t total(const cause_counts& x);

/// Copies and requests of the radio (both balance, checked as invariants).
struct radio_report {
  /// Copies, one per radio in range of a transmission: sent = delivered + sum of lost.
  std::uint64_t sent = 0;
  std::uint64_t delivered = 0;
  /// weak, loss, collision, captured, half_duplex, off, filtered, overflow, duplicate
  cause_counts lost;
  /// MAC requests: requests = mac_sent + sum of mac_failed + those still open at the end.
  std::uint64_t requests = 0;
  std::uint64_t mac_sent = 0;
  cause_counts mac_failed; ///< no_ack, channel_access_failure, queue_full, aborted
  std::uint64_t mac_open = 0;
  std::uint64_t transmissions = 0; ///< frames put on the air, retries and acks included
};
RUBICON_FIELDS(radio_report, sent, delivered, lost, requests, mac_sent, mac_failed, mac_open,
               transmissions);

struct serial_report {
  std::uint64_t octets = 0;          ///< carried, both ways
  std::uint64_t octets_up = 0;       ///< of these, to the PC
  std::uint64_t frames_sent = 0;     ///< by either end, acks and repeats included
  std::uint64_t frames_received = 0; ///< good ones, acks included
  cause_counts lost;                 ///< crc, unplugged, overflow, attempts, ...
};
RUBICON_FIELDS(serial_report, octets, octets_up, frames_sent, frames_received, lost);

struct peis_report {
  std::uint64_t peers = 0;
  std::uint64_t packages = 0; ///< sent over a link, forwarded ones included
  std::uint64_t tuples = 0;   ///< own tuples of all peers at the end
  cause_counts lost;          ///< queue_full, early_drop, no_route, hops, ...
};
RUBICON_FIELDS(peis_report, peers, packages, tuples, lost);

/// Every message that a program offers ends in one count: offered = sum of refused + reliable_sent
/// + unreliable_sent, and reliable_sent = reliable_acked + reliable_failed + reliable_open.
struct message_report {
  std::uint64_t offered = 0; ///< by programs
  /// At once: not_joined, crowded, too_long, no_such_receiver, off
  cause_counts refused = {};
  std::uint64_t reliable_sent = 0;
  std::uint64_t reliable_acked = 0;
  std::uint64_t reliable_failed = 0;
  std::uint64_t reliable_open = 0; ///< still waiting when the run ended
  std::uint64_t unreliable_sent = 0;
  std::uint64_t unreliable_arrived = 0; ///< of those sent here, wherever they went
  /// What was accepted and did not arrive, as far as anybody can know: unanswered, not_taken,
  /// left_island, sender_ended for reliable ones; on_the_way for others.
  cause_counts lost = {};
  std::uint64_t received = 0;   ///< handed to an application or a gateway
  std::uint64_t duplicates = 0; ///< suppressed

  /// Share of what was offered and is not open that has arrived; nothing: there is none.
  [[nodiscard]] std::optional<double> delivery() const;
};
RUBICON_FIELDS(message_report, offered, refused, reliable_sent, reliable_acked, reliable_failed,
               reliable_open, unreliable_sent, unreliable_arrived, lost, received, duplicates);

/// What the Network modules of an island's motes and its sink have done.
struct network_report {
  std::uint64_t beacons = 0;
  std::uint64_t packets = 0; ///< begun by a mote or the sink
  std::uint64_t arrived = 0;
  std::uint64_t forwarded = 0;
  std::uint64_t repeated = 0; ///< given to the radio again, which had repeated them itself
  std::uint64_t channels_asked = 0;
  std::uint64_t channels_opened = 0;
  std::uint64_t channels_flooded = 0; ///< asked for by a flood: no greedy way was found (NET-12)
  std::uint64_t channels_broken = 0;
  std::uint64_t channel_packets = 0;
  std::uint64_t channel_packets_arrived = 0;
  cause_counts lost; ///< queue_full, gave_up, no_route, malformed, ...
  /// All that the modules of motes and sink have counted, each of their counters by its name,
  /// `router.beacons`; none that is 0.
  cause_counts counters;

  // At the end of the run.
  largest<std::uint64_t> hops_max{};    ///< from a mote to the sink
  std::uint64_t synchronised = 0;       ///< motes that know the island's time
  largest<duration> clock_error_max{};  ///< of them, against the sink's clock (CLK-01)
  largest<duration> clock_excess_max{}; ///< the same, beyond what a mote itself allowed for
  std::uint64_t aligned = 0;            ///< motes that know the time that peers share
  largest<duration> time_error_max{};   ///< of them and the sink, against their gateway (CLK-08)
  largest<duration> time_excess_max{};  ///< the same, beyond what they allowed for
  largest<std::uint64_t>
      state_octets{}; ///< that a mote needs at most for all its protocols (SMP-30)
};
RUBICON_FIELDS(network_report, beacons, packets, arrived, forwarded, repeated, channels_asked,
               channels_opened, channels_flooded, channels_broken, channel_packets,
               channel_packets_arrived, lost, counters, hops_max, synchronised, clock_error_max,
               clock_excess_max, aligned, time_error_max, time_excess_max, state_octets);

struct mote_report {
  mote_address address;
  std::string name;    ///< unique in its island, `climate-7`
  std::string type;    ///< name of its [mote_type], else the number
  bool joins = true;   ///< false: it only measures the medium (stack = "mac")
  bool joined = false; ///< ever
  bool alive = false;  ///< at the end
  std::uint32_t incarnations = 0;
  std::string left_cause; ///< empty while it is listed: battery, silence, leave, ...
  double used_mah = 0;
  double battery_mah = 0;
  duration elapsed{}; ///< since its radio was added, until now or until its battery was flat
  duration mcu_active{};
  duration mcu_sleep{};
  duration radio_off{};
  duration radio_listen{};
  duration radio_receive{};
  duration radio_transmit{};
  message_report messages = {};       ///< of all its lives; what it received is of the same
  mote_id parent = {};                ///< in the tree, at the end; 0: none
  std::uint8_t hops = 0;              ///< to the sink, at the end
  std::optional<int> signal_dbm = {}; ///< of its parent's newest frame
};

/// One of several gateways of an island (GW-14).
struct gateway_report {
  peer_id id;
  std::string name;
  std::uint64_t led = 0; ///< times that it took the lead
  duration leading{};    ///< in all
  bool leads = false;    ///< at the end

  /// A later life of the same gateway.
  gateway_report& operator+=(const gateway_report& x);
};
RUBICON_FIELDS(gateway_report, id, name, led, leading, leads);

struct island_report {
  island_id id;
  std::string name;
  radio_report radio; ///< of radios of this island
  serial_report serial;
  message_report messages; ///< of its motes and gateway
  network_report network;
  std::vector<gateway_report> gateways; ///< in the order of the file; empty: it has one
  std::vector<mote_report> motes;       ///< ascending by id, the sink excluded
};

/// One actuation as its proxy saw it: exactly one outcome each.
struct actuation_report {
  std::uint64_t requested = 0;
  std::uint64_t acknowledged = 0;
  largest<duration> slowest{}; ///< of those, from the word in the tuple to the acknowledgement
  delay_histogram latency;     ///< the same, of each
  cause_counts failed;
};
RUBICON_FIELDS(actuation_report, requested, acknowledged, slowest, latency, failed);

struct proxy_report {
  std::string name; ///< its key prefix, `kitchen.climate-7`
  std::string proxy_class;
  std::string status;                                      ///< active or lost
  std::vector<std::pair<std::string, std::string>> values; ///< name and `22.3 C`, by name
  actuation_report actuations;
};
RUBICON_FIELDS(proxy_report, name, proxy_class, status, values, actuations);

struct peer_report {
  peer_id id;
  std::string name;
  std::uint64_t links = 0; ///< open at the end
  std::uint64_t hosts_known = 0;
  std::uint64_t tuples = 0;       ///< its own, at the end
  peis_report peis;               ///< `packages` and `lost` of this peer
  bool alive = true;              ///< at the end; if not, the figures are 0
  std::uint32_t incarnations = 1; ///< times it was started; the figures are of the last
  std::uint64_t links_opened = 0;
  cause_counts links_closed = {}; ///< far_end, or why it closed them: silent, double_link, ...
  std::uint64_t attempts = 0;     ///< to open a link
  std::uint64_t attempts_failed = 0;
  std::int32_t cluster = 0; ///< lowest id that it can reach
  /// What its limits have refused or put off: hosts_refused, over_budget, ...; none that is 0.
  cause_counts limits = {};
};
RUBICON_FIELDS(peer_report, id, name, links, hosts_known, tuples, peis, alive, incarnations,
               links_opened, links_closed, attempts, attempts_failed, cluster, limits);

/// Packets of the measuring apps from one mote to another, counted from the origin's request to its
/// MAC to delivery.
struct flow_report {
  mote_address from;
  mote_address to;       ///< broadcast_mote: whoever heard it
  std::string from_name; ///< `lab/sender-2`
  std::string to_name;   ///< `lab/sink`; `lab/*` for a broadcast
  std::uint64_t sent = 0;
  std::uint64_t delivered = 0; ///< each packet once; a broadcast once at each mote that heard it
  double pdr = 0;              ///< delivered / sent; 0 without a packet
  double goodput_bps = 0;      ///< MAC payload delivered, over the time in which the origin sent
  double delay_mean_ms = 0;    ///< of those delivered, as the next two
  double delay_p50_ms = 0;
  double delay_p95_ms = 0;
  double tx_per_packet = 0; ///< transmissions of all hops / sent
  /// By cause, on any hop: how the MAC ended the request, or else what became of the last copy on
  /// its way, `out_of_reach` if there was none; or what a mote could not do with it.
  cause_counts lost;
  /// Under way at the end, or when a mote that had it crashed: sent - delivered - lost; 0 for a
  /// broadcast.
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
/// lives and however often it was opened.
struct stream_report {
  std::uint16_t stream = 0;
  std::string from;               ///< node of the writer; empty: nobody of this run
  std::string to;                 ///< node of the reader
  std::uint64_t produced = 0;     ///< records that the writer's program had: written or not
  std::uint64_t written = 0;      ///< taken by its Stream System
  std::uint64_t read = 0;         ///< that the reader's program got
  std::uint64_t open = 0;         ///< under way at the end: newer than the newest that was read
  std::uint64_t missing = 0;      ///< produced - read - open
  std::uint64_t openings = 0;     ///< at the reader
  std::uint64_t opens_failed = 0; ///< at the writer
  duration pause{};               ///< the longest that the reader went without a record

  /// read / (produced - open); nothing: nothing was produced.
  [[nodiscard]] std::optional<double> delivery() const;
};
RUBICON_FIELDS(stream_report, stream, from, to, produced, written, read, open, missing, openings,
               opens_failed, pause);

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

/// Something a person following the run would want to hear.
struct story_line {
  instant at;
  std::string who;  ///< actor path, `kitchen/climate-7`
  std::string what; ///< `joined`, `left: battery`, `relay on`
};
RUBICON_FIELDS(story_line, at, who, what);

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
};

struct report {
  std::string ecology;
  std::uint64_t seed = 0;
  std::string mode; ///< virtual or wall
  duration simulated{};
  double wall_s = 0;        ///< the only figure that differs between equal virtual runs
  std::uint64_t events = 0; ///< messages delivered to actors
  std::string trace_hash;   ///< 16 hexadecimal digits
  bool interrupted = false; ///< ended by a signal before its time
  bool complete = false;    ///< the parts below were collected, and the run came to its end
  std::string reason;       ///< why it is not complete; empty if it is
  actor_report actors;
  std::vector<island_report> islands;   ///< ascending by id
  std::vector<peer_report> peers;       ///< ascending by id, gateways included
  std::vector<proxy_report> proxies;    ///< ascending by name
  std::vector<flow_report> flows;       ///< ascending by from, then to
  std::vector<program_report> programs; ///< ascending by node
  std::vector<stream_report> streams;   ///< ascending by reader, then number
  message_report pc_messages;           ///< of programs on PCs that are no gateways
  std::vector<story_line> story;        ///< in order of time, at most story_lines_max
  std::uint64_t story_left_out = 0;
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

inline constexpr std::size_t story_lines_max = 400;

/// One JSON object as docs/report.md describes it, with a newline at its end.
[[nodiscard]] std::string to_json(const report& x);

/// The report a person reads. `width` is the terminal's, in characters (no line is longer, below 60
/// it counts as 60); `colour` adds ANSI escapes. Names and values are printable()
[[nodiscard]] std::string to_text(const report& x, std::size_t width = 100, bool colour = false);

} // namespace rubicon::runtime
