// What identifies a proxied object, and what kind of thing it is (D1.1 3.2.2, 4.2.5).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/address.hpp"

namespace rubicon::proxy {

/// Interface channel of motes behind a gateway.
inline constexpr std::string_view wsn_channel = "wsn";

/// Signature of a percept (PXY-11, A-33).
struct signature {
  std::string channel;     ///< kind of interface that perceives it, `wsn` for motes
  std::string hardware_id; ///< unique on that channel; `island/mote` for motes
  std::uint32_t type = 0;  ///< compiled into the mote, reported at join (PXY-13)

  friend bool operator==(const signature&, const signature&) = default;
};

/// Identity of the proxy of a mote: the same for every gateway process and after every restart
/// (PXY-15).
[[nodiscard]] inline std::string proxy_id(const mote_address& mote) {
  return to_string(mote);
}

[[nodiscard]] inline signature signature_of(const mote_address& mote, std::uint32_t type) {
  return {std::string(wsn_channel), proxy_id(mote), type};
}

} // namespace rubicon::proxy
