// All UDP sessions of one socket: who asks for one proves its address first, without costing any
// memory (UDP-01).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/udp/udp_cookie.hpp"
#include "peis/udp/udp_datagram.hpp"
#include "peis/udp/udp_session.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

struct udp_port_config {
  bool accepts = true;                ///< sessions that others ask for
  std::vector<ipv4_network> networks; ///< from where; empty: anywhere
  std::size_t sessions_max = 128;
  std::uint16_t room = 64;                 ///< datagrams that our socket holds unread, for all
  std::uint64_t answers_per_second = 1000; ///< to strangers, each no longer than the question
  duration hello_retry = 100ms;            ///< doubles, to hello_retry_max
  duration hello_retry_max = 1s;
  duration drain_max = 2s; ///< how long close() waits for what is under way
  std::size_t ended_max =
      256; ///< sessions that are over and remembered: a late datagram opens none
  udp_session_config session;
};

/// A session is there, asked for by us (with the attempt) or by the other side.
struct udp_opened {
  udp_token session;
  std::optional<attempt_id> attempt;
  udp_address other;
};
struct udp_refused {
  attempt_id attempt;
  std::string_view why;
};
struct udp_received {
  udp_token session;
  bytes octets;
};
struct udp_acknowledged {
  udp_token session;
  std::size_t octets = 0;
};
struct udp_closed {
  udp_token session;
  std::string_view why;
};
using udp_event = std::variant<udp_opened, udp_refused, udp_received, udp_acknowledged, udp_closed>;

/// Sessions by their names, and attempts at new ones:
///
///   we:    connect() --hello--> ... cookie --open--> ... opened: a session
///   they:  hello: a cookie goes back, nothing is kept; open with it: a session
///
/// After each turn the owner handles take_events() and then sends what flush() gives.
class udp_port {
public:
  udp_port() = default;
  udp_port(udp_port_config config, udp_secret secret)
      : config_(config), cookies_(secret), answers_(config.answers_per_second, 100ms, 100ms) {}

  /// Begins an attempt that ends in udp_opened or udp_refused.
  void connect(attempt_id attempt, const udp_address& to, duration timeout, instant now);
  [[nodiscard]] std::size_t attempts() const { return attempts_.size(); }

  // For a session that is gone they do nothing.
  void send(udp_token session, payload octets);
  void read(udp_token session, bool wanted); ///< whether udp_received is wanted
  /// Ends it when all has been acknowledged, at the latest after drain_max; no event of it follows.
  void close(udp_token session, instant now);
  void reset(udp_token session); ///< ends it now

  /// Memory of a udp_received that was handled, for the next one.
  void give_back(bytes x) { spare_ = std::move(x); }

  void on_datagram(const udp_address& from, byte_view octets, instant now);
  void on_time(instant now);

  [[nodiscard]] std::vector<udp_event> take_events();
  [[nodiscard]] std::vector<udp_batch> flush(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] const udp_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t sessions() const { return sessions_.size(); }
  [[nodiscard]] std::size_t unacknowledged() const; ///< octets, of all sessions
  [[nodiscard]] const udp_session* find(udp_token session) const;

private:
  struct entry {
    udp_session session;
    bool wanted = true;                  ///< its octets
    std::optional<instant> closes_until; ///< it is being closed
  };
  struct opening {
    attempt_id id;
    udp_address to;
    std::optional<std::uint64_t> cookie; ///< that came back
    instant next;
    duration pause;
    instant end;
  };

  void on_handshake(const udp_address& from, const udp_handshake& x, instant now);
  void on_segment(const udp_address& from, const udp_segment& x, instant now);
  [[nodiscard]] bool accepts_from(const udp_address& from);
  void on_hello(const udp_address& from, udp_token token, instant now);
  void on_open(const udp_address& from, const udp_handshake& x, instant now);
  void on_cookie(const udp_address& from, const udp_handshake& x, instant now);
  void on_gone(const udp_address& from, udp_token token);
  bool complete(const udp_address& from, udp_token token, std::uint16_t room, instant now);
  void begin_session(const udp_address& other, udp_token token, std::uint16_t room,
                     std::optional<attempt_id> attempt, instant now);
  void end_session(udp_token token, std::string_view why);
  void forget(udp_token token);
  void answer(const udp_address& to, const udp_handshake& x);
  void answer_stranger(const udp_address& to, const udp_handshake& x, instant now);
  [[nodiscard]] std::uint16_t room_of_each() const;
  [[nodiscard]] static instant deadline_of(const opening& x) { return std::min(x.next, x.end); }

  udp_port_config config_;
  udp_cookies cookies_;
  rate_limit answers_;
  std::map<udp_token, entry> sessions_;
  std::map<udp_token, opening> attempts_;
  std::deque<udp_token> ended_;
  std::vector<udp_event> events_;
  std::vector<udp_batch> answered_;
  bytes spare_;
  udp_counters counters_;
};

} // namespace rubicon::peis
