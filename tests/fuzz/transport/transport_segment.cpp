// What decodes encodes back to the same octets.
#include <cstdlib>

#include "transport/segment.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const rubicon::byte_view octets(data, size);
  const auto decoded = rubicon::transport::decode_segment(octets);
  if (decoded && rubicon::transport::encode(*decoded) != rubicon::to_bytes(octets))
    std::abort();
  return 0;
}
