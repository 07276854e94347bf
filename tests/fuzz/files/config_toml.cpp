// Whatever the text, loading it ends with a description or with at least one problem.
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "config/load.hpp"
#include "config/run/summary.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubicon::config;
  const auto x = load_text({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
  assert(x.ecology.has_value() == x.problems.empty());
  for (const auto& each : x.problems)
    assert(!each.message.empty() && each.file == "fuzz.toml");
  if (x.ecology)
    assert(!summary(*x.ecology).empty());
  return 0;
}
