// The text of meta tuples; what parses formats to what parses to the same again.
#include <cassert>
#include <cstdint>
#include <string_view>

#include "peis/tuples/meta_tuple.hpp"

using namespace rubicon;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto x = peis::parse_meta(text)) {
    const auto again = peis::parse_meta(peis::format_meta(*x));
    assert(again && *again == *x);
  }
  return 0;
}
