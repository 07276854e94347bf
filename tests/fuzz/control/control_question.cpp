// A question to a host: its kind, then what it says. What is read has one form, and grows little in
// memory.
#include "control/octets.hpp"

#include "fuzz/require.hpp"

using namespace rubicon;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return 0;
  const byte_view content(data + 1, size - 1);
  if (const auto found = control::question_of(data[0], content)) {
    require(found->index() == data[0]);
    require(control::octets_of(*found) == to_bytes(content));
    require(control::answer_kind(data[0]) < std::variant_size_v<deploy::answer>);
  }
  return 0;
}
