// Serial active messages: no crash on any octets, and what decodes encodes back.
#include <algorithm>
#include <cstdlib>

#include "serial/packet.hpp"

using namespace rubicon;
using namespace rubicon::serial;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  const auto x = decode_am_packet(octets);
  if (!x)
    return 0;
  const auto back = encode(*x);
  if (!std::equal(back.begin(), back.end(), octets.begin(), octets.end()))
    std::abort();
  return 0;
}
