// A PEIS kernel and the components that use it (D1.1 3.1.3).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"

namespace rubicon {

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
struct peis_client_interface : takes<tuple_event, peis_message, peis_outcome> {};
using peis_client_actor = ref<peis_client_interface>;

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
  peis_client_actor client;
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
  peis_client_actor client;
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
  peis_client_actor client;
  std::uint64_t token = 0;
  peer_id owner;
  std::string key;
  std::string reference; ///< as above
};
RUBICON_FIELDS(set_meta_tuple, client, token, owner, key, reference);

/// As watch_tuples, to the tuple that a meta tuple points at, whichever that is at the time
/// (META-02).
struct watch_indirectly {
  peis_client_actor client;
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

struct subscribers_watcher_interface : takes<subscribers_changed> {};
using subscribers_watcher_actor = ref<subscribers_watcher_interface>;

/// Asks by which keys and patterns anybody subscribes to own tuples with this first part (in lower
/// case): told now and after each change, to the one who has asked last (TUP-23, GW-10).
struct watch_subscribers {
  subscribers_watcher_actor watcher;
  std::string first_part;
};
RUBICON_FIELDS(watch_subscribers, watcher, first_part);

/// Network time is so much ahead of ecology time (CLK-06).
struct clock_changed {
  duration offset{};
};
RUBICON_FIELDS(clock_changed, offset);

struct clock_watcher_interface : takes<clock_changed> {};
using clock_watcher_actor = ref<clock_watcher_interface>;

/// Asks for the kernel's clock: told now and after each change, to all who have asked (CLK-08).
struct watch_clock {
  clock_watcher_actor watcher;
};
RUBICON_FIELDS(watch_clock, watcher);

/// Every package on this port is for the client (D1.1 3.1.3 registerHook).
struct hook_port {
  peis_client_actor client;
  std::uint16_t port = 0;
};
RUBICON_FIELDS(hook_port, client, port);

/// D1.1 3.1.3 sendMessage; a peis_outcome follows.
struct send_peis_message {
  peis_client_actor client;
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

struct init_interface; // actors/messages/services.hpp
using init_actor = ref<init_interface>;

/// From its init: the kernel asks it before it ends. kernel_guarded follows.
struct guard_kernel {
  init_actor init;
};
RUBICON_FIELDS(guard_kernel, init);

/// One PEIS kernel.
struct peis_peer_interface
    : extends<lan_user_interface, addresses_changed, bluetooth_seen, hello_answer, hello_arrived,
              real_hello, bluetooth_opened, link_sent, set_tuple, delete_tuple, set_remote_tuple,
              watch_tuples, declare_meta_tuple, set_meta_tuple, watch_indirectly, watch_subscribers,
              watch_clock, hook_port, send_peis_message, broadcast_peis_message, pause_peer,
              resume_peer, step_clock, leave_network, quit_peer, guard_kernel, timer_expired,
              status_request> {};
using peis_peer_actor = ref<peis_peer_interface>;

} // namespace rubicon
