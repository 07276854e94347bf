// Memory that a process is about to need.
#include <memory>
#include <vector>

#include <unistd.h>

#include "io/process/large_pages.hpp"
#include "io/process/spare_memory.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("for little memory large pages are not requested", "[io]") {
  CHECK_FALSE(io::expect_memory(0));
  CHECK_FALSE(io::expect_memory(std::size_t{4} << 20U));
}

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("expected memory is there before it is needed, and takes none until then", "[io]") {
  constexpr std::size_t octets = std::size_t{96} << 20U;
  constexpr std::size_t piece = 4000;
  const auto resident = io::resident_memory();
  io::expect_memory(octets); // a system without large pages has the addresses all the same
  CHECK(io::resident_memory() < resident + octets / 2);
  const auto* const end = ::sbrk(0);
  std::vector<std::unique_ptr<char[]>> pieces;
  for (std::size_t i = 0; i < octets / 2 / piece; ++i)
    pieces.push_back(std::make_unique<char[]>(piece));
  CHECK(::sbrk(0) == end);
  CHECK_FALSE(io::expect_memory(std::size_t{16} << 20U)); // there is enough
}
#endif
