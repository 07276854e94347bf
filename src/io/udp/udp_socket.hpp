// Datagrams between this process and others, many at a time (UDP-01).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "core/bytes.hpp"
#include "core/text/ipv4_network.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// One UDP port. Where the system can, it takes and gives many datagrams of one sender at once
/// (UDP_SEGMENT, UDP_GRO). Callbacks run on the loop's thread, never from within a call, and may
/// destroy the socket.
class udp_socket {
public:
  struct callbacks {
    /// Datagrams of one sender, valid in the call: all have `each` octets but the last, which may
    /// have fewer.
    std::function<void(byte_view datagrams, std::size_t each, const ipv4_address& from,
                       std::uint16_t port)>
        on_datagrams;
    /// What was there has been given; more comes in a later turn.
    std::function<void()> on_turn;
  };

  /// Octets that wait until the system takes them; more are dropped and counted.
  static constexpr std::size_t waiting_max = 512 * 1024;
  static constexpr std::size_t batch_octets_max = 62 * 1024; ///< of one send()

  /// Binds the first free port from `first_port` on; 0 lets the system choose.
  /// @param address an IPv4 address of this machine, 0.0.0.0 for all
  /// @returns the socket, or why there is none: `no UDP at 10.0.0.1:8000: ...`
  [[nodiscard]] static std::variant<udp_socket, std::string>
  open(loop& where, const std::string& address, std::uint16_t first_port, callbacks to_owner);

  ~udp_socket();
  udp_socket(udp_socket&&) noexcept;
  udp_socket& operator=(udp_socket&&) noexcept;

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] std::size_t input_octets() const; ///< that the system holds for us, unread

  /// Datagrams of `each` octets, the last may have fewer. What the network refuses is dropped and
  /// counted. @pre batch_octets_max at most
  void send(bytes datagrams, std::size_t each, const ipv4_address& to, std::uint16_t port);

  [[nodiscard]] std::uint64_t unsent() const; ///< datagrams

private:
  struct state;
  explicit udp_socket(std::shared_ptr<state> x);

  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
