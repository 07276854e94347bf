// One PEIS kernel: what a component of the ecology (gateway, proxy, robot, PC) joins the network
// with. Byte-compatible with the G6 kernels (specs/peis-wire.md).
#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/random.hpp"
#include "core/time.hpp"
#include "peis/p2p.hpp"
#include "peis/tuple.hpp"
#include "peis/tuple_space.hpp"
#include "peis/types.hpp"

namespace rubicon::peis {

/// What a kernel is made of. Only `network` is enough to start; `network.id` must be 1..65535.
struct kernel_config {
  p2p_config network; ///< id, names, network string, queue sizes, times
  tuple_space_config tuples;
  std::string user = "unknown";  ///< value of kernel.user
  std::vector<peer_id> managers; ///< may write our kernel.do-quit, besides peers of our host
};

// to_link, close_link, connect_to and announce: peis/p2p_events.hpp; tuple_changed and
// tuple_deleted: peis/tuple_space.hpp.

/// A whole message for a hooked port.
struct message {
  std::uint16_t port = 0;
  peer_id source;
  bool broadcast = false;
  payload octets;
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

using output = std::variant<to_link, close_link, connect_to, announce, tuple_changed, tuple_deleted,
                            message, outcome, host_appeared, host_vanished, quit_requested>;
using outputs = std::vector<output>;

/// Everything counted; nothing is dropped without appearing here.
struct kernel_counters {
  p2p_counters network;
  tuple_counters tuples;
  std::uint64_t unhooked = 0; ///< messages for ports that nobody has hooked or that we do not serve
};

/// A kernel over links that its owner supplies: reliable, ordered octet streams of any medium.
/// Packages leave in the order of their priority as long as the link's window has room: see
/// p2p_config::link_window and on_link_sent().
///
/// Every call may return octets for any link. Calls carry the current time, which never goes back;
/// the owner calls on_time() when deadline() has come. A default-constructed kernel has id 0 and
/// may only be assigned to.
class kernel {
public:
  kernel() = default;

  /// Publishes kernel.hostname, .version, .name, .user, .id and .do-quit (peis-wire.md 18).
  /// @pre config.network.id is 1..65535
  kernel(kernel_config config, random_stream dice, instant now);

  // What the world does.

  /// A link is up. An initiator's request and greeting are among the outputs; an acceptor waits for
  /// the other side's request and then answers with its greeting (peis-wire.md 3.2, 3.3).
  /// @param attempt the attempt that brought it about, if it was one of ours
  [[nodiscard]] outputs on_link_open(link_id link, link_role role, instant now,
                                     std::optional<attempt_id> attempt = std::nullopt);

  /// Nobody answered, or not us.
  [[nodiscard]] outputs on_attempt_failed(attempt_id attempt, instant now);

  /// A datagram of the group of announcements, our own included.
  [[nodiscard]] outputs on_announcement(byte_view octets, instant now);

  /// Octets have arrived, in any pieces. Ignored for links that are not open.
  [[nodiscard]] outputs on_link_octets(link_id link, byte_view octets, instant now);

  /// The medium has taken `octets` of what to_link gave it. Needed only when link_window is not 0.
  [[nodiscard]] outputs on_link_sent(link_id link, std::size_t octets, instant now);

  /// The link is gone; it can come back only as a new one.
  [[nodiscard]] outputs on_link_closed(link_id link, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()

  /// When on_time() is due.
  [[nodiscard]] std::optional<instant> deadline() const;

  // Tuples.

  /// Creates or updates an own tuple and pushes it to its subscribers (TUP-04). The outcome, if
  /// asked for, comes at once: bad_key, bad_value, refused (space full), left.
  [[nodiscard]] outputs set_tuple(std::string_view key, tuple_content content, instant now,
                                  request_id request = no_request);

  /// Removes an own tuple here and at its subscribers (TUP-16); succeeds if there is none.
  [[nodiscard]] outputs delete_tuple(std::string_view key, instant now,
                                     request_id request = no_request);

  /// Asks `owner` to set (TUP-05) or delete one of its tuples. The outcome says whether the owner
  /// has acknowledged the request; a real kernel may still have refused it (peis-wire.md 15.3). An
  /// owner without route fails at once (API-02). Our own id acts locally.
  [[nodiscard]] outputs set_remote_tuple(peer_id owner, std::string_view key, tuple_content content,
                                         request_id request, instant now);
  [[nodiscard]] outputs delete_remote_tuple(peer_id owner, std::string_view key, request_id request,
                                            instant now);

  /// Subscribes to the tuples of `owner` (or any_peer, which includes our own) whose keys match
  /// `pattern`, now and of hosts that join later (TUP-08, TUP-11). What matches already is among
  /// the outputs; from then on each change and deletion is told once per subscription. The outcome,
  /// if asked for, comes at once: bad_key, refused (id in use, or too many), left.
  [[nodiscard]] outputs subscribe(peer_id owner, std::string_view pattern, subscription_id id,
                                  instant now, request_id request = no_request);

  /// Nothing for an unknown id. Tuples held for nobody else are forgotten without a word.
  [[nodiscard]] outputs unsubscribe(subscription_id id, instant now);

  // Messages.

  /// Sends up to 16 MiB to a user port of one peer (API-02). The outcome comes once (API-04).
  [[nodiscard]] outputs send_message(peer_id destination, std::uint16_t port, payload octets,
                                     bool reliable, priority class_of_service, request_id request,
                                     instant now);

  /// Sends up to 1024 octets to every peer that can be reached (API-07). The outcome, if asked for,
  /// says only whether it was accepted.
  [[nodiscard]] outputs broadcast(std::uint16_t port, payload octets, request_id request,
                                  instant now);

  /// Messages for this port become outputs from now on; without this they are counted and dropped.
  /// @returns false unless the port is 20..49 (API-09)
  bool hook_port(std::uint16_t port);

  /// Tells everybody that this peer exits (KH-04). Commands fail from then on; close the links when
  /// the octets are out.
  [[nodiscard]] outputs leave(instant now);

  // Looking, without sending anything (TUP-14).

  [[nodiscard]] peer_id id() const;

  /// The tuple of that owner and full key, own or held because of a subscription; nullptr if none.
  /// Valid until the next call that is not const.
  [[nodiscard]] const tuple* find_tuple(peer_id owner, std::string_view key) const;

  /// Own tuples, ascending by key without letter case.
  [[nodiscard]] std::vector<const tuple*> own_tuples() const;

  /// All tuples held that match, ascending by key, then owner; any_peer matches every owner.
  [[nodiscard]] std::vector<const tuple*> find_tuples(peer_id owner,
                                                      std::string_view pattern) const;

  /// Does anyone subscribe to our tuple of this key (TUP-23)? Local subscriptions count too.
  [[nodiscard]] bool has_subscriber(std::string_view key) const;

  /// Known hosts, ourselves included, ascending by id (API-01).
  [[nodiscard]] std::vector<const host_record*> hosts() const;

  /// Can a message be sent to that peer now?
  [[nodiscard]] bool reachable(peer_id host) const;

  /// Time as tuples carry it: the ecology's time plus p2p_config::clock_offset.
  [[nodiscard]] timestamp network_time(instant now) const;

  [[nodiscard]] kernel_counters counters() const;

private:
  outputs finish(instant now);
  void handle(to_link& x, instant now);
  void handle(close_link& x, instant now);
  void handle(connect_to& x, instant now);
  void handle(announce& x, instant now);
  void handle(host_appeared& x, instant now);
  void handle(host_vanished& x, instant now);
  void handle(forgotten_by& x, instant now);
  void handle(arrived& x, instant now);
  void handle(delivered& x, instant now);
  void handle(undelivered& x, instant now);
  void on_set(peer_id source, bytes octets, instant now);
  [[nodiscard]] bool may_stop_us(peer_id source) const;
  void perform(tuple_events todo);
  void report(request_id request, cause why);
  [[nodiscard]] outputs ask(peer_id owner, std::string_view name,
                            std::optional<tuple_content> content, request_id request, instant now);
  [[nodiscard]] static bool is_user_port(std::uint16_t port);
  [[nodiscard]] cause refusal(const result<key>& name);

  kernel_config config_;
  p2p network_;
  tuple_space tuples_;
  std::bitset<port::count> hooked_;
  std::uint64_t unhooked_ = 0;
  std::uint64_t refused_ = 0;
  outputs out_;
};

} // namespace rubicon::peis
