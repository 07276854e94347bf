// A group of machines that hear each other's datagrams: UDP multicast (peis-wire.md 4).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "core/bytes.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

struct udp_group_config {
  std::string group = "227.1.3.5";
  std::uint16_t port = 10001;
  std::string interface; ///< its IPv4 address; empty: the one that the system's routes say
  int hops_max = 3;
};

/// Sends to the group and receives what anyone in it sends, ourselves and other processes of this
/// machine included. What the network refuses to take is dropped and counted.
class udp_group {
public:
  /// Valid during the call. May destroy the group.
  using callback = std::function<void(byte_view datagram)>;

  static constexpr std::size_t datagram_max = 2048; ///< longer ones arrive cut

  /// @returns the group, or why it cannot be joined: `227.1.3.5:10001: No such device`
  [[nodiscard]] static std::variant<udp_group, std::string>
  join(loop& where, const udp_group_config& config, callback on_datagram);

  ~udp_group();
  udp_group(udp_group&&) noexcept;
  udp_group& operator=(udp_group&&) noexcept;

  void send(byte_view datagram);

  [[nodiscard]] std::uint64_t unsent() const; ///< datagrams that the network did not take

private:
  struct state;
  explicit udp_group(std::shared_ptr<state> x);

  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
