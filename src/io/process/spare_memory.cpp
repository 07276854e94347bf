#include "io/process/spare_memory.hpp"

#include <algorithm>
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
  if (now < next_look_)
    return 0;
  next_look_ = now + period;
  const auto before = resident_memory();
  const auto allocated = allocated_memory();
  const auto spare = before - std::min(before, allocated); // program and stack have a part
  left_ = std::min(left_, spare);
  if (spare < 2 * least || (spare < left_ + least / 2 && now < next_search_))
    return 0;
  trim();
  const auto after = resident_memory();
  left_ = after - std::min(after, allocated);
  next_search_ = now + pause;
  return before - std::min(before, after);
}

} // namespace rubicon::io
