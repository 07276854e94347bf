// Links between PEIS peers, and the simulated networks that they go through: one of cables, one of
// Bluetooth.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "actors/messages/common.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/media/simulated_media.hpp"

namespace rubicon {

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

/// Where this peer listens may have changed: a network has come, gone or got another address.
struct addresses_changed {};
RUBICON_FIELDS(addresses_changed);

/// The far end of an in-process link.
struct link_end_interface : takes<link_octets, link_closed> {};
using link_end_actor = ref<link_end_interface>;

using peis::link_condition;

/// A link is up. Both ends of a simulated one know it by the same number; a real one has no
/// `other`.
struct link_opened {
  std::uint64_t link = 0;
  link_end_actor other;
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
  std::array<std::uint8_t, 4> from = {}; ///< the sender's address; all 0: it has none
};
RUBICON_FIELDS(announcement, octets, from);

/// A link's medium has taken so many octets; also to itself, when a simulated link has sent them.
struct link_sent {
  std::uint64_t link = 0;
  std::uint64_t octets = 0;
};
RUBICON_FIELDS(link_sent, link, octets);

/// A peer, as the simulated network sees it.
struct lan_user_interface
    : extends<link_end_interface, link_opened, condition_changed, attempt_failed, announcement> {};
using lan_user_actor = ref<lan_user_interface>;

/// A peer has started: others reach it at `inproc://id` from now on, until it ends. `station` is
/// its own, no other has or had it.
struct join_lan {
  std::uint64_t station = 0;
  peer_id id;
  bool hears = true; ///< announcements
  lan_user_actor user;
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
struct peis_lan_interface : takes<join_lan, lan_connect, lan_announce, lan_link_ended,
                                  set_lan_power, begin_lan_fault, end_lan_fault> {};
using peis_lan_actor = ref<peis_lan_interface>;

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
struct hello_sender_interface : takes<hello_answer> {};
using hello_sender_actor = ref<hello_sender_interface>;

/// A HELLO has come to an adapter of this peer: a hello_answer is to go back. `question` is one
/// with the sender's octets.
struct hello_arrived {
  hello_answer question;
  hello_sender_actor sender;
};
RUBICON_FIELDS(hello_arrived, question, sender);

/// The same at a real adapter; the answer goes back over the connection of this number.
struct real_hello {
  std::uint64_t connection = 0;
  payload octets;
};
RUBICON_FIELDS(real_hello, connection, octets);

/// A link over Bluetooth is up.
struct bluetooth_opened {
  link_opened link;
  std::uint64_t rate_bps = 0; ///< 0: unlimited
};
RUBICON_FIELDS(bluetooth_opened, link, rate_bps);

/// A peer, as Bluetooth sees it.
struct bluetooth_user_interface : extends<link_end_interface, bluetooth_seen, hello_answer,
                                          hello_arrived, bluetooth_opened, attempt_failed> {};
using bluetooth_user_actor = ref<bluetooth_user_interface>;

/// A peer has started, and opens adapters of its machine. They stay where they are if others have
/// opened them before.
struct join_bluetooth {
  std::uint64_t station = 0;
  std::string machine;
  std::vector<std::string> adapters;
  position place;
  std::uint16_t port = 0; ///< where it takes links
  bluetooth_user_actor user;
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
struct peis_bluetooth_interface
    : takes<join_bluetooth, scan_bluetooth, send_hello, bluetooth_connect, lan_link_ended,
            set_lan_power, move_machine> {};
using peis_bluetooth_actor = ref<peis_bluetooth_interface>;

} // namespace rubicon
