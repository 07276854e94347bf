#include <string>
#include <vector>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// Two rooms with a reader each, of which the hall's is on another computer, and a milk box that is
/// carried from one to the other at 60 s.
constexpr std::string_view house = R"(
[ecology]
name = "house"
duration = "2min"
[[peer]]
id = 10
name = "kitchen-pc"
links = ["inproc://hall-pc"]
[[peer.apps]]
app = "rfid_reader"
name = "kitchen"
position_m = [0, 0, 1]
range = "3m"
miss_rate = "10%"
[[peer]]
id = 11
name = "hall-pc"
[[peer.apps]]
app = "rfid_reader"
name = "hall"
position_m = [5, 0, 1]
range = "3m"
miss_rate = "10%"
[[peer.apps]]
app = "proxy_manager"
objects = true
[[tag]]
id = "e0040101"
memory = "0205"
path = [["0s", [0.5, 0, 1]], ["60s", [0.5, 0, 1]], ["65s", [4.5, 0, 1]]]
[[tag]]
id = "e0040102"
memory = "0105"
position_m = [0.3, 0.3, 1]
[[proxy]]
name = "drink"
ids = ["rfid/e004"]
prefix = "things.{name}"
properties = { shape = "box" }
[[proxy.field]]
name = "contents"
encoding = "u8"
words = { 1 = "milk", 2 = "juice" }
[[proxy.object]]
id = "e0040101"
name = "juice"
)";

} // namespace

TEST_CASE("a tagged thing is followed from reader to reader by one proxy",
          "[ecology][PXY-03][PXY-05][PXY-06][PXY-07][PXY-08][PXY-19]") {
  const auto what = describe(house);
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    auto before = what;
    before.length = 50s;
    auto report = run(before, seed);
    CHECK(report.proxies.size() == 2);
    CHECK(value(proxy_of(report, "things.juice"), "interface") == "kitchen");
    CHECK(value(proxy_of(report, "things.juice"), "position") == "0.00 0.00 1.00");
    CHECK(value(proxy_of(report, "things.juice"), "contents") == "juice");
    CHECK(value(proxy_of(report, "things.e0040102"), "contents") == "milk");

    report = run(what, seed);
    CHECK(report.violations.empty());
    CHECK(report.proxies.size() == 2);
    const auto& juice = proxy_of(report, "things.juice");
    CHECK(juice.status == "active");
    CHECK(value(juice, "interface") == "hall");
    CHECK(value(juice, "position") == "5.00 0.00 1.00");
    CHECK(value(proxy_of(report, "things.e0040102"), "interface") == "kitchen");
    CHECK(has_logged(report, "things.juice", "seen by the reader hall"));
    for (const auto& line : report.event_log) // in range of one of them all the time
      CHECK(line.what.find("no reader") == std::string::npos);
  }
}

TEST_CASE(
    "a thing carried past three readers has one proxy, of its class, as soon as that is known",
    "[ecology][PXY-03][PXY-09][PXY-10][PXY-11]") {
  auto what = describe(std::string(house) + R"(
[[peer]]
id = 12
name = "bath-pc"
links = ["inproc://hall-pc"]
[[peer.apps]]
app = "rfid_reader"
name = "bath"
position_m = [10, 0, 1]
range = "3m"
[[tag]]
id = "e0050001"
memory = "07"
path = [["0s", [0, 0, 1]], ["20s", [0, 0, 1]], ["100s", [10, 0, 1]]]
[[tag]]
id = "e0060001"
position_m = [0, 1, 1]
[[proxy]]
name = "tool"
ids = ["rfid/e005"]
prefix = "things.{name}"
known_from = "55s"
[[proxy.field]]
name = "size"
encoding = "u8"
decimals = 0
[[proxy.object]]
id = "e0050001"
name = "hammer"
)");
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    auto before = what;
    before.length = 54s;
    auto report = run(before, seed);
    CHECK(report.proxies.size() == 2);
    CHECK(has_logged(report, "hall-pc", "object rfid/e0050001 is one that no proxy class claims"));
    CHECK(has_logged(report, "hall-pc", "object rfid/e0060001 is one that no proxy class claims"));
    before.length = 63s;
    report = run(before, seed);
    CHECK(report.proxies.size() == 3);
    CHECK(value(proxy_of(report, "things.hammer"), "interface") == "hall");
    report = run(what, seed);
    CHECK(report.proxies.size() == 3);
    const auto& hammer = proxy_of(report, "things.hammer");
    CHECK(hammer.proxy_class == "tool");
    CHECK(value(hammer, "interface") == "bath");
    CHECK(value(hammer, "size") == "7");
    CHECK(value(proxy_of(report, "things.juice"), "contents") == "juice");
  }
}

TEST_CASE("a thing that nobody sees is lost where it was last", "[ecology][PXY-16][PXY-20]") {
  auto what = describe(house);
  what.tags[0].path = {{0s, {0.5, 0, 1}}, {60s, {0.5, 0, 1}}, {61s, {100, 0, 1}}};
  const auto report = run(what);
  const auto& juice = proxy_of(report, "things.juice");
  CHECK(juice.status == "lost");
  CHECK(value(juice, "contents") == "juice");
  CHECK(has_logged(report, "things.juice", "seen by no reader"));
}

TEST_CASE("a reader whose computer ends sees nothing any more, until it is started again",
          "[ecology][PXY-07]") {
  auto what = describe(std::string(house) + "[[fault]]\nat = \"20s\"\nkind = \"kill\"\n"
                                            "peer = \"kitchen-pc\"\nfor = \"40s\"\n");
  what.tags[0].path.clear();
  what.tags[0].place = {0.5, 0, 1};
  auto during = what;
  during.length = 55s;
  CHECK(proxy_of(run(during), "things.juice").status == "lost");
  CHECK(proxy_of(run(what), "things.juice").status == "active");
}
