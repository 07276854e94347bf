// One PEIS kernel: what a component of the ecology (gateway, proxy, robot, PC) joins the network
// with. Byte-compatible with the G6 kernels (docs/peis-wire.md).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "peis/kernel/kernel_config.hpp"
#include "peis/kernel/kernel_events.hpp"
#include "peis/kernel/message_commands.hpp"
#include "peis/kernel/meta_commands.hpp"
#include "peis/kernel/subscription_commands.hpp"
#include "peis/kernel/tuple_commands.hpp"
#include "peis/kernel/tuple_reader.hpp"
#include "peis/p2p/p2p.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// A kernel over links that its owner supplies: reliable, ordered octet streams of any medium.
/// Packages leave in the order of their priority as long as the link's window has room: see
/// p2p_config::link_window and on_link_sent(). It has the events of links and of time; commands are
/// those of its parts.
///
/// Every call may return octets for any link. Calls carry the current time, which never goes back;
/// the owner calls on_time() when deadline() has come. A default-constructed kernel has id 0 and
/// may only be assigned to. References to parts stay valid when a kernel is moved.
class kernel {
public:
  kernel();
  ~kernel();
  kernel(kernel&&) noexcept;
  kernel& operator=(kernel&&) noexcept;

  /// Publishes kernel.hostname, .version, .name, .user, .id and .do-quit (docs/peis-wire.md 18).
  /// @pre config.network.id is 1..65535
  kernel(kernel_config config, random_stream rng, instant now);

  [[nodiscard]] tuple_commands& tuples();
  [[nodiscard]] subscription_commands& subscriptions();
  [[nodiscard]] meta_commands& meta_tuples();
  [[nodiscard]] message_commands& messages();
  [[nodiscard]] tuple_reader& reader();
  [[nodiscard]] const tuple_reader& reader() const;

  /// Hosts, links, routes, the clock, adapters.
  [[nodiscard]] p2p_view network() const;

  [[nodiscard]] peer_id id() const;
  [[nodiscard]] kernel_counters counters() const;

  // Events.

  /// A link is up. An initiator's request and greeting are among the outputs; an acceptor waits for
  /// the other side's request and then answers with its greeting (docs/peis-wire.md 3.2, 3.3).
  /// @param attempt the attempt that opened it, if it was one of ours
  [[nodiscard]] outputs on_link_open(link_id link, link_role role, instant now,
                                     std::optional<attempt_id> attempt = std::nullopt);

  /// No answer came, or not to us.
  [[nodiscard]] outputs on_attempt_failed(attempt_id attempt, instant now);

  /// A datagram of the group of announcements, our own included.
  [[nodiscard]] outputs on_announcement(byte_view octets, instant now,
                                        std::optional<ipv4_address> from = std::nullopt);

  /// What an adapter sees now, strengths in dBm: its devices become tuples (BT-04), and those that
  /// are strong enough are asked who they are.
  [[nodiscard]] outputs on_bluetooth_scan(std::string_view adapter,
                                          std::span<const seen_device> seen, instant now);

  /// One of the peers at a device has answered a HELLO; none has, if `octets` is empty.
  [[nodiscard]] outputs on_hello_answer(std::string_view adapter, const bluetooth_address& address,
                                        byte_view octets, instant now);

  /// A HELLO has come: who asks. The answer is own_peer::hello().
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

  /// The local clock was set to another time, by so much: tuples carry it from now on; no timer of
  /// ours moves (SCH-07).
  [[nodiscard]] outputs step_clock(duration by, instant now);

  /// The owner's main loop has made a step of this length, for kernel.step-time (SCH-06).
  void note_step(duration length);

  /// As p2p::set_addresses().
  [[nodiscard]] outputs set_addresses(std::vector<low_level_address> all, instant now);

  /// Broadcasts that this peer exits (KH-04). Commands fail from then on; close the links when the
  /// octets are out.
  [[nodiscard]] outputs leave(instant now);

private:
  struct parts;

  std::unique_ptr<parts> parts_; ///< they refer to each other: they stay where they are
};

} // namespace rubicon::peis
