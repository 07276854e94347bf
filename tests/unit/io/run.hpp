// Waiting for what a loop will do.
#pragma once

#include <chrono>
#include <functional>

#include "io/loop.hpp"
#include "support/catch.hpp"

namespace rubicon::test {

/// Runs the loop until something has happened; far too long a wait is a failure.
inline void run(io::loop& loop, const std::function<bool()>& done) {
  const auto end = std::chrono::steady_clock::now() + 20s;
  while (!done() && std::chrono::steady_clock::now() < end)
    loop.wait_until(end);
  REQUIRE(done());
}

} // namespace rubicon::test
