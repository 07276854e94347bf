// What has to hold whatever the input: a fuzzer sees an abort, in every build.
#pragma once

#include <cstdlib>

inline void require(bool condition) {
  if (!condition)
    std::abort();
}
