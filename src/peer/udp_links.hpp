// Links of a PEIS kernel over UDP, for networks that lose much (UDP-01): off unless asked for.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/text/ipv4_network.hpp"
#include "io/loop.hpp"
#include "io/tcp/host_lookup.hpp"
#include "io/timer.hpp"
#include "io/udp/udp_socket.hpp"
#include "peer/link_user.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/udp/udp_port.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peer {

struct udp_links_config {
  std::string address;                     ///< IPv4, ours; 0.0.0.0: all
  std::optional<std::uint16_t> first_port; ///< counted up until one is free; unset: only our links
  std::vector<ipv4_network> networks;      ///< others get no answer; empty: all do
  duration connect_timeout = 5s;
};

/// The sessions of one udp_port and one socket as links. A link reports as sent what the other side
/// has acknowledged.
class udp_links {
public:
  static constexpr std::size_t attempts_max = 64;

  /// @param where, user must outlive the links
  /// @param next_link names a new link
  /// @returns why there is no such port, if there is none
  [[nodiscard]] static std::variant<std::unique_ptr<udp_links>, std::string>
  open(io::loop& where, udp_links_config config, link_user& user,
       std::function<peis::link_id()> next_link);

  /// Resets the sessions, so that the other sides close their links.
  ~udp_links();
  udp_links(const udp_links&) = delete;
  udp_links& operator=(const udp_links&) = delete;

  [[nodiscard]] std::uint16_t port() const { return socket_->port(); }

  // For a link that is gone, or not over UDP: nothing.
  void send(peis::link_id link, payload octets);
  void close(const peis::close_link& x);
  void read(const peis::read_link& x);

  /// @pre attempts() < attempts_max
  void connect(peis::attempt_id attempt, const peis::link_url& to);
  [[nodiscard]] std::size_t attempts() const { return lookups_.size() + port_.attempts(); }

  /// Ends all links when what they have to send has been acknowledged; the user is not called any
  /// more.
  void close_all();

  [[nodiscard]] std::size_t open_links() const { return tokens_.size(); }
  [[nodiscard]] std::size_t closing_links() const { return port_.sessions() - tokens_.size(); }
  [[nodiscard]] std::size_t unsent() const { return port_.unacknowledged(); }
  [[nodiscard]] peis::udp_counters counters() const;

private:
  udp_links(io::loop& where, udp_links_config config, link_user& user,
            std::function<peis::link_id()> next_link);

  [[nodiscard]] std::optional<std::string> open_socket();
  [[nodiscard]] instant now() const { return instant(std::chrono::steady_clock::now() - start_); }
  void on_datagrams(byte_view datagrams, std::size_t each, const peis::udp_address& from);
  void on_address(peis::attempt_id attempt, std::uint16_t port,
                  const std::variant<ipv4_address, std::string>& found);
  void process_soon();
  void process();
  void send_due();
  void handle(const peis::udp_opened& x);
  void handle(const peis::udp_refused& x);
  void handle(const peis::udp_received& x);
  void handle(const peis::udp_acknowledged& x);
  void handle(const peis::udp_closed& x);

  io::loop* loop_;
  udp_links_config config_;
  link_user* user_;
  std::function<peis::link_id()> next_link_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::optional<io::udp_socket> socket_;
  peis::udp_port port_;
  io::timer timer_;
  std::optional<instant> wakes_at_;
  std::map<peis::link_id, peis::udp_token> tokens_;
  std::map<peis::udp_token, peis::link_id> links_;
  std::map<peis::attempt_id, io::host_lookup> lookups_;
  std::map<peis::attempt_id, std::string> targets_;            ///< as people know them
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true); ///< for what is posted
  bool process_due_ = false;
  bool over_ = false;
};

} // namespace rubicon::peer
