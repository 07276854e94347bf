#include "radio/medium/interferer.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

/// How long it sends within `length`, and how often it begins to.
std::pair<duration, int> sums(interferer x, duration length) {
  duration sent{};
  int bursts = 0;
  instant since;
  while (const auto due = x.deadline()) {
    const bool before = x.sends();
    const bool after = x.on_time(*due);
    if (before)
      sent += *due - since;
    if (!before && after)
      ++bursts;
    since = *due;
  }
  CHECK(since == instant(length));
  return {sent, bursts};
}

} // namespace

TEST_CASE("a source of noise sends its share of the time, and no longer than it is to",
          "[radio][ACT-04]") {
  const auto duty = GENERATE(0.01, 0.2, 0.5, 0.9, 1.0);
  CAPTURE(duty);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto [sent, bursts] =
        sums(interferer({duty, 5ms}, random_stream(seed), instant{}, instant(100s)), 100s);
    CHECK(seconds(sent) > 100 * duty * 0.85);
    CHECK(seconds(sent) < 100 * duty * 1.15 + 1e-9);
    CHECK((duty == 1 ? bursts == 1 : sent <= bursts * 5ms));
  }
}

TEST_CASE("two sources of one kind do not send together", "[radio][ACT-04]") {
  const interferer a({0.1, 5ms}, random_stream(1), {}, instant(1s));
  const interferer b({0.1, 5ms}, random_stream(2), {}, instant(1s));
  CHECK(a.deadline() != b.deadline());
}
