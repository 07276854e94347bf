// Links of a PEIS kernel over a real Bluetooth adapter, and how peers find each other there
// (D1.1 3.1.5.3, BT-02 to BT-06): L2CAP connections that carry a package in each packet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "core/describe/fields.hpp"
#include "io/bluetooth/bluetooth_adapter.hpp"
#include "io/bluetooth/packet_connect.hpp"
#include "io/bluetooth/packet_listener.hpp"
#include "io/bluetooth/packet_stream.hpp"
#include "io/loop.hpp"
#include "peer/adapter_user.hpp"
#include "peer/bluetooth_hellos.hpp"
#include "peer/bluetooth_scanner.hpp"
#include "peer/link_user.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peer {

struct bluetooth_links_config {
  std::string adapter;            ///< `hci0`
  duration connect_timeout = 20s; ///< an adapter calls one device after the other, for 5 s each
  duration hello_timeout = 5s;    ///< of the answer; a device that connects is closed after it
  duration inquiry = 5s;          ///< length of a scan
  peis::link_id first_link{1};    ///< links are numbered from here on
};

struct bluetooth_counters {
  std::uint64_t refused = 0;     ///< links accepted and closed at once, there being too many
  std::uint64_t too_many = 0;    ///< attempts that failed at once, there being too many
  std::uint64_t dropped = 0;     ///< packages for which a link's queue had no room
  std::uint64_t hellos_lost = 0; ///< HELLOs in either direction beyond bluetooth_hellos::hellos_max
  std::uint64_t scans_failed = 0; ///< that the adapter refused
};
RUBICON_FIELDS(bluetooth_counters, refused, too_many, dropped, hellos_lost, scans_failed);

/// Carries out what one kernel requests of one adapter.
class bluetooth_links {
public:
  /// A good p2p_config::link_window: urgent packages overtake all but these octets.
  static constexpr std::size_t window = 32 * 1024;
  static constexpr std::size_t room = 2 * window; ///< octets that may wait in one link
  static constexpr std::size_t links_max = 32;
  static constexpr std::size_t closing_max = 16; ///< of what they still had to send, more is lost
  static constexpr std::size_t attempts_max = 16;

  /// Accepts links at the first free port of peis::bluetooth_port(), and HELLOs if no other process
  /// does at this adapter (BT-03).
  /// @param where, user, watcher must outlive the links
  /// @returns why it cannot listen, if it cannot
  [[nodiscard]] static std::variant<std::unique_ptr<bluetooth_links>, std::string>
  open(io::loop& where, bluetooth_links_config config,
       std::unique_ptr<io::bluetooth_adapter> adapter, link_user& user, adapter_user& watcher);

  bluetooth_links(const bluetooth_links&) = delete;
  bluetooth_links& operator=(const bluetooth_links&) = delete;

  /// Where others reach us, for the host record (LNK-03).
  [[nodiscard]] peis::low_level_address address() const;
  [[nodiscard]] bool answers_hellos() const { return hellos_.listens(); }

  void carry_out(const peis::to_link& x); ///< for a link that is gone: nothing
  void carry_out(const peis::close_link& x);
  void carry_out(const peis::read_link& x);
  void carry_out(const peis::connect_to& x);
  void carry_out(const peis::scan_adapter& x); ///< nothing while a scan is in progress
  void carry_out(const peis::say_hello& x);
  void answer_hello(std::uint64_t number, bytes octets) { ///< for one that is gone: nothing
    hellos_.answer(number, std::move(octets));
  }

  /// Takes no more links and closes those that are there when their octets have left; attempts are
  /// given up. The users are not called any more.
  void close_all();

  [[nodiscard]] std::size_t open_links() const { return streams_.size(); }
  [[nodiscard]] bluetooth_counters counters() const;

private:
  bluetooth_links(io::loop& where, bluetooth_links_config config,
                  std::unique_ptr<io::bluetooth_adapter> adapter, link_user& user,
                  adapter_user& watcher);

  [[nodiscard]] std::optional<std::string> listen();
  void on_connection(io::descriptor x);
  void on_attempt(peis::attempt_id attempt, const std::string& url,
                  std::variant<io::descriptor, std::string> x);
  void add(io::descriptor x, peis::link_role role, std::optional<peis::attempt_id> attempt);
  void send(peis::link_id link, io::packet_stream& over, payload package);
  void fail_soon(peis::attempt_id attempt, std::string why);

  io::loop* loop_;
  bluetooth_links_config config_;
  std::unique_ptr<io::bluetooth_adapter> adapter_;
  link_user* user_;
  std::uint16_t port_ = 0;
  std::optional<io::packet_listener> listener_;
  std::map<peis::link_id, io::packet_stream> streams_;
  std::map<peis::attempt_id, io::packet_connect> attempts_;
  bluetooth_hellos hellos_;
  bluetooth_scanner scanner_;
  std::shared_ptr<std::size_t> closing_ = std::make_shared<std::size_t>(0);
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true); ///< for what is posted
  std::uint64_t next_link_;
  bool over_ = false;
  bluetooth_counters counters_; ///< of links
};

} // namespace rubicon::peer
