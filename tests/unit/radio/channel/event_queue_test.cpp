#include "radio/event_queue.hpp"

#include "core/numbers/random.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

event event_at(duration at, duration output_at) {
  event x;
  x.at = instant(at);
  x.output_at = instant(output_at);
  return x;
}

/// When the queue says that the next output may come.
std::optional<instant> next_output_of(event_queue& x) {
  return x.next_output(instant::min(), [](const event&) { return true; });
}

} // namespace

TEST_CASE("events come out in the order of time, then of arrival", "[radio][channel]") {
  event_queue x;
  random_stream rng(5);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    event next;
    next.at = instant(duration(rng.below(20)));
    next.stamp = i;
    x.push(next);
  }
  CHECK(x.size() == 1000);
  auto last = x.top();
  x.pop();
  while (!x.empty()) {
    const auto next = x.top();
    x.pop();
    if (next.at == last.at ? next.stamp < last.stamp : next.at < last.at)
      FAIL("out of order: " << last.stamp << " before " << next.stamp);
    last = next;
  }
}

TEST_CASE("an event that is sure has its late output until another comes before it",
          "[radio][channel]") {
  event_queue x;
  x.push_sure(event_at(10ms, 30ms), event_at(10ms, 20ms));
  CHECK(next_output_of(x) == instant(30ms));
  x.push(event_at(11ms, 40ms)); // behind it
  CHECK(next_output_of(x) == instant(30ms));
  SECTION("at the same moment") {
    x.push(event_at(10ms, 40ms));
    CHECK(next_output_of(x) == instant(20ms));
  }
  SECTION("earlier") {
    x.push(event_at(9ms, 40ms));
    CHECK(next_output_of(x) == instant(20ms));
  }
  SECTION("which is sure itself") {
    x.push_sure(event_at(9ms, 50ms), event_at(9ms, 15ms));
    CHECK(next_output_of(x) == instant(20ms));
    x.doubt();
    CHECK(next_output_of(x) == instant(15ms));
  }
  SECTION("or it is doubted") {
    x.doubt();
    CHECK(next_output_of(x) == instant(20ms));
  }
}

TEST_CASE("a silent event is due, and has no output", "[radio][channel]") {
  event_queue x;
  x.push_silent(event_at(1ms, 1ms));
  CHECK_FALSE(next_output_of(x));
  CHECK(x.top().at == instant(1ms));
}
