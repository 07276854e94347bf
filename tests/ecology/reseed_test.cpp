// Runs with other random numbers from some time on.
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "actors/run/ecology_run.hpp"
#include "core/hash.hpp"
#include "core/numbers/random.hpp"
#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

struct traced {
  std::uint64_t before = 0; ///< the hash of the trace so far
  std::string whole;

  friend bool operator==(const traced&, const traced&) = default;
};

traced run_of(const char* file, std::optional<reseeding::settings> x, duration until,
              unsigned threads = 1, std::optional<std::uint64_t> seed = std::nullopt,
              duration length = 50s) {
  auto ecology = example(file);
  ecology.length = length;
  run_options options;
  options.seed = seed;
  options.reseed = std::move(x);
  options.threads = threads;
  ecology_run run(std::move(ecology), options);
  run.run_until(instant(until));
  const auto before = run.world().trace().hash();
  return {before, run.finish().trace_hash};
}

} // namespace

TEST_CASE("a run that is reseeded is the same until then, and another after it",
          "[ecology][ACT-05]") {
  constexpr auto then = 20s;
  for (const auto* file : {"home.toml", "learning.toml"}) {
    CAPTURE(file);
    const auto plain = run_of(file, std::nullopt, then);
    const auto one = run_of(file, reseeding::settings{instant(then), 1}, then);
    const auto other = run_of(file, reseeding::settings{instant(then), 2}, then);
    CHECK(one.before == plain.before);
    CHECK(other.before == plain.before);
    CHECK(one.whole != plain.whole);
    CHECK(other.whole != plain.whole);
    CHECK(one.whole != other.whole);
    CHECK(run_of(file, reseeding::settings{instant(then), 1}, then, 3) == one);
    // Where a run stops to be looked at changes nothing.
    CHECK(run_of(file, reseeding::settings{instant(then), 1}, 40s).whole == one.whole);
    CHECK(run_of(file, reseeding::settings{instant(then), 1}, 40s).before !=
          run_of(file, std::nullopt, 40s).before);
    CHECK(run_of(file, std::nullopt, then) == plain); // the next run is as its seed says
  }
}

TEST_CASE("of any seed nothing moves before the time of a reseeding, whatever its key",
          "[ecology][ACT-05]") {
  random_stream draw(1);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto then = draw.between(500ms, 25s);
    const auto of_key = [&](std::optional<std::uint64_t> key) {
      const auto x = key ? std::optional(reseeding::settings{instant(then), *key}) : std::nullopt;
      return run_of("home.toml", x, then, 1, seed, 30s);
    };
    CAPTURE(seed, then.count());
    const auto plain = of_key(std::nullopt);
    std::set<std::string> futures{plain.whole};
    for (const std::uint64_t key : {std::uint64_t{0}, draw.next(), UINT64_MAX}) {
      const auto other = of_key(key);
      CHECK(other.before == plain.before);
      CHECK(futures.insert(other.whole).second);
    }
  }
}
