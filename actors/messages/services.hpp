// Components of a kernel: gateways, proxies, the peisinit, programs of PCs.
#pragma once

#include <cstdint>
#include <string>

#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/serial.hpp"
#include "core/tuples/device_keys.hpp"
#include "proxy/classes/class_change.hpp"

namespace rubicon {

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
struct init_interface
    : extends<peis_client_interface, component_started, component_ended, kernel_guarded,
              quit_wanted, process_output, process_ended, timer_expired, status_request> {};

/// The gateway between an island and the PEIS network.
struct gateway_interface
    : extends<peis_client_interface, subscribers_changed, clock_changed, serial_octets,
              serial_packet, real_octets, serial_presence, timer_expired, status_request> {};
using gateway_actor = ref<gateway_interface>;

/// A serial forwarder for programs of TinyOS.
struct forwarder_server_interface
    : takes<attach_packets, serial_packet, serial_packet_done, status_request> {};
using forwarder_server_actor = ref<forwarder_server_interface>;

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
struct proxy_interface : extends<peis_client_interface, clock_changed, mote_presence,
                                 gateway_changed, program_attached, program_detached,
                                 program_events, change_class, timer_expired, status_request> {};
using proxy_actor = ref<proxy_interface>;

/// To itself: a proxy that has ended may be started again.
struct restart_proxy {
  mote_address mote;
};
RUBICON_FIELDS(restart_proxy, mote);

struct proxy_manager_interface
    : extends<peis_client_interface, restart_proxy, change_class, timer_expired, status_request> {};
using proxy_manager_actor = ref<proxy_manager_interface>;

/// Control programs on peers: the collector.
struct peer_app_interface : extends<peis_client_interface, status_request> {};
using peer_app_actor = ref<peer_app_interface>;

/// The same with deadlines: rules, pursuers of goals; a peer's Communication Layer and the programs
/// that use it.
struct timed_peer_app_interface : extends<peer_app_interface, timer_expired> {};
using timed_peer_app_actor = ref<timed_peer_app_interface>;

/// By a thread of its own: what it waits for outside the ecology has come.
struct outside_input {};
RUBICON_FIELDS(outside_input);

/// A component beside a kernel.
struct component_interface : extends<timed_peer_app_interface, outside_input> {};
using component_actor = ref<component_interface>;

struct pc_interface
    : extends<timed_peer_app_interface, clock_changed, attach_program, program_commands> {};
using pc_actor = ref<pc_interface>;

} // namespace rubicon
