// What decodes keeps its meaning when it is encoded and decoded again.
#include <cstdlib>

#include "mote/join/descriptor.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto x = rubicon::mote::decode_descriptor({data, size});
  if (!x)
    return 0;
  const auto again = rubicon::mote::decode_descriptor(rubicon::mote::encode(*x));
  if (!again || !(*again == *x))
    std::abort();
  return 0;
}
