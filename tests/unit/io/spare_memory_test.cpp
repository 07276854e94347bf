// Memory that was freed between what lives on.
#include <cstdlib>
#include <memory>
#include <vector>

#include "io/process/spare_memory.hpp"
#include "support/catch.hpp"

using namespace rubicon;

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("freed memory goes back to the system, every few seconds at most", "[io]") {
  constexpr std::size_t octets = std::size_t{96} << 20U;
  constexpr std::size_t piece = 4000;
  std::vector<std::unique_ptr<char[]>> pieces;
  for (std::size_t i = 0; i < octets / piece; ++i) {
    pieces.push_back(std::make_unique<char[]>(piece));
    pieces.back()[0] = 'x';
  }
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) // the last one keeps the heap from shrinking
    pieces[i].reset();
  const auto full = io::resident_memory();
  REQUIRE(full >= octets);
  io::spare_memory spare;
  const io::spare_memory::time_point now{std::chrono::hours(1)};
  CHECK(spare.give_back(now) >= octets / 2);
  CHECK(io::resident_memory() < full - octets / 2);
  CHECK(spare.give_back(now + std::chrono::seconds(1)) == 0);
}

TEST_CASE("what could not be given back is looked at again when more is freed", "[io]") {
  constexpr std::size_t octets = std::size_t{128} << 20U;
  constexpr std::size_t piece = 1500; // no page is free while every other one lives
  std::vector<std::unique_ptr<char[]>> pieces;
  for (std::size_t i = 0; i < octets / piece; ++i) {
    pieces.push_back(std::make_unique<char[]>(piece));
    pieces.back()[0] = 'x';
  }
  for (std::size_t i = 0; i < pieces.size(); i += 2)
    pieces[i].reset();
  io::spare_memory spare;
  const io::spare_memory::time_point now{std::chrono::hours(1)};
  CHECK(spare.give_back(now) < octets / 8);
  const auto full = io::resident_memory();
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i)
    pieces[i].reset();
  CHECK(spare.give_back(now + io::spare_memory::period) >= octets / 2);
  CHECK(io::resident_memory() < full - octets / 2);
}
#endif
