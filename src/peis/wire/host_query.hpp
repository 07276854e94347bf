// The message of port 12: who is the peer that this package is for (peis-wire.md 10, KH-01)?
#pragma once

#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/codec.hpp"
#include "core/error.hpp"

namespace rubicon::peis {

inline constexpr std::int32_t any_magic = -1;

struct host_query {
  peer_id asker;
  std::int32_t magic = any_magic; ///< asked about this incarnation only (KH-02)
};

/// 8 octets.
[[nodiscard]] inline bytes encode(const host_query& x) {
  byte_writer to;
  to.big(x.asker.value).big(x.magic);
  return to.finish();
}

[[nodiscard]] inline result<host_query> decode_host_query(byte_view octets) {
  byte_reader from(octets);
  const host_query x{peer_id{from.big<std::int32_t>()}, from.big<std::int32_t>()};
  if (!from.ok())
    return errc::truncated;
  return x;
}

} // namespace rubicon::peis
