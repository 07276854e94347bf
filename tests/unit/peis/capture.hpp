// Octets that real kernels have sent.
#pragma once

#include <string>

#include "support/vectors.hpp"

namespace rubicon::peis::test {

[[nodiscard]] inline bytes capture(const std::string& name) {
  return rubicon::test::read_hex_file("peis/" + name + ".hex");
}

} // namespace rubicon::peis::test
