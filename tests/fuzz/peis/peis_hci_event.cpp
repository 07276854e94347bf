// Whatever an adapter sends during an inquiry: devices have an address and a strength that is in
// the packet.
#include <cstdint>

#include "fuzz/require.hpp"
#include "peis/bluetooth/hci_inquiry.hpp"

using namespace rubicon;
using namespace rubicon::peis;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto event = decode_inquiry_event(byte_view(data, size));
  const auto* found = std::get_if<std::vector<seen_device>>(&event);
  if (found == nullptr) {
    require(size == 4 || size == 7);
    return 0;
  }
  constexpr std::size_t result_min = 14;
  require(found->size() * result_min <= size);
  for (const auto& each : *found)
    require(each.strength_dbm >= -128 && each.strength_dbm <= 127);
  return 0;
}
