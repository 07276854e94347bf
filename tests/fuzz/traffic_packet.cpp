// What decodes encodes back to the same octets.
#include <cstdlib>

#include "traffic/packet.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const rubicon::byte_view octets(data, size);
  const auto decoded = rubicon::traffic::decode_packet(octets);
  if (decoded && rubicon::traffic::encode(*decoded) != rubicon::to_bytes(octets))
    std::abort();
  return 0;
}
