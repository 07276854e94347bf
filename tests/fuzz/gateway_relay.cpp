// What decodes encodes back to the same octets.
#include <cstdlib>

#include "gateway/others/relay.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubicon::gateway;
  const rubicon::byte_view octets(data, size);
  if (const auto x = decode_relay(octets); x && encode(*x) != rubicon::to_bytes(octets))
    std::abort();
  return 0;
}
