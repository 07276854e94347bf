// Links of the real network and of a real Bluetooth adapter for one peer: what its kernel requests
// goes out, what happens comes to its actor as messages.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "actors/messages/peis.hpp"
#include "actors/messages/supervision.hpp"
#include "io/bluetooth/bluetooth_adapter.hpp"
#include "peer/bluetooth_links.hpp"
#include "peer/tcp_links.hpp"

namespace rubicon {

/// Links of the real network are numbered from here on, those of the simulated one below.
inline constexpr std::uint64_t first_real_link = std::uint64_t{1} << 63;

/// Of these, links over a Bluetooth adapter are numbered from here on.
inline constexpr std::uint64_t first_adapter_link = first_real_link + (std::uint64_t{1} << 62);

using adapter_opener =
    std::function<std::variant<std::unique_ptr<io::bluetooth_adapter>, std::string>(
        const std::string& name)>;

struct real_links_config {
  io::loop* loop = nullptr; ///< must outlive the peer
  peer::links_config links;
  bool port_is_given = false; ///< no other will do than links.first_port
  std::string adapter;        ///< of Bluetooth, `hci0`; empty: none
  duration inquiry{};         ///< length of its scans
  adapter_opener open_adapter = io::open_bluetooth_adapter;
  std::string who;       ///< actor path of the user
  ecology_actor ecology; ///< is notified of what cannot be had; may be nullptr
};

class real_links : private peer::link_user, private peer::adapter_user {
public:
  /// @param user receives from the loop's thread: link_opened, attempt_failed, link_octets,
  ///             link_sent, link_closed, announcement; of an adapter also bluetooth_seen,
  ///             hello_answer, real_hello. It owns this.
  /// @returns why it cannot listen or open the adapter, if it cannot
  [[nodiscard]] static std::variant<std::unique_ptr<real_links>, std::string>
  open(const real_links_config& config, peis_peer_actor user);

  /// The actor has handled a link_octets. Until then no more is read of that link, so that one
  /// message of each waits at most.
  void on_taken(peis::link_id link);

  /// The kernel wants no more of a link for a while.
  void hold(peis::link_id link, bool held);

  // What the kernel requests.
  void carry_out(peis::to_link x);
  void carry_out(const peis::close_link& x);
  void carry_out(const peis::pace_link& x);
  void carry_out(const peis::connect_to& x);
  void carry_out(const peis::announce& x) { links_->carry_out(x); }
  void carry_out(const peis::scan_adapter& x);
  void carry_out(peis::say_hello x);
  void answer_hello(std::uint64_t connection, bytes octets);
  void close_all();

  /// Where others reach this peer: of the network, and of the adapter.
  [[nodiscard]] std::vector<peis::low_level_address> addresses() const;

  [[nodiscard]] const peer::tcp_links& links() const { return *links_; }
  /// nullptr: none
  [[nodiscard]] const peer::bluetooth_links* over_bluetooth() const { return bluetooth_.get(); }

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
  void on_scan(const std::string& adapter, const std::vector<peis::seen_device>& seen) override;
  void on_hello(std::uint64_t number, byte_view octets) override;
  void on_hello_answer(const std::string& adapter, const peis::bluetooth_address& device,
                       byte_view octets) override;

  [[nodiscard]] std::string open_adapter(const real_links_config& config);
  [[nodiscard]] bool is_of_adapter(peis::link_id link) const;
  void read(peis::link_id link, bool wanted);
  void report_unmet(std::string what);

  peis_peer_actor user_;
  std::set<peis::link_id> held_;
  std::string who_;
  ecology_actor ecology_;
  std::set<std::string> unknown_names_; ///< that were reported
  std::unique_ptr<peer::tcp_links> links_;
  std::unique_ptr<peer::bluetooth_links> bluetooth_; ///< nullptr: none
};

} // namespace rubicon
