// Clocks of the benches, and the loop that makes figures of different machines comparable.
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>

#include "core/hash.hpp"
#include "core/time.hpp"

namespace bench {

/// Processor time of this thread: a shared machine's other work is not in it.
inline double cpu_s() {
  timespec x{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &x);
  return static_cast<double>(x.tv_sec) + 1e-9 * static_cast<double>(x.tv_nsec);
}

/// On the clock that all processes of a machine share.
inline double wall_s() {
  return rubicon::seconds(std::chrono::steady_clock::now().time_since_epoch());
}

/// Million steps of integer work a second of processor time.
inline double calibrate() {
  constexpr std::uint64_t steps = 100'000'000;
  const auto start = cpu_s();
  rubicon::fold64 fold;
  for (std::uint64_t i = 0; i < steps; ++i)
    fold.add(i);
  const auto rate = static_cast<double>(steps) / 1e6 / (cpu_s() - start);
  return fold.value() == 0 ? 0 : rate; // uses the result, so that the loop stays
}

} // namespace bench
