// Links of the real network for one peer: what its kernel asks for goes out, what happens comes to
// its actor as messages.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "actors/messages/peis.hpp"
#include "actors/messages/supervision.hpp"
#include "peer/tcp_links.hpp"

namespace rubicon {

/// Links of the real network are numbered from here on, those of the simulated one below.
inline constexpr std::uint64_t first_real_link = std::uint64_t{1} << 63;

struct real_links_config {
  io::loop* loop = nullptr; ///< must outlive the peer
  peer::links_config links;
  bool port_is_given = false; ///< no other will do than links.first_port
  std::string who;            ///< actor path of the user
  ecology_actor ecology;      ///< hears what cannot be had; may be nullptr
};

class real_links : private peer::link_user {
public:
  /// @param user hears from the loop's thread: link_opened, attempt_failed, link_octets, link_sent,
  ///             link_closed, announcement. It owns this.
  /// @returns why it cannot listen, if it cannot
  [[nodiscard]] static std::variant<std::unique_ptr<real_links>, std::string>
  open(const real_links_config& config, peis_peer_actor user);

  /// The actor has handled a link_octets. Until then no more is read of that link, so that one
  /// message of each waits at most.
  void on_taken(peis::link_id link);

  /// The kernel wants no more of a link for a while.
  void hold(peis::link_id link, bool held);

  /// Carries out what the kernel asks for.
  [[nodiscard]] peer::tcp_links& links() { return *links_; }

private:
  real_links(const real_links_config& config, peis_peer_actor user)
      : user_(std::move(user)), who_(config.who), ecology_(config.ecology) {}

  void on_link_open(peis::link_id link, peis::link_role role,
                    std::optional<peis::attempt_id> attempt) override;
  void on_attempt_failed(peis::attempt_id attempt, const std::string& why) override;
  void on_link_octets(peis::link_id link, byte_view octets) override;
  void on_link_sent(peis::link_id link, std::size_t octets) override;
  void on_link_closed(peis::link_id link, const std::string& why) override;
  void on_announcement(byte_view datagram, const ipv4_address& from) override;
  void on_addresses() override;

  void tell_unmet(std::string what);

  peis_peer_actor user_;
  std::set<peis::link_id> held_;
  std::string who_;
  ecology_actor ecology_;
  std::set<std::string> unknown_names_; ///< that were told
  std::unique_ptr<peer::tcp_links> links_;
};

} // namespace rubicon
