#include "io/spare_memory.hpp"

#include <cstdio>

#include <unistd.h>

#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
#include <malloc.h>
#endif

namespace rubicon::io {

namespace {

#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
/// What is allocated; nothing is known of other allocators.
std::size_t allocated_memory() {
  const auto x = ::mallinfo2();
  return x.uordblks + x.hblkhd;
}

void trim() {
  ::malloc_trim(0);
}
#else
std::size_t allocated_memory() {
  return static_cast<std::size_t>(-1) / 2;
}

void trim() {}
#endif

} // namespace

std::size_t resident_memory() {
  auto* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr)
    return 0;
  unsigned long all = 0;
  unsigned long resident = 0;
  const int found = std::fscanf(file, "%lu %lu", &all, &resident);
  std::fclose(file);
  return found == 2 ? resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

std::size_t spare_memory::give_back(time_point now) {
  if (now < next_)
    return 0;
  next_ = now + period;
  const auto before = resident_memory();
  if (before < 2 * least ||
      before < allocated_memory() + 2 * least) // program and stack have a part
    return 0;
  trim();
  const auto after = resident_memory();
  const auto given = after < before ? before - after : 0;
  if (given < least / 4)
    next_ = now + pause;
  return given;
}

} // namespace rubicon::io
