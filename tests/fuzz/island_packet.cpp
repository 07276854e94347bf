// What decodes encodes back to the same octets, in both layouts of D1.1 5.4.
#include <cstdlib>

#include "network/island_packet.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubicon::network;
  const rubicon::byte_view octets(data, size);
  if (const auto x = decode_island_packet(octets); x && encode(*x) != rubicon::to_bytes(octets))
    std::abort();
  if (const auto x = decode_gateway_packet(octets); x && encode(*x) != rubicon::to_bytes(octets))
    std::abort();
  return 0;
}
