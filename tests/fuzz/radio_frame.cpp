// Radio frames: no crash on any octets, and what decodes encodes back.
#include <algorithm>
#include <cstdlib>

#include "radio/frame.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

void check(byte_view psdu) {
  const auto x = decode(psdu);
  if (!x)
    return;
  const auto back = encode(*x);
  if (!std::equal(back.begin(), back.end(), psdu.begin(), psdu.end()))
    std::abort();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check({data, size});
  bytes summed(data, data + size); // few inputs pass the FCS by themselves
  const auto sum = fcs(summed);
  summed.push_back(static_cast<std::uint8_t>(sum & 0xff));
  summed.push_back(static_cast<std::uint8_t>(sum >> 8));
  check(summed);
  return 0;
}
