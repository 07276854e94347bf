#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "config/toml/units.hpp"
#include "radio/parameters.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::config;

TEST_CASE("a time is a number and its unit", "[config][units]") {
  const auto [text, expected] = GENERATE(table<std::string, duration>({
      {"31s", 31s},
      {"10min", 10min},
      {"500ms", 500ms},
      {"2h", 2h},
      {"1d", 24h},
      {"250us", 250us},
      {"7ns", 7ns},
      {"0s", 0s},
      {"31 s", 31s},
      {"1min30s", 90s},
      {"1min 30s", 90s},
      {"1d2h3min4s5ms6us7ns", 26h + 3min + 4s + 5ms + 6us + 7ns},
      {"1.5s", 1500ms},
      {"0.1d", 144min},
      {"1.000000001s", 1s + 1ns},
      {"2.0ns", 2ns},
      {"106751d", 24h * 106751},
  }));
  CAPTURE(text);
  CHECK(parse_duration(text) == expected);
}

TEST_CASE("what is no time is refused", "[config][units]") {
  const auto* text = GENERATE("", " ", "31", "s", "31 sec", "31S", "-3s", "+3s", "1e3s", "1,5s",
                              ".5s", "5.s", "1s1min", "1s1s", "1min30", "1m", "s31", "31s x",
                              "0.0000000001s", "0.5ns", "106752d", "9223372036854775808ns",
                              "99999999999999999999s", "106751d24h", "1.5.5s", " 31s");
  CAPTURE(text);
  CHECK_FALSE(parse_duration(text));
}

TEST_CASE("the longest time is the last that fits", "[config][units]") {
  CHECK(parse_duration("9223372036854775807ns") ==
        duration(std::numeric_limits<std::int64_t>::max()));
  CHECK_FALSE(parse_duration("106751d23h47min16s854ms775us808ns"));
  CHECK(parse_duration("106751d23h47min16s854ms775us807ns") ==
        duration(std::numeric_limits<std::int64_t>::max()));
}

TEST_CASE("ratios, lengths and charges carry their units", "[config][units]") {
  CHECK(parse_ratio("2%") == 0.02);
  CHECK(parse_ratio("0.5 %") == 0.005);
  CHECK(parse_length_m("25m") == 25.0);
  CHECK(parse_length_m("2.5 m") == 2.5);
  CHECK(parse_length_m("1km") == 1000.0);
  CHECK(parse_length_m("150cm") == 1.5);
  CHECK(parse_charge_mah("2000mAh") == 2000.0);
  CHECK(parse_charge_mah("2.5Ah") == 2500.0);
  CHECK(parse_charge_mah("21.6kJ").value() == Approx(2000)); // 2 Ah of 3 V
  CHECK(parse_charge_mah("540 J").value() == Approx(50));
  for (const auto& platform : radio::platforms())
    CHECK(platform.supply_v == battery_v);
  CHECK(parse_dbm("-106.58dBm") == -106.58);
  CHECK(parse_dbm("3 dBm") == 3.0);
  CHECK(parse_db("46.68dB") == 46.68);
  CHECK(parse_db("-3dB") == -3.0);
  CHECK(parse_frequency_mhz("2480MHz") == 2480.0);
  CHECK(parse_frequency_mhz("2.4 GHz") == 2400.0);
  CHECK(parse_baud("57600baud") == 57600);
  CHECK(parse_baud("57600 baud") == 57600);
}

TEST_CASE("quantities without a unit or with another one are refused", "[config][units]") {
  const auto* text =
      GENERATE("", "2", "x", "%", "-2%", "2 percent", "2mm", "m", "1e3m", "nan%", "infm", ".5m",
               "1.2.3m", "mAh", "5V", "--3dBm", "+3dB", "-dB", "-3", "3dBW", "-2400MHz", "2.4ghz",
               "baud", "1.5baud", "0x10baud", "99999999999999999999baud");
  CAPTURE(text);
  CHECK_FALSE(parse_ratio(text));
  CHECK_FALSE(parse_length_m(text));
  CHECK_FALSE(parse_charge_mah(text));
  CHECK_FALSE(parse_baud(text));
  CHECK_FALSE(parse_dbm(text));
  CHECK_FALSE(parse_db(text));
  CHECK_FALSE(parse_frequency_mhz(text));
}
