#include "parallel/workers.hpp"

#include <chrono>
#include <numeric>
#include <stdexcept>

#include "support/catch.hpp"

using rubicon::parallel::workers;

TEST_CASE("every job of every round is done once, whatever the number of threads",
          "[parallel][NFR-08]") {
  for (const unsigned others : {0U, 1U, 3U, 7U}) {
    CAPTURE(others);
    workers pool(others);
    for (std::size_t round = 0; round < 3000; ++round) {
      const auto count = round % 17;
      std::vector<std::uint64_t> done(count); // no atomics: what is done must be seen afterwards
      pool.run(count, [&](std::size_t i) { done[i] += i + round; });
      for (std::size_t i = 0; i < count; ++i)
        REQUIRE(done[i] == i + round);
    }
  }
}

TEST_CASE("what one round has written the next one reads, on any thread", "[parallel][NFR-08]") {
  workers pool(3);
  std::vector<std::uint64_t> values(64, 1);
  for (std::size_t round = 0; round < 2000; ++round) {
    std::vector<std::uint64_t> next(values.size());
    pool.run(values.size(), [&](std::size_t i) {
      next[i] = values[(i + 1) % values.size()] + values[(i + 5) % values.size()];
    });
    values = std::move(next);
    if (round % 40 == 39)
      std::fill(values.begin(), values.end(), 1);
    else
      REQUIRE(values[0] == std::uint64_t{2} << (round % 40));
  }
}

TEST_CASE("threads that have gone to sleep come back", "[parallel][NFR-08]") {
  workers pool(2);
  for (int round = 0; round < 5; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::vector<int> done(8);
    pool.run(done.size(), [&](std::size_t i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      done[i] = 1;
    });
    REQUIRE(std::accumulate(done.begin(), done.end(), 0) == 8);
  }
}

TEST_CASE("what a job throws comes to who has called, after the others are done",
          "[parallel][NFR-08]") {
  workers pool(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> done(20);
    CHECK_THROWS_AS(pool.run(done.size(),
                             [&](std::size_t i) {
                               done[i] = 1;
                               if (i == 7)
                                 throw std::runtime_error("seven");
                             }),
                    std::runtime_error);
    REQUIRE(std::accumulate(done.begin(), done.end(), 0) == 20);
    pool.run(1, [](std::size_t) {}); // and nothing is left of it
  }
}
