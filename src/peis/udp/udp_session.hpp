// One session over UDP, seen from one of its ends: octets in order, each once, over a network that
// loses, repeats and reorders (UDP-01, UDP-02).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "peis/udp/udp_datagram.hpp"
#include "peis/udp/udp_rate.hpp"
#include "peis/udp/udp_receiver.hpp"
#include "peis/udp/udp_send_window.hpp"

namespace rubicon::peis {

/// What one UDP port has done, and refused, in all its sessions.
struct udp_counters {
  std::uint64_t sent = 0;         ///< datagrams
  std::uint64_t parts_sent = 0;   ///< of these, with octets of a session
  std::uint64_t parts_resent = 0; ///< of these, once more
  std::uint64_t received = 0;     ///< datagrams
  std::uint64_t malformed = 0;    ///< none of ours, cut, or too long
  std::uint64_t unknown = 0;     ///< of no session or attempt, or from elsewhere than its other end
  std::uint64_t bad_cookies = 0; ///< whose sender has not proved its address
  std::uint64_t repeated = 0;    ///< parts that were there
  std::uint64_t out_of_window = 0; ///< parts for which there was no room
  std::uint64_t impossible = 0;    ///< acknowledged what was never sent
  std::uint64_t unanswered = 0;    ///< beyond the answers that strangers get a second
  std::uint64_t refused = 0;       ///< sessions, there being too many
  std::uint64_t foreign = 0;       ///< asked for a session, from none of the networks
  std::uint64_t unsent = 0;        ///< datagrams that the network did not take
};
RUBICON_FIELDS(udp_counters, sent, parts_sent, parts_resent, received, malformed, unknown,
               bad_cookies, repeated, out_of_window, impossible, unanswered, refused, foreign,
               unsent);

struct udp_session_config {
  /// Parts of each direction that are under way, out of order, or wait for their owner: 692 KB.
  std::size_t parts_max = 512;
  duration silence_max =
      8s; ///< the other side says nothing although something is to be acknowledged
  udp_rate_config rate;
};

/// Datagrams for one address: all have `each` octets but the last, which may have fewer.
struct udp_batch {
  udp_address to;
  bytes octets;
  std::size_t each = 0;
};

/// Cuts octets into parts, of which a window is under way: as many as the rate, the other side's
/// credit and its socket allow. What is lost leaves again, and if nothing is reported, the two
/// oldest parts do. Every segment reports what has come.
class udp_session {
public:
  /// As many datagrams in one batch as a system takes at a time.
  static constexpr std::size_t batch_max = 44;

  udp_session() = default;
  udp_session(udp_token token, udp_address other, udp_session_config config, instant now)
      : token_(token), other_(other), config_(config), rate_(config.rate),
        received_(config.parts_max), last_segment_(now), retry_at_(now) {}

  /// Queues octets. The queue has no bound of its own: the owner counts with take_acknowledged().
  void send(payload octets);

  void on_segment(const udp_segment& x, instant now, udp_counters& counted);

  /// @returns false when the other side is silent for too long: the session is over
  [[nodiscard]] bool on_time(instant now);

  /// Appends the datagrams that may leave now. @param room that our socket has for this session
  void flush(instant now, std::uint16_t room, std::vector<udp_batch>& out, udp_counters& counted);

  /// The octets that have come, in order, since the last call. @param next memory for those to come
  [[nodiscard]] bytes take_received(bytes next = {}) { return received_.take(std::move(next)); }
  [[nodiscard]] bool has_received() const { return received_.has_octets(); }

  /// How many octets of send() the other side has got since the last call, in whatever order.
  [[nodiscard]] std::size_t take_acknowledged();

  /// Octets of send() that the other side has not got.
  [[nodiscard]] std::size_t unacknowledged() const { return unacknowledged_; }

  /// When on_time() is due.
  [[nodiscard]] std::optional<instant> deadline() const;

  void set_room(std::uint16_t room) { room_ = room; } ///< of the other side's socket
  [[nodiscard]] udp_token token() const { return token_; }
  [[nodiscard]] const udp_address& other() const { return other_; }
  [[nodiscard]] const udp_rate& rate() const { return rate_; }
  /// Parts that are held: for a test of what a session may keep.
  [[nodiscard]] std::size_t held() const { return parts_.size() + received_.early(); }

private:
  void on_report(const udp_segment& x, instant now);
  void on_part(const udp_segment& x, udp_counters& counted);

  [[nodiscard]] std::size_t room_in_window() const;
  [[nodiscard]] bool may_begin_part() const;
  [[nodiscard]] bytes next_content();
  void transmit(std::uint64_t sequence, instant now, std::uint16_t room,
                std::vector<udp_batch>& out, udp_counters& counted);
  void send_probes(instant now, std::uint16_t room, std::vector<udp_batch>& out,
                   udp_counters& counted);
  void send_lost(instant now, std::uint16_t room, std::vector<udp_batch>& out,
                 udp_counters& counted);
  void send_report(std::uint16_t room, std::vector<udp_batch>& out, udp_counters& counted);
  [[nodiscard]] udp_segment report(std::uint16_t room);
  void append(const udp_segment& x, std::vector<udp_batch>& out, udp_counters& counted);
  [[nodiscard]] bool awaits_report() const { return parts_.size() > 0 || queued_ > 0; }

  udp_token token_;
  udp_address other_;
  udp_session_config config_;
  udp_rate rate_;
  udp_send_window parts_;
  udp_receiver received_;

  std::deque<payload> queue_;
  std::size_t gone_ = 0;   ///< octets of queue_.front() that are in parts
  std::size_t queued_ = 0; ///< octets that are in no part yet
  std::size_t unacknowledged_ = 0;
  std::size_t acknowledged_ = 0; ///< not taken
  std::uint64_t limit_ = 16;     ///< parts before this one may leave; at first so many
  std::uint16_t room_ = 16;
  unsigned retries_ = 0; ///< since the last report
  unsigned probes_ = 0;  ///< that are due
  instant last_segment_{};
  instant retry_at_{};
};

} // namespace rubicon::peis
