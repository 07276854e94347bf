// One PEIS kernel: what a component of the ecology (gateway, proxy, robot, PC) joins the network
// with. Byte-compatible with the G6 kernels (docs/peis-wire.md).
#pragma once

#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "peis/kernel/kernel_statistics.hpp"
#include "peis/p2p/p2p.hpp"
#include "peis/space/tuple_space.hpp"
#include "peis/tuples/meta_tuple.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/tuples/tuple_result_set.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// What a kernel is made of. Only `network` is enough to start; `network.id` must be 1..65535.
struct kernel_config {
  p2p_config network; ///< id, names, network string, queue sizes, times
  tuple_space_config tuples;
  std::string user = "unknown";  ///< value of kernel.user
  std::vector<peer_id> managers; ///< may write our kernel.do-quit, besides peers of our host
};

// to_link, close_link, read_link, pace_link, connect_to and announce: peis/overlay/p2p_events.hpp;
// tuple_changed and tuple_deleted: peis/space/tuple_events.hpp.

/// A whole message for a hooked port.
struct message {
  std::uint16_t port = 0;
  peer_id source;
  bool broadcast = false;
  payload octets;
  provenance from = {};
};

/// How a request ended, once per request. Success of a reliable request means that the destination
/// has acknowledged all of it, of an unreliable one that it is on its way.
struct outcome {
  request_id request;
  bool success = false;
  cause why = cause::none;
};

/// Somebody allowed to has written our kernel.do-quit (TUP-22): leave() and end.
struct quit_requested {
  peer_id by;
};

/// Our tuple debug_key was set: by a component of ours, or by another peer (NFR-02). A kernel alone
/// writes no debug log; its owner may.
struct debug_requested {
  std::string text;
};

/// Whose messages a debug log has.
inline constexpr std::string_view debug_key = "rubicon.debug";

using output = std::variant<to_link, close_link, read_link, pace_link, connect_to, announce,
                            tuple_changed, tuple_deleted, message, outcome, host_appeared,
                            host_vanished, quit_requested, traced, id_taken, namesake_found,
                            intercepted, scan_adapter, say_hello, debug_requested>;
using outputs = std::vector<output>;

/// Everything counted; nothing is dropped without appearing here.
struct kernel_counters {
  p2p_counters network;
  tuple_counters tuples;
  std::uint64_t unhooked = 0; ///< messages for ports that nobody has hooked or that we do not serve
};
RUBICON_FIELDS(kernel_counters, network, tuples, unhooked);

/// A kernel over links that its owner supplies: reliable, ordered octet streams of any medium.
/// Packages leave in the order of their priority as long as the link's window has room: see
/// p2p_config::link_window and on_link_sent().
///
/// Every call may return octets for any link. Calls carry the current time, which never goes back;
/// the owner calls on_time() when deadline() has come. A default-constructed kernel has id 0 and
/// may only be assigned to.
class kernel {
public:
  kernel();
  ~kernel(); // these are large: compiled once
  kernel(kernel&&) noexcept;
  kernel& operator=(kernel&&) noexcept;

  /// Publishes kernel.hostname, .version, .name, .user, .id and .do-quit (docs/peis-wire.md 18).
  /// @pre config.network.id is 1..65535
  kernel(kernel_config config, random_stream rng, instant now);

  // What the world does.

  /// A link is up. An initiator's request and greeting are among the outputs; an acceptor waits for
  /// the other side's request and then answers with its greeting (docs/peis-wire.md 3.2, 3.3).
  /// @param attempt the attempt that brought it about, if it was one of ours
  [[nodiscard]] outputs on_link_open(link_id link, link_role role, instant now,
                                     std::optional<attempt_id> attempt = std::nullopt);

  /// Nobody answered, or not us.
  [[nodiscard]] outputs on_attempt_failed(attempt_id attempt, instant now);

  /// A datagram of the group of announcements, our own included.
  [[nodiscard]] outputs on_announcement(byte_view octets, instant now,
                                        std::optional<ipv4_address> from = std::nullopt);

  /// What an adapter sees now, strengths in dBm: its devices become tuples (BT-04), and those that
  /// are strong enough are asked who they are.
  [[nodiscard]] outputs on_bluetooth_scan(std::string_view adapter,
                                          std::span<const seen_device> seen, instant now);

  /// One of the peers at a device has answered a HELLO; nobody has, if `octets` is empty.
  [[nodiscard]] outputs on_hello_answer(std::string_view adapter, const bluetooth_address& address,
                                        byte_view octets, instant now);

  /// A HELLO has come: who asks. The answer is hello().
  [[nodiscard]] outputs on_hello(byte_view octets, instant now) {
    return on_announcement(octets, now);
  }

  /// Octets have arrived, in any pieces. Ignored for links that are not open.
  [[nodiscard]] outputs on_link_octets(link_id link, byte_view octets, instant now);

  /// The medium has taken `octets` of what to_link gave it. Needed only when link_window is not 0.
  [[nodiscard]] outputs on_link_sent(link_id link, std::size_t octets, instant now);

  /// The link is gone; it can come back only as a new one.
  [[nodiscard]] outputs on_link_closed(link_id link, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()

  /// When on_time() is due.
  [[nodiscard]] std::optional<instant> deadline() const;

  // Tuples. Names in brackets are those of D1.1 3.1.3. Outcomes of what is decided here come at
  // once; each command may end with bad_key, bad_value, too_long or left.

  /// [setTuple] Creates or updates an own tuple and pushes it to its subscribers (TUP-04). Also
  /// space_full; abstract without MIME type.
  [[nodiscard]] outputs set_tuple(std::string_view key, tuple_content content, instant now,
                                  request_id request = no_request);

  /// [insertTuple, after initTuple and setTupleName] The same with all fields: owner, key, value,
  /// MIME type, encoding, user time and expiry of `draft` count; the rest is filled in. Another
  /// owner is asked as by set_remote_tuple(). Abstract if any of these is a wildcard (TUP-06).
  [[nodiscard]] outputs insert_tuple(tuple draft, instant now, request_id request = no_request);

  /// [appendTupleByAbstract] Adds to the value of each existing tuple that matches (TUP-07): of
  /// ours here, of others by asking the owner, or with any_peer all known hosts. Text gets its
  /// trailing NUL if `added` has none. The outcome says for one other owner that it has
  /// acknowledged, else whether it was accepted here; a prototype with a MIME type can be used for
  /// our own tuples only (bad_value), since the request cannot carry it.
  [[nodiscard]] outputs append_tuple(const prototype& wanted, payload added, instant now,
                                     request_id request = no_request);

  /// Removes an own tuple here and at its subscribers (TUP-16); succeeds if there is none.
  [[nodiscard]] outputs delete_tuple(std::string_view key, instant now,
                                     request_id request = no_request);

  /// [setRemoteTuple] Asks `owner` to set (TUP-05) or delete one of its tuples. The outcome says
  /// whether the owner has acknowledged the request; a real kernel may still have refused it
  /// (docs/peis-wire.md 15.3). An owner without route fails at once (API-02). Our own id: locally.
  [[nodiscard]] outputs set_remote_tuple(peer_id owner, std::string_view key, tuple_content content,
                                         request_id request, instant now);
  [[nodiscard]] outputs delete_remote_tuple(peer_id owner, std::string_view key, request_id request,
                                            instant now);

  /// [subscribe] To the tuples of `owner` (or any_peer, which includes our own) whose keys match
  /// `pattern`, now and of hosts that join later (TUP-08, TUP-11). What matches already is among
  /// the outputs; from then on each change and deletion is told once per subscription. The handle
  /// is the caller's `id`: bad_handle if it is in use; space_full.
  [[nodiscard]] outputs subscribe(peer_id owner, std::string_view pattern, subscription_id id,
                                  instant now, request_id request = no_request);
  /// [subscribeByAbstract] To all tuples that match a prototype.
  [[nodiscard]] outputs subscribe(const prototype& wanted, subscription_id id, instant now,
                                  request_id request = no_request);

  /// [registerTupleCallback, ...ByAbstract] Tells of each match that arrives in this tuple space
  /// from now on, or leaves it, as subscribe() does, but asks nobody for any (CB-01).
  [[nodiscard]] outputs register_callback(const prototype& wanted, subscription_id id, instant now,
                                          request_id request = no_request);

  /// [unsubscribe] Ends what subscribe(), register_callback() or their indirect forms began, at any
  /// time (CB-04). Tuples held for nobody else are forgotten without a word. bad_handle: no such
  /// id.
  [[nodiscard]] outputs unsubscribe(subscription_id id, instant now,
                                    request_id request = no_request);

  // Meta tuples, in kernel_meta.cpp. A meta tuple is a tuple like others, usually our own.

  /// [declareMetaTuple] Makes an own tuple a meta tuple that points nowhere, unless it is one
  /// already (META-03).
  [[nodiscard]] outputs declare_meta_tuple(std::string_view key, instant now,
                                           request_id request = no_request);

  /// [setMetaTuple] Points a meta tuple, ours or another's, at a tuple. Abstract: the target is not
  /// one tuple.
  [[nodiscard]] outputs set_meta_tuple(peer_id meta_owner, std::string_view meta_key,
                                       peer_id target_owner, std::string_view target_key,
                                       request_id request, instant now);

  /// [subscribeIndirectly] Subscribes to the meta tuple, and always to just the tuple that it
  /// points at: when it is rewritten, the outputs for `id` are those of the new target from that
  /// moment on (META-02). While it points nowhere or is no meta tuple there are none.
  [[nodiscard]] outputs subscribe_indirectly(peer_id meta_owner, std::string_view meta_key,
                                             subscription_id id, instant now,
                                             request_id request = no_request);
  /// [registerMetaTupleCallback] The same without asking anybody for either tuple.
  [[nodiscard]] outputs register_indirect_callback(peer_id meta_owner, std::string_view meta_key,
                                                   subscription_id id, instant now,
                                                   request_id request = no_request);

  /// [setTupleIndirectly] Sets what the meta tuple, as we hold it, points at. bad_meta_tuple if we
  /// hold none or it points nowhere.
  [[nodiscard]] outputs set_indirectly(peer_id meta_owner, std::string_view meta_key,
                                       tuple_content content, request_id request, instant now);

  // Messages.

  /// Sends up to 16 MiB to a user port of one peer (API-02). The outcome comes once (API-04).
  [[nodiscard]] outputs send_message(peer_id destination, std::uint16_t port, payload octets,
                                     bool reliable, priority class_of_service, request_id request,
                                     instant now);

  /// Sends up to 1024 octets to every peer that can be reached (API-07). The outcome, if asked for,
  /// says only whether it was accepted.
  [[nodiscard]] outputs broadcast(std::uint16_t port, payload octets, request_id request,
                                  instant now);

  /// Asks for the way that packages take to a host and back (API-12): `traced` follows, with an
  /// empty way if nothing came back within 5 s.
  [[nodiscard]] outputs trace(peer_id destination, request_id request, instant now);

  /// Messages for this port become outputs from now on; without this they are counted and dropped.
  /// @returns false unless the port is 20..49 (API-09)
  bool hook_port(std::uint16_t port);

  /// The hook sees what passes through this host on a port, and may stop it:
  /// p2p::set_transit_hook(). What it stops is told as `intercepted`. Messages for us are for
  /// hook_port().
  /// @returns false unless the port is 20..49 (API-09)
  bool hook_transit(std::uint16_t port, transit_hook hook);

  /// The local clock was set to another time, by so much: tuples carry it from now on; no timer of
  /// ours moves (SCH-07).
  [[nodiscard]] outputs step_clock(duration by, instant now);

  /// The owner's main loop has made a step of this length, for kernel.step-time (SCH-06).
  void note_step(duration length) { statistics_.note_step(length); }

  /// Tells everybody that this peer exits (KH-04). Commands fail from then on; close the links when
  /// the octets are out.
  [[nodiscard]] outputs leave(instant now);

  /// As p2p::set_addresses().
  [[nodiscard]] outputs set_addresses(std::vector<low_level_address> all, instant now);

  // Looking, without sending anything (TUP-14).

  [[nodiscard]] peer_id id() const;

  /// [getTuple] The tuple of that owner and full key, own or held because of a subscription, unless
  /// it has expired; it counts as read then (TUP-12). Abstract: owner or key is a wildcard.
  [[nodiscard]] reading get_tuple(peer_id owner, std::string_view key, read_mode mode, instant now);
  /// [getTupleByAbstract] Nothing also if the other fields of the prototype do not match.
  [[nodiscard]] reading get_tuple(const prototype& wanted, read_mode mode, instant now);

  /// [getTuples, getTuplesByAbstract] Appends all that match, ascending by key, then owner; each
  /// counts as read then (TUP-13).
  void get_tuples(const prototype& wanted, result_set& into, instant now,
                  read_mode mode = read_mode::keep_old);

  /// [getTupleIndirectly] What the meta tuple, as we hold it, points at; nothing if it points
  /// nowhere. bad_meta_tuple if we hold none.
  [[nodiscard]] reading get_indirectly(peer_id meta_owner, std::string_view meta_key,
                                       read_mode mode, instant now);

  /// [isMetaTuple] Do we hold such a tuple, and does it say where it points (META-03)?
  [[nodiscard]] bool is_meta_tuple(peer_id owner, std::string_view key) const;

  /// As get_tuple(), without the marks of reading; null if there is none. kernel.* tuples that
  /// nobody watches may be older than their period.
  [[nodiscard]] tuple_pointer find_tuple(peer_id owner, std::string_view key) const;

  /// Own tuples, ascending by key without letter case.
  [[nodiscard]] std::vector<tuple_pointer> own_tuples() const;

  /// All tuples held that match, ascending by key, then owner; any_peer matches every owner.
  [[nodiscard]] std::vector<tuple_pointer> find_tuples(peer_id owner,
                                                       std::string_view pattern) const;

  /// Does anyone subscribe to our tuple of this key (TUP-23)? Local subscriptions count too.
  [[nodiscard]] bool has_subscriber(std::string_view key) const;

  /// Does the present value of an own tuple still wait for room on its way to a subscriber? If
  /// another is set now, that one never gets this: a writer that wants all to arrive waits.
  [[nodiscard]] bool is_waiting(std::string_view key) const;

  /// Keys and patterns, in lower case, by which somebody subscribes to our tuples and whose first
  /// part is this one; catch-all patterns name nothing. @param first_part in lower case
  [[nodiscard]] std::set<std::string> subscribed(std::string_view first_part) const {
    return tuples_.audience().subscribed(first_part);
  }
  /// Changes whenever subscribed() may.
  [[nodiscard]] std::uint64_t subscribers_version() const { return tuples_.audience().version(); }

  /// Known hosts, ourselves included, ascending by id (API-01).
  [[nodiscard]] std::vector<const host_record*> hosts() const;

  /// The links there are, ascending by number.
  [[nodiscard]] std::vector<link_view> links() const { return network_.view().links.views(); }

  /// The way to every host that is known, lost ones included (RTE-01).
  [[nodiscard]] const routing_table& routing() const { return network_.view().routes.routes(); }

  /// The clock of the ecology as we see it (CLK-06).
  [[nodiscard]] const network_clock& clock() const { return network_.view().clock; }

  /// Who we are, as a HELLO and its answer tell it (BT-05).
  [[nodiscard]] bytes hello() const { return network_.view().own.hello(); }

  /// [bluetoothIsConnectable] BT-06.
  [[nodiscard]] bool bluetooth_is_connectable(const bluetooth_address& address) const {
    return network_.view().adapters.is_connectable(address);
  }

  /// Can a message be sent to that peer now?
  [[nodiscard]] bool reachable(peer_id host) const;
  /// Is that host known by its present incarnation?
  [[nodiscard]] bool knows_present(peer_id host) const;

  /// Time as tuples carry it: the ecology's time plus p2p_config::clock_offset.
  [[nodiscard]] timestamp network_time(instant now) const;

  [[nodiscard]] kernel_counters counters() const;

private:
  /// @param turn input is handled that waits, or has just come
  outputs finish(instant now, bool turn = false);
  void settle(instant now);
  /// What the network says that only the owner can act on.
  template <class T>
  void handle(T& x, instant) {
    out_.emplace_back(std::move(x));
  }
  void handle(host_appeared& x, instant now);
  void handle(id_taken& x, instant now);
  void handle(host_vanished& x, instant now);
  void handle(forgotten_by& x, instant now);
  void handle(arrived& x, instant now);
  void dispatch(arrived& x, instant now);
  void handle(delivered& x, instant now);
  void handle(device_noted& x, instant now);
  void handle(undelivered& x, instant now);
  void on_set(peer_id source, const payload& octets, instant now);
  [[nodiscard]] bool may_stop_us(peer_id source) const;
  void give_up_quits(instant now);
  void perform(tuple_events todo, instant now);
  void report(request_id request, cause why);

  // kernel_tuples.cpp
  [[nodiscard]] outputs ask(std::pair<cause, transmit> question, request_id request, instant now);
  void refuse(request_id request, cause why);
  [[nodiscard]] cause refusal_of_owner(peer_id owner, const key& name, bool quits) const;
  void expect_quit(const tuple& asked, request_id request);
  [[nodiscard]] outputs watch(const prototype& wanted, tuple_space::interest kind,
                              subscription_id id, request_id request, instant now);
  void publish(const kernel_statistics::texts& values, instant now);
  void refresh_statistics(const key& looked_at, instant now);

  // kernel_meta.cpp
  /// Follows a meta tuple for one subscription of the user.
  struct indirection {
    tuple_space::interest kind = tuple_space::interest::subscription;
    subscription_id meta_watch; ///< ours, of the meta tuple
    meta_reference target;      ///< what the user's id subscribes to now
  };
  [[nodiscard]] outputs watch_indirectly(peer_id owner, std::string_view name,
                                         tuple_space::interest kind, subscription_id id,
                                         request_id request, instant now);
  void on_meta_tuple(subscription_id meta_watch, const tuple* content, instant now);
  [[nodiscard]] result<meta_reference> look_up(peer_id meta_owner, std::string_view meta_key,
                                               instant now);
  [[nodiscard]] static bool is_user_port(std::uint16_t port);
  [[nodiscard]] cause refusal(const result<key>& name);

  /// Somebody was asked to quit. Whether he does so is his to decide, and no answer tells it: he
  /// goes, or he does not.
  struct asked_to_quit {
    peer_id owner;
    std::optional<instant> until; ///< set: the question has arrived
  };

  kernel_config config_;
  p2p network_;
  std::map<request_id, asked_to_quit> quits_;
  tuple_space tuples_;
  kernel_statistics statistics_;
  std::map<subscription_id, indirection> indirections_;     ///< by the user's id
  std::map<subscription_id, subscription_id> meta_watches_; ///< ours, to the user's
  std::uint64_t meta_watches_made_ = 0;
  std::bitset<port::count> hooked_;
  std::uint64_t unhooked_ = 0;
  std::uint64_t refused_ = 0;
  std::uint64_t bad_meta_tuples_ = 0;
  work_units events_made_ = 0; ///< by the tuple space, for the message that is handled
  outputs out_;
};

} // namespace rubicon::peis
