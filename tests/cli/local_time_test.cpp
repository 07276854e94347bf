#include "cli/print/local_time.hpp"

#include <cstdlib>
#include <ctime>

#include "support/catch.hpp"

using namespace rubicon;

namespace {

/// The zone of this process, which is set back afterwards.
class zone {
public:
  explicit zone(const char* rule) { set(rule); }
  ~zone() { set("UTC0"); }
  zone(const zone&) = delete;
  zone& operator=(const zone&) = delete;

private:
  static void set(const char* rule) {
    setenv("TZ", rule, 1);
    tzset();
  }
};

std::chrono::system_clock::time_point at(std::time_t x) {
  return std::chrono::system_clock::from_time_t(x);
}

} // namespace

TEST_CASE("the computer's clock leaps at daylight saving", "[cli][rules]") {
  constexpr std::time_t march_28 = 1774692000; // 2026-03-28 11:00 in central Europe
  const zone here("CET-1CEST,M3.5.0,M10.5.0/3");
  CHECK(cli::time_of_day(at(march_28)) == 11h);
  const auto changes = cli::clock_changes(at(march_28), 360 * 24h);
  REQUIRE(changes.size() == 2);
  CHECK(changes[0] == proxy::clock_change{instant(15h), 1h}); // 2026-03-29 02:00
  CHECK(changes[1].ahead == 0h);
  CHECK(cli::time_of_day(at(march_28) + 15h - 1s) == 2h - 1s);
  CHECK(cli::time_of_day(at(march_28) + 15h) == 3h);
  const auto autumn = changes[1].at - instant{};
  CHECK(cli::time_of_day(at(march_28) + autumn - 1s) == 3h - 1s);
  CHECK(cli::time_of_day(at(march_28) + autumn) == 2h);
}

TEST_CASE("a zone without daylight saving never leaps", "[cli][rules]") {
  const zone here("IST-5:30");
  CHECK(cli::clock_changes(at(1774692000), 730 * 24h).empty());
}
