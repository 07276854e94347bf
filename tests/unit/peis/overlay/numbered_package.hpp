// Packages that tell from each other by a number.
#pragma once

#include <cstdint>

#include "peis/link/link.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis::test {

/// Its data are `length` octets of that value.
[[nodiscard]] inline bytes numbered_package(std::uint8_t id, std::size_t length) {
  package_header header;
  header.id = id;
  header.source = peer_id{1};
  header.length = static_cast<std::uint16_t>(length);
  bytes out;
  encode(header, out);
  out.resize(out.size() + length, id);
  return out;
}

} // namespace rubicon::peis::test
