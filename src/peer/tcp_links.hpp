// Real links for a PEIS kernel: TCP connections and multicast announcements (docs/peis-wire.md 3
// and 4), and UDP sessions where they are asked for (UDP-01).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/text/ipv4_network.hpp"
#include "io/loop.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "io/tcp/tcp_listener.hpp"
#include "io/tcp/tcp_stream.hpp"
#include "io/udp/udp_group.hpp"
#include "peer/link_user.hpp"
#include "peer/udp_links.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peer {

struct links_config {
  /// Others on the network may find us and connect. Otherwise nothing leaves the machine unasked:
  /// we listen on loopback and do not announce.
  bool lan = false;
  /// Counted up until one is free; unset: no peer can connect to us.
  std::optional<std::uint16_t> first_port = peis::tcp_port_default;
  /// IPv4; empty: 127.0.0.1, with lan 0.0.0.0. Announcements use its interface alone, or all.
  std::string listen_address;
  /// Links from elsewhere are closed at once, announcements are not received; empty: no
  /// restriction.
  std::vector<ipv4_network> networks;
  bool udp = false;           ///< links over UDP too, on a port of the same number if it is free
  io::udp_group_config group; ///< of announcements, with lan only (TCP-02)
  duration connect_timeout = 5s;
  peis::link_id first_link{1}; ///< links are numbered from here on
};

struct links_counters {
  std::uint64_t refused = 0;  ///< accepted and closed at once, there being too many
  std::uint64_t foreign = 0;  ///< the same, of none of the networks; and announcements
  std::uint64_t unsent = 0;   ///< announcements that the network did not take
  std::uint64_t too_many = 0; ///< attempts that failed at once, there being too many
};
RUBICON_FIELDS(links_counters, refused, foreign, unsent, too_many);

/// Carries out what one kernel asks of its links. Holds no queue of its own: what waits to leave is
/// bounded by p2p_config::link_window, which must be set.
class tcp_links {
public:
  /// A good p2p_config::link_window: fills a fast link in one write, yet what is urgent overtakes
  /// all that is behind it.
  static constexpr std::size_t window = 512 * 1024;
  /// Twice the links a kernel takes: it makes room among those that do not ask for a link, and
  /// sends one more than it takes a list of others to ask (close_link).
  static constexpr std::size_t streams_max = 128;
  static constexpr std::size_t closing_max = 64; ///< of what they still had to send, more is lost
  static constexpr std::size_t attempts_max = 64;

  /// Listens, and joins the group. warning() reports whether the group could be joined: peers
  /// find each other also through those that others report (TCP-07).
  /// @param where, user must outlive the links
  /// @returns why it cannot listen, if it cannot
  [[nodiscard]] static std::variant<std::unique_ptr<tcp_links>, std::string>
  open(io::loop& where, links_config config, link_user& user);

  tcp_links(const tcp_links&) = delete;
  tcp_links& operator=(const tcp_links&) = delete;

  /// Where others reach us, for the host record (LNK-03); as the interfaces are now.
  [[nodiscard]] std::vector<peis::low_level_address> addresses() const;

  [[nodiscard]] std::optional<std::uint16_t> port() const; ///< listened on
  [[nodiscard]] std::optional<std::uint16_t> udp_port() const;
  [[nodiscard]] std::string warning() const; ///< now; empty: all is well

  void carry_out(peis::to_link x); ///< for a link that is gone: nothing
  void carry_out(const peis::close_link& x);
  void carry_out(const peis::read_link& x);
  void carry_out(const peis::pace_link& x);
  void carry_out(const peis::connect_to& x);
  void carry_out(const peis::announce& x);

  /// Takes no more links and closes those that are there when their octets have left; attempts are
  /// given up. The user is not called any more.
  void close_all();

  [[nodiscard]] std::size_t open_links() const;
  [[nodiscard]] std::size_t closing_links() const;
  [[nodiscard]] std::size_t unsent() const; ///< octets that wait to leave, of open links
  [[nodiscard]] links_counters counters() const;
  [[nodiscard]] const udp_links* over_udp() const { return udp_.get(); } ///< nullptr: not asked for

private:
  tcp_links(io::loop& where, links_config config, link_user& user);

  [[nodiscard]] std::optional<std::string> listen();
  [[nodiscard]] std::optional<std::string> open_udp();
  void join_group();
  [[nodiscard]] bool is_listed(const ipv4_address& x) const;
  void on_connection(io::tcp_stream x, const ipv4_address& from);
  void on_attempt(peis::attempt_id attempt, std::variant<io::tcp_stream, std::string> x);
  void add(io::tcp_stream x, peis::link_role role, std::optional<peis::attempt_id> attempt);
  void fail_soon(peis::attempt_id attempt, std::string why);
  void close(io::tcp_stream x);
  [[nodiscard]] const std::string& listen_address() const;

  io::loop* loop_;
  links_config config_;
  link_user* user_;
  std::string warning_;
  std::optional<io::tcp_listener> listener_;
  std::optional<io::udp_group> group_;
  std::unique_ptr<udp_links> udp_;
  std::map<peis::link_id, io::tcp_stream> streams_;
  std::map<peis::attempt_id, io::tcp_connect> attempts_;
  std::shared_ptr<std::size_t> closing_ = std::make_shared<std::size_t>(0);
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true); ///< for what is posted
  std::uint64_t next_link_;
  bool over_ = false;
  links_counters counters_;
};

} // namespace rubicon::peer
