#include "control/refusal_log.hpp"

#include "support/catch.hpp"

using namespace rubicon;
using control::refusal_log;

TEST_CASE("the same refusal is a line once a minute", "[control]") {
  refusal_log log;
  CHECK(log.note("10.0.0.1", "presented no certificate", {}) ==
        "10.0.0.1 was rejected: it presented no certificate");
  CHECK_FALSE(log.deadline());
  for (int i = 0; i < 1000; ++i)
    CHECK_FALSE(log.note("10.0.0.1", "presented no certificate", instant(i * 10ms)));
  CHECK(log.deadline() == instant(1min));
  CHECK_FALSE(log.on_time(instant(59s)));
  CHECK(log.on_time(instant(1min)) == "1000 more were rejected in a minute");
  CHECK_FALSE(log.deadline());
  CHECK_FALSE(log.on_time(instant(5min)));
  CHECK(log.note("10.0.0.1", "presented no certificate", instant(61s)));
}

TEST_CASE("different refusals are few lines a minute, and the rest a number", "[control]") {
  refusal_log log;
  std::size_t lines = 0;
  for (int i = 0; i < 500; ++i)
    lines += log.note("10.0.0." + std::to_string(i), "presented no certificate", instant(i * 1ms))
                 ? 1
                 : 0;
  CHECK(lines == refusal_log::lines_max);
  CHECK(log.on_time(instant(1min)) == "490 more were rejected in a minute");
  CHECK(log.note("10.0.0.9", "does not speak TLS", instant(61s)));
}
