// Fragments of packets, as the octets of a file: each begins with its length. Whatever comes
// together is as long as its fragments.
#include <cstdint>
#include <cstdlib>

#include "transport/fragments.hpp"

using namespace rubicon;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  transport::assembly packets;
  std::size_t heard = 0;
  instant now;
  for (byte_view rest(data, size); !rest.empty(); now += 1s) {
    const auto length = std::min<std::size_t>(rest[0], rest.size() - 1);
    const auto fragment = rest.subspan(1, length);
    heard += length;
    const auto whole = packets.on_fragment(mote_id{1}, fragment, now);
    if (whole && whole->size() > heard)
      std::abort();
    rest = rest.subspan(1 + length);
  }
  return 0;
}
