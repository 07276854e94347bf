// How the kit says that something is not as a test expects: whatever framework runs the test.
#pragma once

#include <stdexcept>

namespace rubicon::test {

/// Its text says what was expected, and what is there instead.
struct failure : std::runtime_error {
  using runtime_error::runtime_error;
};

} // namespace rubicon::test
