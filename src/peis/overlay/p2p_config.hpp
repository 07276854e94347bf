// How the network layer of a peer is configured, and what others may have it keep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/delivery/delivery.hpp"
#include "peis/delivery/reassembly.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "peis/overlay/connection_manager.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// In a network of so many hosts or more, each announces itself more rarely, and what can wait
/// does.
inline constexpr std::size_t hosts_many = 50;

/// How many entries tables may have that others fill (docs/security.md).
struct table_limits {
  std::size_t hosts = 4480;     ///< two routing tables of the greatest size
  std::size_t routes = 4480;    ///< a link brings at most as many as are free
  std::size_t contacts = 8192;  ///< how connecting to a host has gone
  std::size_t heard_over = 128; ///< of each link
  std::size_t answers = 4096;   ///< to questions about hosts, not acknowledged yet
  std::size_t probes = 512;
  std::size_t seen = 65536; ///< ids of packages; the link that has brought the most forgets first
  std::uint64_t questions_per_second = 1000; ///< about hosts that are not described yet
  duration table_gap = 250ms; ///< between two routing tables of a link, at least, in the long run
  std::uint64_t routing_work_per_second = 100'000; ///< of all routing tables together
};

struct p2p_config {
  peer_id id;
  std::string name = "rubicon";    ///< of the component
  std::string host_name = "local"; ///< equal names mean the same machine: link cost 1 instead of 2
  std::string network = "default"; ///< up to 62 characters; peers of other networks are refused
  std::uint32_t process = 0;       ///< in the full name, name@host!process
  std::vector<low_level_address> addresses; ///< where we listen; up to 16, sent to others
  /// Network time minus ecology time. In wall mode the Unix time of the ecology's start.
  duration clock_offset = 1'000'000'000s;
  std::int64_t clock_ppb = 0; ///< by which the local clock runs fast, parts per billion
  duration clock_period = 2s;
  bool time_master = false; ///< our clock is that of all peers (CLK-06)
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
  /// Links from this number on lead to other processes, which are sent no in-process addresses.
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
  duration lost_timeout = 3s;      ///< a host without any route is forgotten, in place of ageing
  duration probe_timeout = 1500ms; ///< of a route that may lead in circles
  // With neighbours of another kind, which do not beat:
  duration sign_after = 3s;       ///< of silence, a sign of life is asked for
  duration sign_timeout = 3s;     ///< without one, or nothing leaving: another link is tried beside
  duration original_timeout = 2s; ///< of an attempt, in place of connections.connect_timeout
  duration handshake_timeout = 5s;
  duration greeting_timeout = 3s; ///< of a link of ours on which no answer has ever come
  std::uint8_t metric_limit = 30;
  std::uint8_t cost_same_host = 1;
  std::uint8_t cost_other_host = 2;
};

} // namespace rubicon::peis
