// Where a link may lead, as people write it (LNK-05): `tcp://host:port`, `udp://host:port`,
// `bt://AA:BB:CC:DD:EE:FF;port`, `inproc://name`.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/describe/fields.hpp"
#include "core/error.hpp"
#include "peis/wire/host_record.hpp"

namespace rubicon::peis {

inline constexpr std::uint16_t tcp_port_default = 8000;
inline constexpr std::uint16_t bluetooth_port_default = 7315;

struct bluetooth_address {
  std::array<std::uint8_t, 6> octets{};

  friend auto operator<=>(const bluetooth_address&, const bluetooth_address&) = default;
};
RUBICON_FIELDS(bluetooth_address, octets);

/// `02:4B:00:1F:A0:07`
[[nodiscard]] std::string to_string(const bluetooth_address& x);

/// bad_value unless it is six pairs of hexadecimal digits with colons in between.
[[nodiscard]] result<bluetooth_address> parse_bluetooth_address(std::string_view text);

struct link_url {
  enum class scheme : std::uint8_t { tcp, udp, bluetooth, inproc };

  scheme medium = scheme::tcp;
  std::string host;       ///< name or address; of an in-process link the peer's name or id
  std::uint16_t port = 0; ///< 0 for in-process links

  friend bool operator==(const link_url&, const link_url&) = default;
};

/// bad_value if it is none of the four forms. A port that is not given is the default one.
[[nodiscard]] result<link_url> parse_link_url(std::string_view text);

[[nodiscard]] std::string to_string(const link_url& x);

/// Whom `inproc://id` names; nullopt for another link.
[[nodiscard]] std::optional<peer_id> inproc_peer(const link_url& x);

/// Which device `bt://address;port` names; nullopt for another link.
[[nodiscard]] std::optional<bluetooth_address> bluetooth_device(const link_url& x);

/// Where an interface of a peer's record can be reached. An in-process address names the peer by
/// its id.
[[nodiscard]] link_url url_of(const low_level_address& x);

/// The interfaces that records list. @pre the address has four octets a.b.c.d, first one first
[[nodiscard]] low_level_address tcp_address(std::string device, bool loopback,
                                            std::array<std::uint8_t, 4> ipv4, std::uint16_t port);

/// The same over UDP.
[[nodiscard]] low_level_address udp_interface(std::string device, bool loopback,
                                              std::array<std::uint8_t, 4> ipv4, std::uint16_t port);

/// An in-process link: every process has a number of its own, so that peers of two processes do not
/// try it.
[[nodiscard]] low_level_address inproc_address(std::uint32_t process, peer_id id);

/// An adapter in a host record. @param port where links are taken
[[nodiscard]] low_level_address
bluetooth_interface(std::string adapter, const bluetooth_address& address, std::uint16_t port);

/// @pre x.type is bluetooth
[[nodiscard]] bluetooth_address bluetooth_address_of(const low_level_address& x);

} // namespace rubicon::peis
