// Messages of SMEPP Light, and the XML that describes a peer: what decodes encodes back to the same
// octets.
#include <variant>

#include "core/bytes.hpp"
#include "smepp/messages.hpp"
#include "smepp/peer_description.hpp"

#include "require.hpp"

using namespace rubicon;
using namespace rubicon::smepp;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  if (const auto x = decode(octets))
    require(encode(*x) == to_bytes(octets));
  const auto xml = parse_peer_description(rubicon::to_string(octets));
  if (const auto* const x = std::get_if<peer_description>(&xml))
    require(std::get<peer_description>(parse_peer_description(to_xml(*x))) == *x);
  return 0;
}
