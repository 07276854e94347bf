// A group of machines that receive each other's datagrams: UDP multicast (peis-wire.md 4).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/text/ipv4_network.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

struct udp_group_config {
  std::string group = "227.1.3.5";
  std::uint16_t port = 10001;
  /// IPv4 addresses of those that are used; empty: all that are up, but for loopback.
  std::vector<std::string> interfaces;
  int hops_max = 3;
  /// Interfaces come, go and get other addresses; a system may refuse a group for a while.
  std::chrono::milliseconds look_every{3000};
};

/// Sends to the group and receives what anyone in it sends, ourselves and other processes of this
/// machine included, over each interface that there is at the time. What the network refuses to
/// take is dropped and counted.
class udp_group {
public:
  /// Valid during the call. May destroy the group.
  using callback = std::function<void(byte_view datagram, const ipv4_address& from)>;

  static constexpr std::size_t datagram_max = 2048; ///< longer ones arrive cut

  /// @returns the group, or why it can never be joined: `227.1.3.5:10001: Invalid argument`
  [[nodiscard]] static std::variant<udp_group, std::string>
  join(loop& where, const udp_group_config& config, callback on_datagram);

  ~udp_group();
  udp_group(udp_group&&) noexcept;
  udp_group& operator=(udp_group&&) noexcept;

  void send(byte_view datagram); ///< once over each interface

  /// Called when the set of interfaces has changed, with none of its calls in progress.
  void on_change(std::function<void()> f);

  [[nodiscard]] std::uint64_t unsent() const; ///< datagrams that the network did not take

  /// Why no interface is used now: `227.1.3.5:10001: No such device`; empty: one is.
  [[nodiscard]] std::string trouble() const;

private:
  struct state;
  explicit udp_group(std::shared_ptr<state> x);

  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
