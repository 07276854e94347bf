// What decodes encodes back to the same octets.
#include <cstdlib>

#include "network/sink_event.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubicon::network;
  const rubicon::byte_view octets(data, size);
  if (const auto x = decode_sink_event(octets); x && encode(*x) != rubicon::to_bytes(octets))
    std::abort();
  return 0;
}
