#include "rfid/reader.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using rfid::erase;
using rfid::publish;
using rfid::reader;

namespace {

using lines = std::vector<std::string>;

lines told(const rfid::outputs& outputs) {
  lines all;
  for (const auto& x : outputs) {
    if (const auto* set = std::get_if<publish>(&x))
      all.push_back(set->key + " = " + (set->text ? to_string(set->value) : to_hex(set->value)));
    else
      all.push_back("no " + std::get<erase>(x).key);
  }
  return all;
}

/// A milk box that is carried past the reader, which stands at (0, 0, 0).
std::shared_ptr<const rfid::tags> carried_milk() {
  rfid::tags all;
  all.push_back({"e00401", bytes{1, 10},
                 device::walk({{0s, {10, 0, 0}}, {10s, {0, 0, 0}}, {20s, {10, 0, 0}}}, 1s)});
  return std::make_shared<const rfid::tags>(std::move(all));
}

rfid::reader_config hall() {
  rfid::reader_config x;
  x.name = "hall";
  x.range_m = 2;
  return x;
}

} // namespace

TEST_CASE("a reader relays what it perceives, as long as it does", "[rfid][PXY-02]") {
  reader x(hall(), carried_milk(), random_stream(1));
  CHECK(told(x.start({})) == lines{"interface.hall.channel = rfid",
                                   "interface.hall.position = 0.00 0.00 0.00",
                                   "interface.hall.objects = {}"});
  std::optional<instant> came;
  std::optional<instant> left;
  while (*x.deadline() < instant{20s}) {
    const auto now = *x.deadline();
    const auto all = told(x.on_time(now));
    for (const auto& line : all) {
      if (line == "interface.hall.objects = {e00401}") {
        came = now;
        REQUIRE(all.size() == 3);
        CHECK(all[0].starts_with("interface.hall.objects.e00401.rssi = -5")); // -50 dBm at 1 m
        CHECK(all[1] == "interface.hall.objects.e00401.memory = 010a");
      } else if (line == "interface.hall.objects = {}") {
        left = now;
        CHECK(all == lines{"no interface.hall.objects.e00401.rssi",
                           "no interface.hall.objects.e00401.memory", line});
      }
    }
  }
  REQUIRE(came);
  REQUIRE(left);
  CHECK(*came >= instant{8s}); // 2 m away
  CHECK(*came <= instant{8500ms});
  CHECK(*left >= instant{12500ms}); // two inventories later
  CHECK(*left <= instant{13s});
}

TEST_CASE("inventories that miss a tag now and then do not lose it", "[rfid][PXY-02]") {
  rfid::tags all;
  all.push_back({"a", {}, device::walk({{0s, {1, 0, 0}}}, 1s)});
  auto config = hall();
  config.miss_rate = 0.3;
  config.missed_max = 20;
  reader x(config, std::make_shared<const rfid::tags>(std::move(all)), random_stream(7));
  static_cast<void>(x.start({}));
  unsigned lists = 0;
  for (auto i = 0; i < 1000; ++i) {
    for (const auto& line : told(x.on_time(*x.deadline())))
      lists += line.starts_with("interface.hall.objects =") ? 1 : 0;
  }
  CHECK(lists == 1);
  CHECK(x.perceived() == 1);
}

TEST_CASE("a tag's strength is told when it has changed, either way, and once", "[rfid][PXY-02]") {
  rfid::tags all;
  all.push_back({"a",
                 {},
                 device::walk({{0s, {0.5, 0, 0}},
                               {10s, {0.5, 0, 0}},
                               {11s, {1.9, 0, 0}},
                               {40s, {1.9, 0, 0}},
                               {41s, {0.5, 0, 0}}},
                              100ms)});
  reader x(hall(), std::make_shared<const rfid::tags>(std::move(all)), random_stream(7));
  static_cast<void>(x.start({}));
  const std::string key = "interface.hall.objects.a.rssi = ";
  lines strengths;
  const auto run_until = [&](instant end) {
    while (*x.deadline() < end) {
      for (const auto& line : told(x.on_time(*x.deadline())))
        if (line.starts_with(key))
          strengths.push_back(line.substr(key.size()));
    }
    return strengths.back();
  };
  CHECK(run_until(instant{9s}) == "-44");
  CHECK(strengths.size() == 1);
  CHECK(run_until(instant{39s}) == "-56");
  CHECK(strengths.size() <= 4); // one or two on its way
  CHECK(run_until(instant{99s}) == "-44");
  CHECK(strengths.size() <= 7);
}
