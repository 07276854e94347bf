// Reliable messages from the first transmission to the outcome (docs/peis-wire.md 8.2, 8.3).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "peis/link/id_source.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "peis/wire/package.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// How much may be in flight to one destination.
struct delivery_window {
  std::size_t packages = 256; ///< unacknowledged (P2P-05)
  /// How far the newest may be ahead of the oldest unacknowledged one, in packages: a repeat must
  /// find its first transmission in the memory of a real kernel, 4096 ids (ACK-08).
  std::size_t span = 2048;
};

struct delivery_config {
  duration retry_time = 400ms; ///< T: attempt k is followed by a wait of k T (ACK-02)
  delivery_window window;
  /// For a neighbour of our own kind: no relay of limited memory is between.
  delivery_window wide = {1024, 8192};
  // What has not begun to leave, per destination: a stall of 50 ms at 100 000 messages a second.
  std::size_t waiting_max = 8192;                    ///< messages
  std::size_t waiting_octets_max = 64 * 1024 * 1024; ///< beyond the first message
  /// A receiver drops a message 10 s after its last fragment (docs/peis-wire.md 8.3). If none has
  /// left for so long, the message is sent anew.
  duration pause_max = 9500ms;
  unsigned tries_max = 5; ///< to send a message from its first fragment
};

/// A message in flight, also as the owner gets it back when it has ended.
struct reliable_message {
  peer_id source;
  peer_id destination;
  std::uint16_t port = 0;
  priority class_of_service = priority::normal;
  request_id request;
  std::shared_ptr<const message_octets> content;
  std::optional<link_id> for_neighbour = std::nullopt; ///< it answers what came over this link
  provenance from = {};
};

/// Keeps messages until every package of them has been acknowledged. Per destination a window
/// limits what is in flight and three queues hold what has not begun to leave. Knows neither links
/// nor routes: the owner asks for the next package of a destination, queues it, and says when it
/// left.
///
///   waiting --next()--> queued --on_transmitted()--> in flight --acknowledge()--> done
///                         ^                              |
///                         +------ take_due(), 6 times ---+--- the seventh time: failed
class delivery {
public:
  static constexpr unsigned attempts_max = 7; ///< a transmission and six repeats (ACK-03)

  delivery() = default;
  explicit delivery(delivery_config config) : config_(config) {}

  /// @returns false if too many messages wait for that destination
  [[nodiscard]] bool add(reliable_message message, id_source& ids);

  /// The next package for a destination whose window is open, and the lane it belongs to.
  [[nodiscard]] std::optional<std::pair<lane, outgoing_package>>
  next(peer_id destination, id_source& ids, bool wide = false);

  /// Where next() would put its package; nothing if there is none to send.
  /// @param wide the destination is a neighbour of our own kind
  [[nodiscard]] std::optional<lane> next_lane(peer_id destination, bool wide = false) const;

  /// Is a queued package still wanted? Not after its message has failed.
  [[nodiscard]] bool wanted(std::int32_t ack_id) const { return in_flight_.contains(ack_id); }

  /// The package has left: the wait for its acknowledgement begins.
  void on_transmitted(std::int32_t ack_id, instant now);

  /// The package was lost before it left: it is due at once.
  void on_dropped(std::int32_t ack_id, instant now);

  /// What an acknowledgement has brought about.
  struct acknowledged {
    peer_id destination; ///< its window has opened
    std::optional<reliable_message> finished;
  };
  /// @returns nothing for an id that is not in flight
  [[nodiscard]] std::optional<acknowledged> acknowledge(std::int32_t ack_id);

  /// A package whose wait is over.
  struct due {
    std::optional<outgoing_package> again;  ///< to be sent once more, with a new id
    std::optional<reliable_message> failed; ///< or its message has failed
    peer_id destination;
    std::int32_t ack_id = 0;
  };
  /// The next one due; to be called until it returns nothing.
  [[nodiscard]] std::optional<due> take_due(instant now, id_source& ids);

  /// A repeat could not be sent for want of a route: wait as if it had been.
  void on_unsendable(std::int32_t ack_id, instant now) { on_transmitted(ack_id, now); }

  /// Sends long messages to a destination from their first fragment again, under new numbers: those
  /// of which the receiver has, or had, some fragments and not the others. One whose fragments have
  /// all been taken may have arrived; of it only what is not acknowledged is repeated.
  struct anew {
    std::size_t begun = 0;
    std::vector<reliable_message> failed; ///< those that have been tried too often
  };
  [[nodiscard]] anew begin_anew(peer_id destination, id_source& ids);

  /// Destinations with a message of which no fragment has left for too long, since the last call:
  /// begin_anew() is due.
  [[nodiscard]] std::set<peer_id> take_stale() { return std::exchange(stale_, {}); }

  /// The destination of a package in flight; none, if it is no longer wanted.
  [[nodiscard]] std::optional<peer_id> destination_of(std::int32_t ack_id) const;

  /// Gives up everything for a destination. @returns the messages, oldest first
  [[nodiscard]] std::vector<reliable_message> fail_all(peer_id destination);

  /// Nothing is in flight to it, yet messages wait, and none of them has ever begun to leave.
  [[nodiscard]] bool only_waiting(peer_id destination) const;

  /// The same, but some have begun, and are to be sent anew.
  [[nodiscard]] bool waits_anew(peer_id destination) const;

  [[nodiscard]] std::optional<instant> deadline() const;

  /// Packages kept until acknowledged (ACK-01).
  [[nodiscard]] std::size_t in_flight() const { return in_flight_.size(); }

private:
  struct transfer {
    reliable_message message;
    std::uint16_t fragments = 0; ///< 0: a single package
    std::uint16_t seqid = 0;
    std::uint16_t begun = 0; ///< packages that next() has given out
    std::uint16_t unacknowledged = 0;
    std::uint16_t taken = 0; ///< packages that have left, or are acknowledged
    instant last_taken;
    bool paused = false; ///< for longer than its receiver waits
    unsigned tries = 1;

    [[nodiscard]] bool is_broken_off() const {
      return paused || (fragments > 0 && taken > 0 && taken < fragments);
    }
  };

  struct flow {
    std::size_t in_flight = 0;
    std::size_t waiting = 0;
    std::size_t waiting_octets = 0;
    std::array<std::deque<std::uint64_t>, 3> queues; ///< transfers by priority
    std::deque<std::int32_t> order; ///< ack ids as they left; those acknowledged go from the front

    [[nodiscard]] bool idle() const { return in_flight == 0 && waiting == 0; }
  };

  struct pending {
    std::uint64_t transfer = 0;
    std::uint16_t fragment = 0;
    unsigned attempts = 1;
    std::optional<instant> due; ///< unset while queued
    bool taken = false;
  };

  struct wait {
    instant until;
    std::int32_t ack_id = 0;
  };

  [[nodiscard]] static std::uint16_t packages_of(const transfer& x);
  [[nodiscard]] outgoing_package package_of(const transfer& x, std::uint16_t fragment,
                                            std::int32_t ack_id, id_source& ids) const;
  [[nodiscard]] const std::deque<std::uint64_t>* open_queue(const flow& x,
                                                            const delivery_window& window) const;
  reliable_message fail(std::uint64_t id);
  void note_taken(pending& x, instant now);
  void withdraw(std::uint64_t id, transfer& x, flow& to);
  [[nodiscard]] std::set<std::uint64_t> transfers_of(const flow& x) const;
  void shorten(flow& x) const;
  void on_begun(flow& x, const transfer& which) const;
  [[nodiscard]] bool is_current(const wait& x) const;
  void shorten_waits();

  delivery_config config_;
  std::uint64_t next_transfer_ = 0;
  std::map<std::uint64_t, transfer> transfers_;
  std::map<peer_id, flow> flows_;
  std::unordered_map<std::int32_t, pending>
      in_flight_; ///< by ack id; looked up, never walked in order
  /// Those that wait after attempt k, and at 0 those due at once: each ascends by itself. One that
  /// is acknowledged stays until those before it are gone.
  std::array<std::deque<wait>, attempts_max + 1> waits_;
  std::set<peer_id> stale_;
};

} // namespace rubicon::peis
