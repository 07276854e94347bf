#include <limits>

#include "report/figures.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::report;

TEST_CASE("large counts are read in groups of three", "[report]") {
  CHECK(with_thousands(0) == "0");
  CHECK(with_thousands(999) == "999");
  CHECK(with_thousands(1'000) == "1,000");
  CHECK(with_thousands(1'234'567) == "1,234,567");
  CHECK(with_thousands(std::numeric_limits<std::uint64_t>::max()) == "18,446,744,073,709,551,615");
}

TEST_CASE("fixed point figures keep their decimals and group the rest", "[report]") {
  CHECK(fixed(0, 3) == "0.000");
  CHECK(fixed(1234.5, 1) == "1,234.5");
  CHECK(fixed(-1234.5, 0) == "-1,234");
  CHECK(fixed(-0.25, 2) == "-0.25");
  CHECK(fixed(std::numeric_limits<double>::infinity(), 1) == "–");
  CHECK(fixed(std::numeric_limits<double>::quiet_NaN(), 1) == "–");
}

TEST_CASE("a share is never rounded to all or nothing", "[report]") {
  CHECK(percent(0, 10) == "0.0%");
  CHECK(percent(10, 10) == "100.0%");
  CHECK(percent(997, 1000) == "99.7%");
  CHECK(percent(99'999, 100'000) == ">99.9%");
  CHECK(percent(1, 100'000) == "<0.1%");
  CHECK(percent(0, 0) == "–");
}

TEST_CASE("times, speeds and sizes come in the unit a person would choose", "[report]") {
  CHECK(real_time(0.0012) == "1.2 ms");
  CHECK(real_time(0.0994) == "99.4 ms");
  CHECK(real_time(0.0996) == "0.10 s");
  CHECK(real_time(0.844) == "0.84 s");
  CHECK(real_time(12.34) == "12.3 s");
  CHECK(real_time(59.97) == "1 min 00 s");
  CHECK(real_time(125) == "2 min 05 s");
  CHECK(real_time(3600 * 3 + 600) == "3 h 10 min");
  CHECK(real_time(-1) == "–");

  CHECK(speed_factor(10s, 10) == "1.0 ×");
  CHECK(speed_factor(10min, 0.84) == "714 ×");
  CHECK(speed_factor(24h, 0.01) == "8,640,000 ×");
  CHECK(speed_factor(10s, 0) == "–");

  CHECK(life_time(7.5) == "7.5 h");
  CHECK(life_time(24 * 5) == "5.0 d");
  CHECK(life_time(24 * 31) == "31 d");
  CHECK(life_time(24 * 365.25 * 1.4) == "1.4 y");
  CHECK(life_time(std::numeric_limits<double>::infinity()) == "–");

  CHECK(octet_size(999) == "999 B");
  CHECK(octet_size(12'345) == "12.3 kB");
  CHECK(octet_size(999'999) == "1.0 MB");
  CHECK(octet_size(4'500'000'000'000) == "4,500.0 GB");
}

TEST_CASE("one thing is singular", "[report]") {
  CHECK(counted(0, "mote") == "0 motes");
  CHECK(counted(1, "mote") == "1 mote");
  CHECK(counted(1'000, "mote") == "1,000 motes");
}

TEST_CASE("times of a run are seconds, or those of a clock", "[report]") {
  CHECK(clock_text(0s) == "0:00");
  CHECK(clock_text(65s) == "1:05");
  CHECK(clock_text(1h + 2min + 3s) == "1:02:03");
  CHECK(clock_text(-5s) == "0:00");
  CHECK(run_time(instant{12004ms}) == "0:12.004");
  CHECK(run_time(instant{12999999us}) == "0:12.999");
  CHECK(run_time(instant{12min + 5s + 40ms}) == "12:05.040");
  CHECK(run_time(instant{1h + 2min + 3s}) == "1:02:03.000");
  CHECK(run_time(instant{100h + 500ms}) == "100:00:00.500");
  CHECK(run_time(instant{-5s}) == "0:00.000");
}
