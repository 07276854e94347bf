// The peer-to-peer layer: links, greeting, routing, forwarding, hosts, reliable messages
// (peis-wire.md 3 to 11, requirements A7, A8, A10).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "core/time.hpp"
#include "peis/acknowledger.hpp"
#include "peis/dead_host.hpp"
#include "peis/delivery.hpp"
#include "peis/host_query.hpp"
#include "peis/host_record.hpp"
#include "peis/link.hpp"
#include "peis/outgoing_queue.hpp"
#include "peis/p2p_events.hpp"
#include "peis/reassembly.hpp"
#include "peis/routing_table.hpp"
#include "peis/seen_ids.hpp"

namespace rubicon::peis {

/// Who connects to whom (A9).
struct connection_config {
  /// Links to these addresses are always kept (AUT-01): `tcp://host:port`, `inproc://id`, ...
  std::vector<std::string> always;
  bool leaf = false;     ///< only these and links within the host (LEA-01)
  bool manager = true;   ///< false: no other links than these (CM-12)
  bool announces = true; ///< says every second on the group of announcements that we are there
  std::size_t links_min = 3;
  std::size_t links_suitable = 7;
  std::size_t links_max = 20; ///< not counting those of `always` and of cluster merges (CM-09)
  duration manager_period = 3s;
  duration cluster_period = 2s;
  duration announce_period = 1s;
  duration connect_timeout = 5s;
  duration always_retry = 5s; ///< grows to always_retry_max while it fails
  duration always_retry_max = 30s;
  double forced_octets_per_second = 2000; ///< to one host: a direct link is forced (CM-03)
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
  connection_config connections;

  std::size_t links_max = 64;
  std::size_t queue_capacity = 1024; ///< packages per link and class
  /// Octets handed out per link that the owner has not reported with on_link_sent(). 0: the owner
  /// takes everything at once and never reports.
  std::size_t link_window = 0;
  delivery_config reliable;
  reassembly_config assembly;
  duration ack_delay = 10ms;
  duration routing_period = 10s;
  duration trigger_gap = 500ms; ///< least time between two triggered routing sendings
  duration link_timeout = 30s;  ///< a link on which nothing arrives is closed
  duration handshake_timeout = 5s;
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
  std::uint64_t retransmissions = 0;
  std::uint64_t acks_sent = 0; ///< ids, not packages
  std::uint64_t ack_packages_sent = 0;
  std::uint64_t acks_received = 0;
  std::uint64_t messages_delivered = 0; ///< reliable ones, acknowledged in full
  std::uint64_t messages_failed = 0;    ///< reliable ones, after they had been accepted
  std::uint64_t routing_sendings = 0;
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
  std::uint64_t duplicate_id = 0;        ///< somebody else uses our id (RTE-08)
  // Dropped on sending.
  std::uint64_t queue_full = 0;
  std::uint64_t early_drop = 0;
  std::uint64_t queued_lost = 0; ///< unreliable, was queued when its link closed
};

/// What is known of a link, for kernel.connections, the tools and the report.
struct link_view {
  link_id link;
  std::optional<peer_id> neighbour;
  std::uint64_t octets_in = 0;
  std::uint64_t octets_out = 0;
  double loss = 0;        ///< share of packages that the neighbour sent and we missed, 0..1
  std::size_t queued = 0; ///< packages that wait to leave
};

/// Works on links that the owner names and carries octets for. Calls collect events; take_events()
/// and flush() hand them out, so that packages of one occasion leave each link in one piece.
class p2p {
public:
  p2p() = default;
  p2p(p2p_config config, random_stream dice, instant now);

  void on_link_open(link_id link, link_role role, instant now,
                    std::optional<attempt_id> attempt = std::nullopt);
  void on_attempt_failed(attempt_id attempt, instant now);
  void on_announcement(byte_view octets, instant now);
  void on_link_octets(link_id link, byte_view octets, instant now);
  void on_link_sent(link_id link, std::size_t octets);
  void on_link_closed(link_id link, instant now);
  void on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// One message to one peer; how it ended comes as an event, at once for what is known at once.
  struct posting {
    peer_id destination;
    std::uint16_t port = 0;
    message_octets content;
    bool reliable = true;
    priority class_of_service = priority::normal;
    request_id id;
  };
  void send(posting x);

  /// To every peer that can be reached; up to 1024 octets.
  [[nodiscard]] cause broadcast(std::uint16_t port, payload octets);

  /// The exit broadcast (peis-wire.md 11). No routing is sent from then on.
  void leave();
  [[nodiscard]] bool has_left() const { return left_; }

  /// What has happened since the last call; without to_link.
  [[nodiscard]] events take_events() { return std::exchange(events_, {}); }

  /// Writes what the links have room for. Adds to_link events, and others.
  void flush(instant now);

  [[nodiscard]] const p2p_config& config() const { return config_; }
  [[nodiscard]] const host_record& self() const { return self_; }
  [[nodiscard]] bool reachable(peer_id host) const { return way_to(host).has_value(); }
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
    std::uint8_t cost = 0;
    stream_decoder decoder;
    page_collection pages;
    outgoing_queue queue;
    bytes preamble; ///< goes out before any package
    std::uint32_t counter = 0;
    std::size_t unreported = 0; ///< octets handed out, not yet reported as sent
    instant last_heard;
  };

  struct acquaintance {
    host_record record;
    bool announced = false; ///< host_appeared was told
  };

  // p2p_links.cpp: links, greeting, writing
  void accept(connection& from, byte_view request, instant now);
  void greet(connection& to, instant now);
  void bind_neighbour(connection& x, peer_id neighbour);
  void close(link_id link, close_cause why, instant now);
  void forget_link(link_id link, instant now);
  void check_silence(instant now);
  void watch_silence(const connection& x);
  [[nodiscard]] duration patience(const connection& x) const;
  [[nodiscard]] bool write(connection& to, instant now);
  void count_drop(cause why);

  // p2p.cpp: packages
  void on_package(link_id from, const package_header& header, byte_view data, instant now);
  void on_fragment(const package_header& header, byte_view data, instant now);
  void acknowledge(const package_header& header, instant now);
  void send_acknowledgements(peer_id to, const std::vector<std::int32_t>& ids);
  void on_acknowledgement(byte_view data);
  void serve(link_id from, const package_header& header, byte_view data, instant now);
  void forward(link_id from, package_header header, byte_view data);
  [[nodiscard]] cause send_unreliable(const posting& x, link_id way);
  void pump(peer_id destination);
  void repeat_due(instant now);
  void fail(const reliable_message& x, cause why);
  [[nodiscard]] package_header fresh_header(package_type type, std::uint16_t port,
                                            std::size_t length);
  cause enqueue(connection& to, lane where, outgoing_package x);
  cause flood(const package_header& header, const std::shared_ptr<const message_octets>& content,
              std::optional<link_id> except);
  [[nodiscard]] std::optional<link_id> way_to(peer_id destination) const;

  // p2p_hosts.cpp: routing and hosts
  void on_routing(link_id from, byte_view data, instant now);
  void apply(const routing_changes& changes, instant now);
  void send_routing(instant now);
  void send_routing_to(connection& to);
  void trigger_routing(instant now);
  void on_period(instant now);
  void ask_about(peer_id stranger);
  void note_stranger(peer_id id);
  [[nodiscard]] bool answer_query(const package_header& header, byte_view data);
  void on_host_record(link_id from, const package_header& header, byte_view data, instant now);
  void store_record(link_id from, const host_record_message& message, instant now);
  void welcome(peer_id id);
  void on_dead_host(const package_header& header, byte_view data, instant now);
  void delete_host(peer_id id, dead_host_message::reason why, instant now);
  void close_links_to(peer_id id, close_cause why, std::optional<link_id> except, instant now);

  p2p_config config_;
  random_stream dice_;
  host_record self_;
  bool left_ = false;

  std::map<link_id, connection> connections_;
  std::map<peer_id, link_id> neighbours_; ///< the oldest link to each (peis-wire.md 3.6)
  routing_table routing_;
  std::map<peer_id, acquaintance> hosts_; ///< others
  std::set<peer_id> strangers_;    ///< can be reached, but there is no fitting record of them
  std::vector<peer_id> newcomers_; ///< of them, not asked about yet
  std::uint64_t questions_ = 0;    ///< alternates the two ways of asking (KH-02)

  seen_ids seen_;
  reassembly assembly_;
  acknowledger acknowledger_;
  delivery delivery_;
  std::set<peer_id> stalled_; ///< destinations whose next package found its queue half full

  instant next_period_;
  std::optional<instant> next_trigger_;
  instant last_trigger_;
  std::optional<instant> next_silence_check_;

  events events_;
  p2p_counters counters_;
};

} // namespace rubicon::peis
