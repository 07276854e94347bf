// Channels over packets that may be lost, repeated or reordered: to another island, between a mote
// and a PC, and between PCs (PAR-01, PAR-02, PAR-05).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "transport/answer_slack.hpp"
#include "transport/tunnel_message.hpp"

namespace rubicon::transport {

struct tunnel_tag;

/// A tunnel of this node; never used again.
using tunnel_id = strong_id<tunnel_tag, std::uint32_t>;

/// Why a tunnel is not, or no longer, there.
enum class tunnel_end : std::uint8_t {
  refused,     ///< the other end does not want it or has no room; or there is no room here
  unreachable, ///< no answer came
  closed,      ///< by the other end, or it has been started again
  silent,      ///< nothing has been received from the other end for too long
};

[[nodiscard]] std::string_view to_string(tunnel_end x);

/// Hand this to the packet service, as the body of a packet of tunnel_channel.
struct packet_out {
  mote_address destination; ///< no_mote in the mote part: the PC of that island
  bytes octets;
};

/// As opener: the tunnel is open.
struct tunnel_connected {
  tunnel_id id;
};

/// As acceptor: somebody has opened a tunnel to us.
struct tunnel_accepted {
  tunnel_id id;
  mote_address source;
};

/// What the other end has sent. As the packets do, it may come twice or out of order, or never.
struct tunnel_received {
  tunnel_id id;
  bytes content;
};

/// The tunnel is gone, also when it never came to be. Nothing of this id follows.
struct tunnel_ended {
  tunnel_id id;
  tunnel_end why = tunnel_end::closed;
};

using tunnels_output =
    std::variant<packet_out, tunnel_connected, tunnel_accepted, tunnel_received, tunnel_ended>;
using tunnels_outputs = std::vector<tunnels_output>;

struct tunnels_config {
  mote_id self;                  ///< no_mote: a PC
  std::uint32_t incarnation = 0; ///< how often this node has been started before, forgetting all
  std::size_t tunnels_max = 3;   ///< that begin or end here
  /// Ended ones whose late connects are not taken for new ones.
  static constexpr std::size_t remembered_max = 4;
  answer_slacks slacks = {}; ///< of all islands, the other end's and our own
  /// After the first connect; doubles with each further one. What answers take longer comes on top,
  /// and twice on top of the time-out: the first may be lost.
  static constexpr duration connect_wait = 1s;
  static constexpr duration connect_wait_max = 8s;
  duration connect_timeout = 30s; ///< until the opener gives up (STR-19)
  /// Having sent nothing for so long, an end says that it is there; where radios sleep no more
  /// often than once in four of their periods.
  duration keep_alive = 10s;
  /// Having received nothing for so long, it ends the tunnel; as many keep-alives of a longer
  /// period, and what answers take longer.
  duration silence = 35s;
};

struct tunnels_counters {
  std::uint64_t connects = 0; ///< as opener
  std::uint64_t connected = 0;
  std::uint64_t retries = 0;  ///< connect messages sent again
  std::uint64_t accepted = 0; ///< as acceptor
  std::uint64_t no_room = 0;  ///< refused, by us, as opener or acceptor
  std::uint64_t refused = 0;  ///< ended so by the other end
  std::uint64_t unreachable = 0;
  std::uint64_t closed = 0; ///< by the other end
  std::uint64_t silent = 0;
  std::uint64_t sent = 0;        ///< contents
  std::uint64_t received = 0;    ///< contents
  std::uint64_t not_sent = 0;    ///< contents: not open, or too long
  std::uint64_t keep_alives = 0; ///< sent
  std::uint64_t strays = 0;      ///< for a tunnel that is not here
  std::uint64_t misdirected = 0; ///< for another node
  std::uint64_t malformed = 0;
};
RUBICON_FIELDS(tunnels_counters, connects, connected, retries, accepted, no_room, refused,
               unreachable, closed, silent, sent, received, not_sent, keep_alives, strays,
               misdirected, malformed);

/// All tunnels that begin or end at one node.
///
///   opener:   connecting --accept--> open --close, silence--> ended
///                 |
///                 +--refuse, close, time-out--> ended
///   acceptor: connect --> open --close, silence--> ended
///
/// A packet for a tunnel that is not here is answered with close: so a node learns that the other
/// end has been started again, and whatever one end has forgotten the other forgets as well.
class tunnels {
public:
  tunnels() = default;
  explicit tunnels(tunnels_config config);

  /// Where own_island is.
  void join(island_id island) { island_ = island; }

  /// tunnel_connected or tunnel_ended comes later; tunnel_ended at once if there is no room here,
  /// or to broadcast.
  [[nodiscard]] std::pair<tunnel_id, tunnels_outputs> connect(mote_address destination,
                                                              instant now);

  /// From either end. @returns nothing: the tunnel is not open, or the content is longer than
  /// tunnel_content_max
  [[nodiscard]] std::optional<tunnels_outputs> send(tunnel_id id, byte_view content, instant now);

  /// From either end, which gets no event for it; the other end gets tunnel_ended. A tunnel that is
  /// not here: nothing.
  [[nodiscard]] tunnels_outputs close(tunnel_id id);

  /// As close(), but the opener is notified that it is refused.
  [[nodiscard]] tunnels_outputs refuse(tunnel_id id);

  /// The body of a packet of tunnel_channel from `source_island`.
  [[nodiscard]] tunnels_outputs on_packet(island_id source_island, byte_view octets, instant now);

  [[nodiscard]] tunnels_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  struct route {
    mote_address peer;   ///< the other end
    duration round_trip; ///< to it and back, as the set-up has shown
  };

  /// Nothing: the tunnel is not open, or nothing has come back yet.
  [[nodiscard]] std::optional<route> route_of(tunnel_id id) const;

  [[nodiscard]] std::optional<mote_address> peer_of(tunnel_id id) const; ///< who is at its end
  [[nodiscard]] std::size_t size() const { return entries_.size(); }     ///< connecting or open
  [[nodiscard]] const tunnels_counters& counters() const { return counters_; }

  /// Octets on a mote.
  [[nodiscard]] std::size_t footprint() const {
    return config_.tunnels_max * 28 + config_.remembered_max * 8 + 16;
  }

private:
  struct tunnel {
    mote_address peer;
    std::uint16_t number = 0; ///< the opener's
    bool opened_here = false;
    tunnel_life peer_life = 0; ///< 0: connecting
    instant sent;
    instant last_received; ///< connecting: when it began
    duration wait{0};      ///< connecting: before the next connect
    std::optional<duration> round_trip{};
  };

  /// A tunnel that was accepted here and has ended.
  struct memory {
    mote_address peer;
    std::uint16_t number = 0;
    tunnel_life peer_life = 0;

    friend bool operator==(const memory&, const memory&) = default;
  };

  using entry = std::map<tunnel_id, tunnel>::iterator;
  using kind = tunnel_message::kind;

  [[nodiscard]] entry find(mote_address from, const tunnel_message& x);
  [[nodiscard]] answer_slack slack_to(mote_address peer) const;
  [[nodiscard]] duration keep_alive_of(const tunnel& x) const;
  [[nodiscard]] duration patience_with(const tunnel& x) const;
  [[nodiscard]] instant due(const tunnel& x) const;
  [[nodiscard]] packet_out packet(const tunnel& x, kind what, byte_view content = {}) const;
  [[nodiscard]] packet_out answer(mote_address to, const tunnel_message& x, kind what) const;
  [[nodiscard]] tunnels_outputs end_here(tunnel_id id, kind what);
  [[nodiscard]] bool is_late(mote_address from, const tunnel_message& x, tunnels_outputs& out);
  void forget(entry x);
  void end(entry x, tunnel_end why, tunnels_outputs& out);
  void on_connect(mote_address from, const tunnel_message& x, tunnels_outputs& out, instant now);
  void on_open(entry at, tunnel_message& x, tunnels_outputs& out, instant now);
  void on_due(entry x, tunnels_outputs& out, instant now);

  tunnels_config config_;
  tunnel_life life_ = 1;
  island_id island_ = own_island;
  std::uint32_t last_id_ = 0;
  std::uint16_t last_number_ = 0;
  std::map<tunnel_id, tunnel> entries_;
  std::vector<memory> ended_; ///< the oldest first
  tunnels_counters counters_;
};

} // namespace rubicon::transport
