#include "io/process/large_pages.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace rubicon::io {

#if defined(MADV_HUGEPAGE)

namespace {

constexpr std::uintptr_t large_page = std::uintptr_t{2} << 20U;
constexpr std::size_t least = std::size_t{8} << 20U; ///< for less it is not worth it
constexpr std::size_t most = std::size_t{1} << 30U;

/// glibc would adapt the size from which an allocation is mapped by itself, if nothing were set:
/// this is the largest that it comes to, and half of what it leaves at the heap's end.
constexpr int mapped_from = 32 << 20;
constexpr int usual_step = 128 << 10; ///< by which glibc lets the heap grow (M_TOP_PAD)

std::uintptr_t heap_end() {
  return reinterpret_cast<std::uintptr_t>(::sbrk(0));
}

struct freed {
  void operator()(void* x) const { std::free(x); }
};

/// Uses up what the heap has until it grows.
void grow(std::uintptr_t end) {
  constexpr std::size_t piece = std::size_t{64} << 10U; // of the heap, not mapped
  constexpr std::size_t pieces_max = most / piece;
  std::vector<std::unique_ptr<void, freed>> pieces;
  pieces.reserve(pieces_max);
  while (heap_end() == end && pieces.size() < pieces_max) {
    pieces.emplace_back(std::malloc(piece));
    if (pieces.back() == nullptr)
      return; // there are no addresses for so many
  }
}

} // namespace

bool expect_memory(std::size_t octets) {
  if (octets < least || ::mallinfo2().fordblks >= octets)
    return false;
  const auto step = static_cast<int>(std::min(octets, most));
  const auto begin = heap_end();
  if (::mallopt(M_TOP_PAD, step) == 0) // another allocator
    return false;
  ::mallopt(M_MMAP_THRESHOLD, mapped_from);
  ::mallopt(M_TRIM_THRESHOLD, step + 2 * mapped_from);
  grow(begin);
  ::mallopt(M_TOP_PAD, usual_step);
  const auto from = (begin + large_page - 1) / large_page * large_page;
  const auto to = heap_end() / large_page * large_page;
  return from < to &&
         ::madvise(reinterpret_cast<void*>(from), to - from, MADV_HUGEPAGE) == 0; // NOLINT
}

#else

bool expect_memory(std::size_t /*octets*/) {
  return false;
}

#endif

} // namespace rubicon::io
