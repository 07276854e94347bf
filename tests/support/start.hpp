// When a test's time begins.
#pragma once

#include "core/time.hpp"

namespace rubicon::test {

inline constexpr instant start{};

} // namespace rubicon::test
