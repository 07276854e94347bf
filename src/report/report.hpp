// The report at the end of a run. Actors fill the parts they know; nothing here knows an actor.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/plan/labels.hpp"
#include "config/run/variation.hpp"
#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/delay_histogram.hpp"
#include "core/time.hpp"
#include "report/cause_counts.hpp"
#include "report/island_report.hpp"

namespace rubicon::report {

struct peis_report {
  std::uint64_t peers = 0;    ///< PEIS peers, gateways included
  std::uint64_t packages = 0; ///< sent over a link, forwarded ones included
  std::uint64_t tuples = 0;   ///< own tuples of all peers at the end
  /// packages given up, for example `queue_full`, `early_drop`, `no_route`, `hops`
  cause_counts lost;
};
RUBICON_FIELDS(peis_report, peers, packages, tuples, lost);

/// Losses of one cause at one place.
struct loss_report {
  std::string what;  ///< `message`; `channel` or `tunnel`: packets of streams and synaptic channels
  std::string cause; ///< as in [losses.md](losses.md)
  std::string place; ///< who had the last copy: `kitchen/climate-7`, `kitchen/sink`; empty: unknown
  std::uint64_t count = 0; ///< [number] so many
};
RUBICON_FIELDS(loss_report, what, cause, place, count);

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
