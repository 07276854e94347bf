// Values at a high rate for a long time, there and back, in virtual time.
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

#include <malloc.h>

#include "bridge/ros2/simulated_ros2.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"
#include "support/start.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::start;

namespace {

constexpr int values_per_second = 1000;

/// A tuple is a topic, which comes back as another tuple.
ros2_config there_and_back() {
  ros2_config x;
  topic_publication out;
  out.key = "value";
  out.topic = "/value";
  out.type = "std_msgs/msg/Int64";
  x.publications.push_back(out);
  topic_subscription back;
  back.topic = "/value";
  back.key = "echo";
  back.type = "std_msgs/msg/Int64";
  x.subscriptions.push_back(back);
  x.clock_every = 100ms;
  return x;
}

std::string echo_in(const components::outputs& from) {
  std::string out;
  for (const auto& each : from)
    if (const auto* found = std::get_if<components::publish>(&each))
      out = to_string(byte_view(found->value));
  return out;
}

/// Octets in use; sanitizers have a heap of their own, of which nothing is known.
std::size_t heap_octets() {
  return ::mallinfo2().uordblks;
}

void carry_values(int seconds) {
  simulated_ros2 x(ros2_bridge(there_and_back(), random_stream(1)), peer_id{30});
  static_cast<void>(x.start(start));
  std::int64_t value = 0;
  std::int64_t lost = 0;
  std::size_t heap_before = 0;
  for (int second = 0; second < seconds; ++second) {
    if (second == seconds / 10)
      heap_before = heap_octets();
    for (int i = 0; i < values_per_second; ++i) {
      const auto now = start + second * 1s + i * 1ms;
      while (x.deadline() && *x.deadline() <= now)
        static_cast<void>(x.on_time(now));
      const auto text = std::to_string(++value);
      lost += echo_in(x.on_tuple({1, peer_id{40}, "value", text, false}, now)) == text ? 0 : 1;
    }
    REQUIRE(x.core().outbox().size() == 0);
  }
  const auto heap_after = heap_octets();
  INFO(value << " values, heap " << heap_before << " and " << heap_after << " octets");
  CHECK(lost == 0);
  CHECK(x.core().counters().tuples_set == static_cast<std::uint64_t>(value));
  CHECK(x.core().counters().flooded == 0);
  CHECK(x.core().outbox().longest() <= 2); // a value, and the clock
  CHECK(x.core().outbox().dropped() == 0);
  CHECK(heap_after <= heap_before + 16 * 1024);
}

} // namespace

TEST_CASE("a thousand values a second come back for long, and leave nothing behind",
          "[bridge][ros2]") {
  carry_values(static_cast<int>(10 * test::seeds(100))); // 10,000 s: the next one
}

TEST_CASE("a thousand values a second come back for 10,000 s, and leave nothing behind",
          "[.long][bridge][ros2]") {
  carry_values(10'000);
}
