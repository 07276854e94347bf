// How libcrypto is dealt with: what it gives is released, and it does not fail.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace rubicon::smepp {

/// A library without an algorithm, or out of memory: going on would mean to send in clear.
inline void require(bool good) {
  if (good)
    return;
  std::fputs("libcrypto failed\n", stderr);
  std::abort();
}

template <auto Release>
struct releaser {
  template <class T>
  void operator()(T* x) const {
    Release(x);
  }
};

} // namespace rubicon::smepp
