#include <string>

#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// head, whose peer starts proxies of objects; what follows stands from line 7.
const std::string object_head =
    std::string(head) + "apps = [{ app = \"proxy_manager\", islands = [], objects = true }]\n";

} // namespace

TEST_CASE("readers, tags and what is known of objects arrive", "[config][PXY-02][PXY-05]") {
  const auto x = good(std::string(head) + R"(
[[peer.apps]]
app = "proxy_manager"
objects = true
[[peer.apps]]
app = "rfid_reader"
position_m = [1, 2, 3]
[[peer.apps]]
app = "rfid_reader"
name = "hall"
position_m = [4, 5]
range = "2m"
period = "250ms"
miss_rate = "10%"
missed_max = 4
[[tag]]
id = "E00401"
memory = "010a"
position_m = [1, 1]
[[tag]]
id = "e00402"
path = [["0s", [0, 0]], ["10s", [4, 0]]]
[[proxy]]
name = "milk"
ids = ["rfid/E004", "rfid/ab"]
properties = { shape = "box" }
[[proxy.field]]
name = "litres"
encoding = "u8"
[[proxy.object]]
id = "E00401"
name = "fresh"
properties = { colour = "white" }
)");
  const auto& apps = x.peers.at(0).apps;
  CHECK(std::get<proxy_manager_app>(apps.at(0)).objects);
  const auto& pc = std::get<rfid::reader_config>(apps.at(1));
  CHECK(pc.name == "pc");
  CHECK(pc.place == position{1, 2, 3});
  CHECK(pc.range_m == 1);
  const auto& hall = std::get<rfid::reader_config>(apps.at(2));
  CHECK(hall.name == "hall");
  CHECK(hall.range_m == 2);
  CHECK(hall.period == 250ms);
  CHECK(hall.miss_rate == 0.1);
  CHECK(hall.missed_max == 4);
  REQUIRE(x.tags.size() == 2);
  CHECK(x.tags[0].id == "e00401");
  CHECK(x.tags[0].memory == bytes{1, 10});
  CHECK(x.tags[0].place == position{1, 1, 0});
  CHECK(x.tags[0].path.empty());
  CHECK(x.tags[1].path.size() == 2);
  const auto& milk = x.proxies.at(0);
  REQUIRE(milk.ids.size() == 2);
  CHECK(milk.ids[0].channel == "rfid");
  CHECK(milk.ids[0].prefix == "e004");
  CHECK(milk.prefix == "{channel}.{name}");
  REQUIRE(milk.objects.size() == 1);
  CHECK(milk.objects[0].id == "E00401");
  CHECK(milk.objects[0].name == "fresh");
  CHECK(milk.objects[0].properties.at(0).second == "white");
  const auto text = summary(x);
  CHECK(text.find("proxy manager (tagged objects), reader pc, reader hall") != std::string::npos);
  CHECK(text.find("milk  ids rfid/e004*, rfid/ab*  {channel}.{name}  litres") != std::string::npos);
  CHECK(text.find("e00402  0 octets  is carried") != std::string::npos);
}

TEST_CASE("tags, readers and classes of objects have to be possible", "[config][PXY-11]") {
  const row rows[] = {
      {"[[tag]]\nid = \"a\"\n", "7:1: `position_m` is missing in [[tag]]"},
      {"[[tag]]\nid = \"a\"\nposition_m = [1, 2]\n[[tag]]\nid = \"A\"\nposition_m = [1, 2]\n",
       "11:6: tag `A` is already taken (line 8, column 6)"},
      {"[[tag]]\nid = \"a\"\nposition_m = [0, 0]\npath = [[\"0s\", [1, 2]]]\n",
       "10:8: `path` begins at 0 s, for which there is `position_m` already"},
      {"[[tag]]\nid = \"a\"\npath = [[\"1s\", [1, 2]]]\n",
       "9:8: `path` must begin at \"0s\", or there must be a `position_m`"},
      {"[[proxy]]\nname = \"p\"\n",
       "7:1: a proxy needs either `types`, of motes, or `ids`, of tagged objects"},
      {"[[proxy]]\nname = \"p\"\ntypes = [7]\nids = [\"rfid/\"]\n",
       "7:1: a proxy needs either `types`, of motes, or `ids`, of tagged objects"},
      {"[[proxy]]\nname = \"p\"\nids = [\"bluetooth/a\"]\n",
       "9:8: `ids` must be \"rfid/\" and how ids begin, as in \"rfid/e004\", not \"bluetooth/a\""},
      {"[[proxy]]\nname = \"p\"\nids = [\"rfid/a\"]\n[[proxy]]\nname = \"q\"\nids = [\"rfid/A\"]\n",
       "12:8: id pattern `rfid/a` is already taken (line 9, column 8)"},
      {"[[proxy]]\nname = \"p\"\nids = [\"rfid/a\"]\nprefix = \"{island}.x\"\n",
       "10:10: tagged objects have no {island}; use {channel}"},
      {"[[proxy]]\nname = \"p\"\ntypes = [7]\nprefix = \"{channel}.x\"\n",
       "10:10: motes have an {island}, not a {channel}"},
      {"[[proxy]]\nname = \"p\"\nids = [\"rfid/a\"]\n[[proxy.input]]\nname = \"i\"\nchannel = 1\n"
       "words = { on = \"01\" }\n",
       "10:1: tagged objects have no inputs"},
      {"[[proxy]]\nname = \"p\"\nids = [\"rfid/a\"]\n[[proxy.field]]\nname = \"position\"\n",
       "11:8: `position` is a tuple that proxies set by themselves"},
  };
  for (const auto& x : rows) {
    CAPTURE(x.toml);
    const auto found = problem_after(object_head, x.toml);
    CHECK(found == x.problem);
  }
  check_mistakes(head, R"(
apps = [{ app = "rfid_reader", position_m = [0, 0], range = "1km" }]
#                                                           ^ `range` must be a length from 0.05 m
#   to 100 m with its unit (cm, m or km), as in "25m", not "1km"

[[proxy]]
#< no component starts proxies of tagged objects: a "proxy_manager" needs `objects = true`
name = "p"
ids = ["rfid/a"]
)");
  check_mistakes(object_head, R"(
[[peer]]
name = "pc2"
id = 301
apps = [{ app = "proxy_manager", objects = true }]
#                                          ^ the proxy manager of tagged objects is already taken
#   (line 6, column 58)
)");
}
