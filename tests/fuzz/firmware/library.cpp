// Files that are to be firmware of motes.
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

#include "firmware/library.hpp"
#include "fuzz/require.hpp"

using namespace rubicon;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto found = firmware::inspect({data, size});
  if (const auto* wrong = std::get_if<std::string>(&found))
    require(!wrong->empty());
  return 0;
}
