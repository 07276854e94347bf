// The peer-to-peer layer: links, greeting, routing, forwarding, hosts, reliable messages
// (peis-wire.md 3 to 11, requirements A7, A8, A10).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/delivery/acknowledger.hpp"
#include "peis/delivery/delivery.hpp"
#include "peis/delivery/reassembly.hpp"
#include "peis/delivery/seen_ids.hpp"
#include "peis/link/link.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "peis/link/stranger_table.hpp"
#include "peis/link/traffic_meter.hpp"
#include "peis/overlay/connection_manager.hpp"
#include "peis/overlay/id_rivalry.hpp"
#include "peis/overlay/network_clock.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/overlay/route_probes.hpp"
#include "peis/overlay/routing_table.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/heartbeat.hpp"
#include "peis/wire/host_query.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/trace.hpp"

namespace rubicon::peis {

/// How many entries tables may have that others fill (docs/security.md).
struct table_limits {
  std::size_t hosts = 4480;     ///< two routing tables of the greatest size
  std::size_t routes = 4480;    ///< a link brings at most as many as are free
  std::size_t contacts = 8192;  ///< how connecting to a host has gone
  std::size_t heard_over = 128; ///< of each link
  std::size_t answers = 4096;   ///< to questions about hosts, not acknowledged yet
  std::size_t probes = 512;
  std::size_t seen = 65536; ///< ids of packages; the link that has brought the most forgets first
  std::uint64_t questions_per_second = 1000; ///< about hosts that nobody has described
  duration table_gap = 250ms; ///< between two routing tables of a link, at least, in the long run
  std::uint64_t routing_work_per_second = 100'000; ///< of all routing tables together
};

struct p2p_config {
  peer_id id;
  std::string name = "rubicon";    ///< of the component
  std::string host_name = "local"; ///< equal names mean the same machine: link cost 1 instead of 2
  std::string network = "default"; ///< up to 62 characters; peers of other networks are refused
  std::uint32_t process = 0;       ///< in the full name, name@host!process
  std::vector<low_level_address> addresses; ///< where we listen; up to 16, told to others
  /// Network time minus ecology time. In wall mode the Unix time of the ecology's start.
  duration clock_offset = 1'000'000'000s;
  std::int64_t clock_ppb = 0; ///< by which the local clock runs fast, parts per billion
  duration clock_period = 2s;
  bool time_master = false; ///< our clock is everybody's (CLK-06)
  connection_config connections;
  bluetooth_config bluetooth;
  unsigned broadcast_fanout = 0; ///< links a broadcast goes to beside those that want all; 0: all

  std::size_t links_max = 64; ///< a request beyond it is answered with whom else to ask (TCP-07)
  std::size_t greetings_max = 48; ///< links beside these whose request has not come yet
  queue_limits queue = {1024};    ///< of each link
  std::size_t queues_octets_max = std::size_t{48} << 20U; ///< of all links together
  /// Octets handed out per link that the owner has not reported with on_link_sent(). 0: the owner
  /// takes everything at once and never reports.
  std::size_t link_window = 0;
  /// In its place on a paced link: as many as a real kernel lets another acknowledge at a time.
  std::size_t paced_window = 20'000;
  /// Links from this number on lead to other processes, which are not told of in-process addresses.
  link_id outside_from{std::numeric_limits<std::uint64_t>::max()};
  budget_config budget; ///< of each neighbour
  // One call handles so much work of what has come; the rest waits for on_time(), which is due at
  // once. Links take turns.
  work_units turn_work = 512;
  work_units turn_quantum = 64;
  std::size_t input_max = std::size_t{4} << 20U; ///< octets of a link kept meanwhile
  table_limits tables;
  delivery_config reliable;
  reassembly_config assembly;
  duration ack_delay = 10ms;
  duration routing_period = 10s;
  duration trigger_gap = 500ms; ///< least time between two triggered routing sendings
  duration link_timeout = 30s;  ///< a link on which nothing arrives is closed
  // Between peers of our kind:
  duration heartbeat_period = 1s;
  duration heartbeat_timeout = 4s; ///< in place of link_timeout
  duration lost_timeout = 3s;      ///< a host without any way is forgotten, in place of ageing
  duration probe_timeout = 1500ms; ///< of a way that may lead in circles
  // With neighbours of another kind, which do not beat:
  duration sign_after = 3s;       ///< of silence, a sign of life is asked for
  duration sign_timeout = 3s;     ///< without one, or nothing leaving: another link is tried beside
  duration original_timeout = 2s; ///< of an attempt, in place of connections.connect_timeout
  duration handshake_timeout = 5s;
  duration greeting_timeout = 3s; ///< of a link of ours on which nobody has ever answered
  std::uint8_t metric_limit = 30;
  std::uint8_t cost_same_host = 1;
  std::uint8_t cost_other_host = 2;
};

struct p2p_counters {
  std::uint64_t links_opened = 0;
  std::uint64_t links_refused = 0; ///< by us: handshake failed
  std::uint64_t links_broken = 0;  ///< by us: stream broken, silent, led to nobody
  std::uint64_t octets_received = 0;
  std::uint64_t octets_sent = 0;
  std::uint64_t packages_received = 0;
  std::uint64_t packages_sent = 0; ///< all, forwarded ones and repeats included
  std::uint64_t packages_forwarded = 0;
  std::uint64_t intercepted = 0; ///< not passed on, a hook has consumed them
  std::uint64_t retransmissions = 0;
  std::uint64_t acks_sent = 0; ///< ids, not packages
  std::uint64_t ack_packages_sent = 0;
  std::uint64_t acks_received = 0;
  std::uint64_t messages_delivered = 0;  ///< reliable ones, acknowledged in full
  std::uint64_t messages_failed = 0;     ///< reliable ones, after they had been accepted
  std::uint64_t messages_begun_anew = 0; ///< long ones, whose receiver may have dropped a part
  std::uint64_t routing_sendings = 0;
  std::uint64_t attempts = 0;        ///< to get a link
  std::uint64_t attempts_failed = 0; ///< nobody answered, or refused
  std::uint64_t announcements_sent = 0;
  std::uint64_t announcements_received = 0; ///< of other peers of our network
  std::uint64_t announcements_foreign = 0;  ///< of these, with no address in the listed networks
  std::uint64_t heartbeats_sent = 0;
  std::uint64_t ways_disproved = 0; ///< led in circles (peis-wire.md 9.4)
  // Dropped on receipt.
  std::uint64_t illegal = 0;   ///< port 50 and above, bad type, source or fragment numbers
  std::uint64_t malformed = 0; ///< our own services could not decode it
  std::uint64_t seen = 0;      ///< loops and duplicates
  std::uint64_t repeated = 0;  ///< retransmission of what had arrived
  std::uint64_t own = 0;       ///< came back to us
  std::uint64_t hops = 0;      ///< not passed on, 14 hops made
  std::uint64_t no_route = 0;  ///< not passed on, destination unknown
  std::uint64_t fragments_refused = 0;
  std::uint64_t messages_incomplete = 0; ///< fragments stopped coming
  std::uint64_t duplicate_id = 0;        ///< signs that somebody else uses our id (RTE-08)
  std::uint64_t ids_yielded = 0;         ///< times that we left our id to another peer
  std::uint64_t rivals_refused = 0;      ///< claimed the id of a neighbour that is alive
  std::uint64_t claims_refused = 0;      ///< said in the name of such a neighbour by others
  // Limits of what neighbours may have us do or keep (docs/security.md).
  std::uint64_t work = 0;               ///< charged beyond one unit a package
  std::uint64_t held = 0;               ///< times that a link was not read until its turn came
  std::uint64_t rests = 0;              ///< times that a neighbour was over its budget
  std::uint64_t hosts_refused = 0;      ///< records, the table being full
  std::uint64_t routes_refused = 0;     ///< ways to hosts beyond the table
  std::uint64_t tables_put_off = 0;     ///< routing tables that came too fast; the newest counts
  std::uint64_t questions_refused = 0;  ///< about hosts, too many answers being in flight
  std::uint64_t greetings_evicted = 0;  ///< links closed for others, their request being late
  std::uint64_t newcomers_referred = 0; ///< told whom else to ask, all links being in use
  // Dropped on sending.
  std::uint64_t queue_full = 0;
  std::uint64_t early_drop = 0;
  std::uint64_t queued_lost = 0; ///< unreliable, was queued when its link closed
};
RUBICON_FIELDS(p2p_counters, links_opened, links_refused, links_broken, octets_received,
               octets_sent, packages_received, packages_sent, packages_forwarded, intercepted,
               retransmissions, acks_sent, ack_packages_sent, acks_received, messages_delivered,
               messages_failed, messages_begun_anew, routing_sendings, attempts, attempts_failed,
               announcements_sent, announcements_received, announcements_foreign, heartbeats_sent,
               ways_disproved, illegal, malformed, seen, repeated, own, hops, no_route,
               fragments_refused, messages_incomplete, duplicate_id, ids_yielded, rivals_refused,
               claims_refused, work, held, rests, hosts_refused, routes_refused, tables_put_off,
               questions_refused, greetings_evicted, newcomers_referred, queue_full, early_drop,
               queued_lost);

/// What is known of a link, for kernel.connections, the tools and the report.
struct link_view {
  link_id link;
  std::optional<peer_id> neighbour;
  std::uint64_t octets_in = 0;
  std::uint64_t octets_out = 0;
  double loss = 0;        ///< share of packages that the neighbour sent and we missed, 0..1
  std::size_t queued = 0; ///< packages that wait to leave
};

/// What a hook makes of a package that passes through.
enum class verdict : std::uint8_t { ignore, consume };

/// Must not call the kernel. The octets are valid during the call only.
using transit_hook = std::function<verdict(const package_header&, byte_view)>;

/// Works on links that the owner names and carries octets for. Calls collect events; take_events()
/// and flush() hand them out, so that packages of one occasion leave each link in one piece.
class p2p {
public:
  p2p();
  ~p2p(); // these are large: compiled once
  p2p(p2p&&) noexcept;
  p2p& operator=(p2p&&) noexcept;
  p2p(p2p_config config, random_stream rng, instant now);

  void on_link_open(link_id link, link_role role, instant now,
                    std::optional<attempt_id> attempt = std::nullopt);
  void on_attempt_failed(attempt_id attempt, instant now);
  /// @param from the sender's address, if it has one
  void on_announcement(byte_view octets, instant now,
                       std::optional<ipv4_address> from = std::nullopt);
  void on_bluetooth_scan(std::string_view adapter, std::span<const seen_device> seen, instant now);
  void on_hello_answer(std::string_view adapter, const bluetooth_address& address, byte_view octets,
                       instant now);
  void on_link_octets(link_id link, byte_view octets, instant now); ///< handled by serve_next()
  void on_link_sent(link_id link, std::size_t octets, instant now);
  void on_link_closed(link_id link, instant now);
  void on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Handles some of what links have brought: of one link, whose turn it is. To be called until it
  /// returns false, then end_turn(); what is left then is due at once, or when its neighbour is
  /// within its budget again.
  bool serve_next(instant now);
  [[nodiscard]] bool has_input() const { return !ready_.empty(); }
  void end_turn(instant now);

  /// What came over a link has cost us more than its receipt: the neighbour's budget pays. Nothing
  /// for a link that is gone.
  void charge(link_id link, work_units work, instant now);

  /// One message to one peer; how it ended comes as an event, at once for what is known at once.
  struct posting {
    peer_id destination;
    std::uint16_t port = 0;
    message_octets content;
    bool reliable = true;
    priority class_of_service = priority::normal;
    request_id id;
    std::optional<link_id> for_neighbour = std::nullopt; ///< an answer to what came over this link
  };
  void send(posting x);

  /// To every peer that can be reached; up to 1024 octets.
  [[nodiscard]] cause broadcast(std::uint16_t port, payload octets);

  /// Messages that are being put together take of this memory as well. @pre nothing has come yet
  void share_memory(std::shared_ptr<fair_share> x) { assembly_.use_memory(std::move(x)); }

  /// Shows packages of others that pass through, broadcasts included, but no parts of longer
  /// messages (API-06). What is consumed goes no further; if somebody waits for its
  /// acknowledgement, it comes again. An empty hook ends it.
  void set_transit_hook(std::uint16_t port, transit_hook hook);

  /// The exit broadcast (peis-wire.md 11). No routing is sent from then on.
  void leave();

  /// It runs on this computer, as far as we know.
  [[nodiscard]] bool shares_host(peer_id host) const;

  /// Where we listen from now on, as p2p_config::addresses: others hear of it at once.
  void set_addresses(std::vector<low_level_address> all, instant now);

  /// Which way packages take to that host and back. Told as `traced`, within trace_timeout.
  void trace(peer_id destination, request_id id, instant now);

  /// The local clock was set: by so much more than time has passed.
  void step_clock(duration by, instant now) { clock_.step(by, now); }
  [[nodiscard]] const network_clock& clock() const { return clock_; }

  [[nodiscard]] bool has_left() const { return left_; }

  /// What a HELLO connection carries from us: an announcement.
  [[nodiscard]] bytes hello() const;
  [[nodiscard]] const bluetooth& adapters() const { return bluetooth_; }

  /// What has happened since the last call; without to_link.
  [[nodiscard]] events take_events() { return std::exchange(events_, {}); }

  /// Writes what the links have room for. Adds to_link events, and others.
  void flush(instant now);

  [[nodiscard]] const p2p_config& config() const { return config_; }
  [[nodiscard]] const host_record& self() const { return self_; }
  [[nodiscard]] bool reachable(peer_id host) const { return way_to(host).has_value(); }
  /// Is there a record of the incarnation that the route to that host leads to?
  [[nodiscard]] bool knows_present(peer_id host) const;
  [[nodiscard]] const host_record* find_host(peer_id host) const;
  [[nodiscard]] std::vector<const host_record*> hosts() const; ///< ourselves included, by id
  [[nodiscard]] std::vector<link_view> links() const;          ///< ascending by link
  [[nodiscard]] const routing_table& routing() const { return routing_; }
  [[nodiscard]] const p2p_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t in_flight() const { return delivery_.in_flight(); }
  [[nodiscard]] std::size_t link_count() const { return connections_.size(); }

private:
  /// A neighbour's routing pages of one sending, until all are there.
  struct page_collection {
    std::int32_t seqno = 0;
    std::vector<std::optional<routing_page>> pages;
  };

  ///   accepting --valid request--> open     (an initiator's link is open from the start)
  struct connection {
    link_id id;
    bool open = false;
    std::optional<peer_id> neighbour;
    std::optional<std::int32_t> magic; ///< the neighbour's, by its own word over this link
    std::uint8_t cost = 0;
    stream_decoder decoder;
    page_collection pages;
    std::optional<std::vector<routing_entry>> table; ///< whole, but came too soon
    rate_limit table_rate;
    std::deque<peer_id> heard;       ///< sources without a way, oldest first
    bool waits = false;              ///< in ready_ or resting_
    bool held = false;               ///< the owner was told not to read it
    instant no_room_until;           ///< for hosts that it tells of
    std::optional<instant> asked_at; ///< by the neighbour
    bool named = false;              ///< the neighbour has told who it is
    bool rivals = false;             ///< it has our id, or knows another that has
    bool paced = false;              ///< the owner was told to pace it
    std::int64_t credit = 0;         ///< work that it may still have done this turn
    outgoing_queue queue;
    bytes preamble; ///< goes out before any package
    std::uint32_t counter = 0;
    std::size_t unreported = 0; ///< octets handed out, not yet reported as sent
    /// Reliable packages of ours among them: where they end in octets_out, and ack ids.
    std::deque<std::pair<std::uint64_t, std::int32_t>> leaving;
    instant drained; ///< when octets were last reported as sent, or began to wait
    instant opened;
    instant last_heard;  ///< a whole package
    instant last_octets; ///< handled or not
    instant last_written;
    std::uint32_t request_flags = 0;
    std::optional<std::uint32_t> counter_heard; ///< of the neighbour's last package
    double loss = 0;
    neighbour_budget budget;
    std::uint64_t octets_in = 0;
    std::uint64_t octets_out = 0;
    std::optional<heartbeat> beat; ///< the neighbour's last
    instant beat_heard;
    instant beat_sent;
    std::optional<duration> one_way;  ///< half a round trip, little disturbed by waiting
    std::optional<peer_id> tried_for; ///< whom we have looked for with it
    bool tried_here = false;          ///< at a loopback address
    instant sign_asked;               ///< when a sign of life was last asked for
    instant next_beside;              ///< try of another link to the same neighbour

    /// Kept up by one of its ends (AUT-01).
    [[nodiscard]] bool always() const {
      return (request_flags & connect_request::all_broadcasts) != 0;
    }
  };

  /// A link that has been asked for.
  struct attempt {
    std::uint32_t flags = 0;
    std::optional<peer_id> host;
    std::optional<std::size_t> standing;
    instant deadline;
    bool loopback = false; ///< the address is one of this computer
  };

  /// An address to which a link is always kept, or that is asked for others.
  struct standing_address {
    std::string url;
    bool seed = false;
    duration wait; ///< before the next try
    instant next;  ///< try
    bool trying = false;
    std::optional<link_id> link;
    std::optional<peer_id> host; ///< who answered there last
    unsigned refusals = 0;       ///< links that were closed at once, one after the other
    bool elsewhere = false;      ///< the next try is at another address that its host has told
  };

  /// How connecting to a host has gone.
  struct contact {
    unsigned tries = 0;
    instant last;              ///< try, or end of a link
    unsigned runs_foreign = 0; ///< cluster runs that saw it in a higher cluster (CLU-02)
    unsigned refusals = 0;     ///< links that it has closed at once, one after the other
  };

  /// Where peers are that refuse us.
  struct refusing_machine {
    unsigned refusals = 0;
    instant until; ///< none of them is tried before
  };

  using attempts_node = std::map<attempt_id, attempt>::node_type;

  struct former_host {
    host_record record;
    instant lost;
  };

  struct open_trace {
    peer_id destination;
    request_id id;
    instant deadline;
  };

  static constexpr link_id by_announcement{std::numeric_limits<std::uint64_t>::max()};

  struct acquaintance {
    host_record record;
    bool announced = false;      ///< host_appeared was told
    bool forgotten = false;      ///< we had given it up, what it wanted included
    instant heard;               ///< its last announcement
    instant own_word;            ///< when it last described itself
    std::int32_t before = 0;     ///< magic of the incarnation that this one has followed; 0: none
    std::optional<instant> lost; ///< there has been no route to it since
    std::int32_t rival = 0;      ///< magic of a newcomer with its id that was refused; 0: none
    instant rival_first;         ///< when that began
    link_id from = by_announcement; ///< the link that told of it first
    std::optional<ipv4_address>
        announcer; ///< who sent its first announcement; unset once it was met
  };

  /// What the parts of this ask for.
  template <class Outputs>
  void settle(Outputs todo, instant now) {
    for (auto& output : todo)
      std::visit([&](auto& x) { handle(x, now); }, output);
  }

  // p2p_input.cpp: whose turn it is
  void serve_link(connection& from, instant now);
  void queue_again(connection& x, bool more, instant now);
  void spend(link_id link, work_units work);
  [[nodiscard]] std::optional<instant> input_deadline() const;

  // p2p_limits.cpp: what tables have room for
  acquaintance* acquaint(peer_id id);
  [[nodiscard]] bool has_room_for_host(link_id from);
  void expire_hosts(instant now);
  [[nodiscard]] bool may_answer(link_id from) const;
  void on_message_ended(const reliable_message& x);
  void note_heard(peer_id source, link_id over);
  void evict_greeting();
  [[nodiscard]] std::size_t open_links() const;

  // p2p_links.cpp: links, greeting, writing
  void accept(connection& from, byte_view request, instant now);
  void greet(connection& to);
  void bind_neighbour(connection& x, peer_id neighbour, instant now);
  void close(link_id link, close_cause why, instant now);
  void forget_link(link_id link, instant now);
  void drop_output(connection& gone, instant now);
  void check_silence(instant now);
  void watch_silence(const connection& x);
  [[nodiscard]] duration patience(const connection& x) const;
  [[nodiscard]] instant silence_deadline(const connection& x) const;
  [[nodiscard]] instant drain_deadline(const connection& x) const;
  [[nodiscard]] bool has_room_for(const connect_request& request, instant now);
  [[nodiscard]] bool replace_least(instant now);
  static void note_counter(connection& x, std::uint32_t counter);
  [[nodiscard]] bool write(connection& to, instant now);
  [[nodiscard]] bool has_window(const connection& to, std::size_t more) const;
  [[nodiscard]] bool encode_next(connection& to, bytes& out, instant now);
  void hand_out(connection& to, bytes octets, instant now);
  void pace(connection& x);
  void count_drop(cause why);

  // p2p.cpp: packages
  void on_package(link_id from, const package_header& header, byte_view data, instant now);
  void on_fragment(link_id from, const package_header& header, byte_view data, instant now);
  void acknowledge(const package_header& header, instant now);
  void tell_neighbour(connection& to, std::uint16_t port, bytes data);
  void keep_addresses(std::vector<low_level_address> all);
  [[nodiscard]] bool is_here(const host_record& x) const;
  void note_elsewhere(peer_id host);
  void tell_host(peer_id to, link_id way, lane where, std::uint16_t port, bytes data);
  void send_acknowledgements(peer_id to, const std::vector<std::int32_t>& ids);
  void on_acknowledgement(byte_view data);
  void serve(link_id from, const package_header& header, byte_view data, instant now);
  void forward(link_id from, package_header header, byte_view data);
  [[nodiscard]] bool intercepts(const package_header& header, byte_view data); // p2p_transit.cpp
  [[nodiscard]] cause send_unreliable(const posting& x, link_id way);
  void pump(peer_id destination);
  void repeat_due(instant now);
  void begin_anew(const std::set<peer_id>& destinations);
  void fail(const reliable_message& x, cause why);
  [[nodiscard]] package_header fresh_header(package_type type, std::uint16_t port);
  cause enqueue(connection& to, lane where, outgoing_package x);
  cause flood(const package_header& header, const std::shared_ptr<const message_octets>& content,
              std::optional<link_id> except);
  [[nodiscard]] std::optional<link_id> way_to(peer_id destination) const;
  [[nodiscard]] std::optional<link_id> any_route_to(peer_id destination) const;

  // p2p_hosts.cpp: routing and hosts
  void on_routing(link_id from, byte_view data, instant now);
  void apply_table(connection& from, instant now);
  void apply_tables(instant now);
  void apply(const routing_changes& changes, instant now);
  void send_routing(instant now);
  void send_routing_to(connection& to);
  void trigger_routing(instant now);
  void on_period(instant now);
  void on_host_record(link_id from, const package_header& header, byte_view data, instant now);
  void welcome(peer_id id, instant now);
  void note_loss(peer_id id, instant now);
  void tell_forgotten(peer_id id);
  void on_dead_host(const package_header& header, byte_view data, instant now);
  void delete_host(peer_id id, dead_host_message::reason why, instant now);
  void close_links_to(peer_id id, close_cause why, instant now);

  // p2p_incarnations.cpp: which incarnation of a host is there now
  void note_stranger(peer_id id, instant now);
  void review_hosts(instant now);
  void ask_strangers(instant now);
  void ask_about(const stranger_table::question& x);
  void ask(peer_id id, std::int32_t magic, bool sealed);
  [[nodiscard]] bool answer_query(link_id from, const package_header& header, byte_view data);
  [[nodiscard]] bool believes(const host_record_message& message, instant now) const;
  void store_record(const host_record_message& message, instant now);
  void supersede(peer_id id, std::int32_t magic, instant now);
  void recall(acquaintance& x);
  void forget_host(peer_id id);

  // p2p_connections.cpp: whom to connect to
  void tend_connections(instant now);
  [[nodiscard]] std::optional<instant> connections_deadline() const;
  void connect(const std::string& url, attempt x, instant now);
  bool connect_host(const host_record& record, std::uint32_t flags, instant now);
  void on_attempt_ended(const attempt& x, bool success, instant now);
  void check_attempts(instant now);
  void tend_standing(instant now);
  [[nodiscard]] std::optional<std::string> address_told_by(const standing_address& x);
  [[nodiscard]] bool is_served(const standing_address& x) const;
  void note_contact(peer_id host, instant now);
  void note_refusal(peer_id host, instant now);
  [[nodiscard]] bool is_refused_at(peer_id host, instant now) const;
  [[nodiscard]] duration refused_wait(unsigned refusals) const;
  [[nodiscard]] rate_limit& announcer_of(const ipv4_address& from, instant now);
  [[nodiscard]] bool has_credit(peer_id host, instant now);
  void charge_announcer(peer_id host, instant now);
  [[nodiscard]] bool may_try(peer_id host, unsigned wait_max, instant now);
  void merge_clusters(instant now);
  void hasten_merge(instant now);
  void update_cluster(instant now);
  void remember(const host_record& record, instant now);
  [[nodiscard]] bool manages() const;
  [[nodiscard]] bool manager_wanted() const;
  [[nodiscard]] bool merge_wanted() const;
  void manage(instant now);
  [[nodiscard]] bool busy_with(peer_id host) const;
  void close_doubles(instant now);
  [[nodiscard]] bool force_by_traffic(instant now);
  [[nodiscard]] std::vector<link_option> link_options(instant now) const;
  [[nodiscard]] std::vector<host_option> host_options(instant now);
  [[nodiscard]] std::uint8_t own_connections() const;
  void announce_by_rule(instant now, bool extra);
  void refer_elsewhere(connection& to, instant now);

  // p2p_doubts.cpp: links to real kernels that may be dead
  [[nodiscard]] bool can_be_doubted(const connection& x) const;
  [[nodiscard]] instant doubt_begins(const connection& x) const;
  [[nodiscard]] bool is_doubtful(const connection& x, instant now) const;
  [[nodiscard]] instant next_doubt_of(const connection& x) const;
  void watch_doubt(const connection& x);
  void tend_doubts(instant now);
  [[nodiscard]] bool has_other_hope(const connection& x, instant now) const;
  void try_beside(const connection& x, instant now);
  void end_doubtful_beside(link_id link, instant now);
  [[nodiscard]] bool has_named_link(peer_id host) const;
  void show_ourselves(connection& to);
  void hear_beyond(link_id from, const package_header& header, const host_record& record,
                   instant now);

  // p2p_bluetooth.cpp: who is near
  void tell(bluetooth::outputs todo);
  void tend_bluetooth(instant now);
  [[nodiscard]] std::vector<std::string> urls_to(const host_record& other) const;
  [[nodiscard]] bool may_dial(const low_level_address& x) const;
  [[nodiscard]] bool may_dial_none(const host_record& x) const;

  // p2p_liveness.cpp: signs of life, proof of ways, traces, the clock
  void watch_life(instant now);
  [[nodiscard]] std::optional<instant> life_deadline() const;
  [[nodiscard]] bool is_marked(const connection& x) const;
  [[nodiscard]] instant next_beat_of(const connection& x) const;
  void expect_beat(const connection& x);
  void beat(instant now);
  void send_beat(connection& x, instant now);
  void on_heartbeat(connection& x, byte_view data, instant now);
  void probe_unsound(instant now);
  void handle(const probe_host& x, instant now);
  void handle(const way_disproved& x, instant now);
  void check_losses(instant now);
  void send_trace(peer_id destination);
  void check_traces(instant now);
  void on_trace(const package_header& header, byte_view data);
  [[nodiscard]] bool measures_way(const package_header& header) const;
  void on_clock(link_id from, const package_header& header, byte_view data, instant now);
  [[nodiscard]] bytes clock_after(link_id from, byte_view data) const;
  void tell_time(instant now);

  // p2p_identity.cpp: another peer uses our id, or two others use one
  void note_duplicate(const host_record& other, instant now);
  void hear_own_id(link_id from, const package_header& header, byte_view data, instant now);
  void handle(id_taken& x, instant now);
  void handle(const id_regained& x, instant now);
  void vacate_id(instant now);
  [[nodiscard]] std::optional<link_id> living_link(peer_id id, std::optional<link_id> except,
                                                   instant now) const;
  [[nodiscard]] bool is_impersonation(link_id from, const package_header& header,
                                      instant now) const;
  [[nodiscard]] bool refuse_rival(connection& from, const host_record& record, instant now);
  void tell_rivals(link_id from, const host_record& record);
  void tell_taken(connection& to, const host_record& by);
  void refuse_own_id(connection& to);

  p2p_config config_;
  random_stream rng_;
  id_source ids_;
  host_record self_;
  bool left_ = false;

  std::shared_ptr<queues_memory> queues_; ///< of all connections
  std::map<link_id, connection> connections_;
  std::map<peer_id, link_id> neighbours_; ///< the oldest link to each (peis-wire.md 3.6)
  routing_table routing_;
  std::map<peer_id, acquaintance> hosts_; ///< others
  /// By id their magic: on another computer, though that has our host name. Kept when they go.
  std::map<peer_id, std::int32_t> elsewhere_;
  stranger_table strangers_;

  std::deque<link_id> ready_;                     ///< whose input waits, in turn
  std::set<std::pair<instant, link_id>> resting_; ///< whose neighbour is over its budget
  std::optional<link_id> serving_;                ///< whose package is being handled
  std::optional<link_id> fed_;                    ///< whose octets are the caller's
  work_units turn_work_ = 0;                      ///< of this call
  work_meter work_;                               ///< of the package being handled
  std::optional<instant> next_tables_;            ///< routing tables that came too soon are due
  link_id last_table_;                            ///< applied
  std::map<link_id, std::size_t> answers_;        ///< in flight, by the link of the question
  std::size_t answers_open_ = 0;
  std::map<peer_id, link_id> heard_over_; ///< where sources without a way were last heard
  std::map<std::uint16_t, transit_hook> transit_hooks_; ///< by port
  seen_ids seen_;
  reassembly assembly_;
  acknowledger acknowledger_;
  delivery delivery_;
  std::set<peer_id> stalled_; ///< destinations whose next package found its queue half full

  std::uint64_t next_attempt_ = 1;
  std::map<attempt_id, attempt> attempts_;
  std::vector<standing_address> standing_;
  bluetooth bluetooth_;
  std::map<peer_id, contact> contacts_;
  std::map<std::string, refusing_machine> refusing_; ///< by name of machine
  std::map<ipv4_address, rate_limit> announcers_;
  std::map<peer_id, former_host> former_; ///< lost for want of a way: may be found again
  traffic_meter traffic_;
  route_probes probes_;
  std::vector<open_trace> traces_;
  network_clock clock_;
  instant next_manager_;
  instant next_merge_;
  instant last_merge_;
  instant next_judgement_; ///< of links, for others that ask
  instant next_announcement_;
  unsigned first_announcements_ = 0;   ///< made, of those at the start
  unsigned unheard_announcements_ = 0; ///< periods since a better announcer was heard
  id_rivalry rivalry_;
  std::size_t welcomed_ = 0;  ///< hosts that are announced
  std::set<peer_id> missing_; ///< of these, to which there is no route
  std::optional<instant> next_beat_;

  instant next_period_;
  std::optional<instant> next_trigger_;
  instant last_trigger_;
  instant latest_;          ///< the latest time told
  rate_limit routing_rate_; ///< work of all routing tables
  rate_limit asking_rate_;  ///< questions about hosts
  std::optional<instant> next_silence_check_;
  std::optional<instant> next_doubt_;

  events events_;
  p2p_counters counters_;
};

} // namespace rubicon::peis
