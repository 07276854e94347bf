// The PC's frame decoder: no crash on any octets, and what decodes encodes back.

#include "fuzz/require.hpp"
#include "serial/frame.hpp"

using namespace rubicon;
using namespace rubicon::serial;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  frame_decoder decoder;
  std::uint64_t frames = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const auto x = decoder.on_octet(data[i]);
    if (!x)
      continue;
    ++frames;
    frame_decoder again;
    std::optional<frame> back;
    for (const auto octet : encode(*x)) {
      require(!back);
      back = again.on_octet(octet);
    }
    require(back == x);
  }
  require(decoder.counters().good == frames);
  return 0;
}
