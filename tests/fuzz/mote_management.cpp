// What decodes encodes back to the same octets.
#include <cstdlib>

#include "mote/join/management.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const rubicon::byte_view octets(data, size);
  const auto x = rubicon::mote::decode_management(octets);
  if (x && rubicon::mote::encode(*x) != rubicon::to_bytes(octets))
    std::abort();
  return 0;
}
