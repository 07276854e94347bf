// Raw frames of 802.15.4: no crash on any octets, and what TinyOS says in one encodes back.
#include <cstdlib>

#include "serial/raw_packet.hpp"

using namespace rubicon;
using namespace rubicon::serial;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto x = decode_raw_packet(byte_view(data, size));
  if (!x)
    return 0;
  const auto message = am_packet_in(*x);
  if (!message)
    return 0;
  const auto back = decode_any_packet(encode_raw(*message, x->sequence));
  if (!back || *back != *message)
    std::abort();
  return 0;
}
