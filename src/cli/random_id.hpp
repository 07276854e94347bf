// Unique names.
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "core/hash.hpp"

namespace rubicon::cli {

/// From the system, not from a seed.
[[nodiscard]] inline std::uint64_t random_number() {
  std::random_device source;
  return (std::uint64_t{source()} << 32) | source();
}

[[nodiscard]] inline std::string random_id() {
  return to_hex(random_number());
}

} // namespace rubicon::cli
