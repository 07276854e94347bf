// How many seeds a test of many runs takes.
#pragma once

#include <cstdint>

namespace rubicon::test {

/// As many, but one where each run is twenty times as slow.
[[nodiscard]] constexpr std::uint64_t seeds(std::uint64_t usual) {
#ifdef __SANITIZE_ADDRESS__
  static_cast<void>(usual);
  return 1;
#else
  return usual;
#endif
}

} // namespace rubicon::test
