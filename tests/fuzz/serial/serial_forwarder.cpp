// The forwarder's receiver: no crash on any octets, and packets come back out of what they encode
// to.

#include "fuzz/require.hpp"
#include "serial/forwarder.hpp"

using namespace rubicon;
using namespace rubicon::serial;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  forwarder_decoder decoder;
  const auto packets = decoder.on_octets({data, size});
  forwarder_decoder in_pieces;
  std::vector<bytes> same;
  forwarder_decoder again;
  require(again.on_octets(forwarder_greeting()).empty());
  for (std::size_t i = 0; i < size; ++i)
    for (auto& x : in_pieces.on_octets({data + i, 1}))
      same.push_back(std::move(x));
  require(same == packets && in_pieces.refused() == decoder.refused());
  for (const auto& x : packets)
    require(again.on_octets(encode_forwarded(x)) == std::vector<bytes>{x});
  forwarder_line line;
  static_cast<void>(line.on_pc({data, size}));
  require(line.on_forwarder({data, size}).to_forwarder.empty());
  return 0;
}
