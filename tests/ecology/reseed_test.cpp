// Runs with other random numbers from some time on.
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "actors/run/ecology_run.hpp"
#include "core/hash.hpp"
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
              unsigned threads = 1) {
  auto ecology = example(file);
  ecology.length = 50s;
  run_options options;
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
