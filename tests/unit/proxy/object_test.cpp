#include "core/tuples/interface_keys.hpp"
#include "proxy/object_manager.hpp"
#include "proxy/object_proxy.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"

using namespace rubicon;
using namespace rubicon::proxy;
using test::start;

namespace {

constexpr peer_id kitchen_pc{11};
constexpr peer_id robot{30};
using lines = std::vector<std::string>;

bytes text_value(std::string_view text) {
  auto octets = to_bytes(text);
  octets.push_back(0); // text travels with its NUL
  return octets;
}

proxy_class milk_boxes() {
  proxy_class x;
  x.name = "milk";
  x.ids = {{"rfid", "e004"}};
  x.prefix = "things.{name}";
  x.properties = {{"shape", "box"}};
  x.objects = {{"E0040101", "milk", {{"colour", "white"}, {"grasp", "0.03 0 0.1"}}}};
  x.fields = {{"food", 0, 0, encoding::u8, 1, 0, 0, "", {{1, "milk"}, {2, "juice"}}},
              {"litres", 0, 1, encoding::u8, 0.1, 0, 1, "l", {}}};
  return x;
}

object_proxy made() {
  return object_proxy(milk_boxes(), {"rfid", "e0040101", 0});
}

lines lines_of(const object_proxy::outputs& outputs) {
  lines all;
  for (const auto& x : outputs)
    all.push_back(std::get<publish>(x).key + " = " + std::get<publish>(x).text);
  return all;
}

struct perceived_milk {
  perceived_milk() { static_cast<void>(core.start(start)); }

  lines strength(peer_id owner, const std::string& name, std::string_view dbm, instant now) {
    return lines_of(core.on_tuple(owner, "interface." + name + ".objects.e0040101.rssi",
                                  text_value(dbm), dbm.empty(), now));
  }

  object_proxy core = made();
};

} // namespace

TEST_CASE("interfaces publish what they perceive in tuples of their own", "[core][PXY-02]") {
  for (const auto* key :
       {"interface.hall.channel", "interface.hall.position", "interface.hall.objects",
        "interface.hall.objects.e00401.rssi", "interface.hall.objects.e00401.memory"}) {
    const auto parsed = parse_interface_key(key);
    REQUIRE(parsed);
    CHECK(to_string(*parsed) == key);
  }
  CHECK(parse_interface_key("Interface.Hall.Objects.E00401.RSSI")->object == "e00401");
  for (const auto* key :
       {"", "interface", "interface.hall", "interface..objects", "interface.*.objects",
        "interface.hall.rssi", "interface.hall.things", "interface.hall.objects.e1",
        "interface.hall.objects.e1.objects", "interface.hall.channel.e1.rssi",
        "interfaces.hall.objects", "interface.hall.objects.e1.rssi.x"})
    CHECK(!parse_interface_key(key));
  CHECK(object_list_text({"b", "a", "b"}) == "{a,b}");
  CHECK(*parse_object_list("{}") == lines{});
  CHECK(*parse_object_list("{a,b}") == lines{"a", "b"});
  for (const auto* text : {"", "{", "a", "{b,a}", "{a,a}", "{a,}", "{,a}", "{A}", "{a b}"})
    CHECK(!parse_object_list(text));
  CHECK(position_text({1.5, -0.004, -12.345}) == "1.50 0.00 -12.35");
}

TEST_CASE("a tagged object's proxy knows it from the table", "[proxy][PXY-05]") {
  auto x = made();
  CHECK(lines_of(x.start(start)) ==
        lines{"things.milk.class = milk", "things.milk.id = rfid/e0040101",
              "things.milk.shape = box", "things.milk.colour = white",
              "things.milk.grasp = 0.03 0 0.1", "things.milk.litres.unit = l",
              "things.milk.interface = none", "things.milk.position = unknown",
              "things.milk.status.cause = none", "things.milk.status.since = 0.000000",
              "things.milk.status = active"});
  CHECK(x.watches() == lines{"interface.*.objects.e0040101.rssi",
                             "interface.*.objects.e0040101.memory", "interface.*.position"});
  object_proxy other(milk_boxes(), {"rfid", "e0049999", 0});
  CHECK(other.prefix() == "things.e0049999");
}

TEST_CASE("the memory of a tag becomes readings, whichever reader has it",
          "[proxy][PXY-04][PXY-05]") {
  perceived_milk x;
  const auto read = [&](peer_id owner, const bytes& memory) {
    return lines_of(
        x.core.on_tuple(owner, "interface.kitchen.objects.e0040101.memory", memory, false, start));
  };
  CHECK(read(kitchen_pc, {2, 15, 0xff}) ==
        lines{"things.milk.food = juice", "things.milk.litres = 1.5"});
  CHECK(read(robot, {2, 15, 0xff}).empty());
  CHECK(read(robot, {2}).empty());
  CHECK(x.core.counters().short_memories == 1);
  CHECK(lines_of(x.core.on_tuple(robot, "interface.kitchen.objects.e0049999.memory", bytes{1, 1},
                                 false, start))
            .empty());
  CHECK(x.core.counters().foreign_tuples == 1);
}

TEST_CASE("a proxy follows its object from one interface to the next",
          "[proxy][PXY-03][PXY-06][PXY-07]") {
  perceived_milk x;
  for (const auto& [owner, name, place] : {std::tuple(kitchen_pc, "kitchen", "1.00 2.00 1.00"),
                                           std::tuple(robot, "hall", "5.00 2.00 1.00")})
    static_cast<void>(x.core.on_tuple(owner, "interface." + std::string(name) + ".position",
                                      text_value(place), false, start));
  CHECK(x.strength(kitchen_pc, "kitchen", "-40", start + 1s) ==
        lines{"things.milk.interface = kitchen", "things.milk.position = 1.00 2.00 1.00"});
  CHECK(x.strength(robot, "hall", "-38", start + 2s).empty()); // not enough to switch
  CHECK(x.strength(kitchen_pc, "kitchen", "-43", start + 3s) ==
        lines{"things.milk.interface = hall", "things.milk.position = 5.00 2.00 1.00"});
  CHECK(x.strength(kitchen_pc, "kitchen", "", start + 4s).empty());
  CHECK(x.strength(robot, "hall", "nonsense", start + 4s).empty());
  CHECK(x.core.counters().bad_values == 1);
  CHECK(x.core.counters().switches == 2);
  CHECK(x.strength(kitchen_pc, "kitchen", "-20", start + 5s).size() == 2);
  CHECK(x.strength(kitchen_pc, "kitchen", "", start + 6s) ==
        lines{"things.milk.interface = hall", "things.milk.position = 5.00 2.00 1.00"});
}

TEST_CASE("an object that is not perceived for a while is lost where it was last",
          "[proxy][PXY-16][PXY-20]") {
  perceived_milk x;
  static_cast<void>(x.strength(kitchen_pc, "kitchen", "-40", start + 1s));
  CHECK(!x.core.deadline());
  CHECK(x.strength(kitchen_pc, "kitchen", "", start + 10s).empty());
  CHECK(x.core.deadline() == start + 12s);
  CHECK(x.core.on_time(start + 11s).empty());
  CHECK(lines_of(x.core.on_time(start + 12s)) == lines{"things.milk.status.cause = not_perceived",
                                                       "things.milk.status.since = 12.000000",
                                                       "things.milk.status = lost"});
  CHECK(x.strength(robot, "hall", "-60", start + 20s) ==
        lines{"things.milk.interface = hall", "things.milk.position = unknown",
              "things.milk.status.cause = none", "things.milk.status.since = 20.000000",
              "things.milk.status = active"});
  auto never = made();
  static_cast<void>(never.start(start));
  CHECK(lines_of(never.on_time(start + 2s)).back() == "things.milk.status = lost");
}

TEST_CASE("every object that a class claims gets one proxy, others are reported once",
          "[proxy][PXY-01][PXY-09][PXY-10][PXY-11]") {
  auto cold = milk_boxes();
  cold.name = "cold milk";
  cold.ids = {{"rfid", "e00402"}};
  object_manager x(class_table({milk_boxes(), cold}));
  const auto hear = [&](peer_id owner, const std::string& key, std::string_view value) {
    lines all;
    for (const auto& each : x.on_tuple(owner, key, text_value(value), false)) {
      if (const auto* started = std::get_if<start_object_proxy>(&each))
        all.push_back(started->percept.hardware_id + ' ' + started->class_name);
      else
        all.push_back("unknown " + std::get<unknown_object>(each).percept.hardware_id);
    }
    return all;
  };
  CHECK(hear(robot, "interface.hall.objects", "{e0040101}").empty()); // of which kind?
  CHECK(hear(robot, "interface.hall.channel", "rfid") == lines{"e0040101 milk"});
  CHECK(hear(kitchen_pc, "interface.kitchen.channel", "rfid").empty());
  CHECK(hear(kitchen_pc, "interface.kitchen.objects", "{aa01,e0040101,e0040201}") ==
        lines{"unknown aa01", "e0040201 cold milk"}); // the longest prefix wins
  CHECK(hear(robot, "interface.hall.objects", "{}").empty());
  CHECK(hear(robot, "interface.hall.objects", "{aa01,e0040101}").empty());
  CHECK(hear(robot, "interface.hall.objects", "{?}").empty());
  CHECK(x.counters().bad_lists == 1);
  CHECK(hear(robot, "devices", "{1}").empty());
  CHECK(x.counters().foreign_tuples == 1);

  auto rest = milk_boxes();
  rest.name = "thing";
  rest.ids = {{"rfid", ""}};
  const auto more = x.on_classes(class_table({milk_boxes(), cold, rest}));
  REQUIRE(more.size() == 1);
  CHECK(std::get<start_object_proxy>(more[0]).class_name == "thing");
  CHECK(x.running() == 3);
  const auto again = x.on_proxy_gone({"rfid", "e0040101", 0});
  REQUIRE(again.size() == 1);
  CHECK(std::get<start_object_proxy>(again[0]).percept.hardware_id == "e0040101");
}

TEST_CASE("templates of tagged objects show what their memory says", "[proxy][PXY-04][PXY-05]") {
  auto what = milk_boxes();
  what.tuples = {{"{channel}.{name}.about", "a {shape} of {class}, {colour}", {}},
                 {"{channel}.{name}.content", "", {"food", "litres"}}};
  object_proxy x(what, {"rfid", "e0040101", 0});
  const auto first = lines_of(x.start(start));
  CHECK(std::ranges::count(first, "rfid.milk.about = a box of milk, white") == 1);
  const auto later = lines_of(x.on_tuple(kitchen_pc, "interface.kitchen.objects.e0040101.memory",
                                         bytes{1, 15}, false, start + 2s));
  REQUIRE(later.size() == 3);
  CHECK(later[2] == R"(rfid.milk.content = {"time":2.0,"food":{"value":"milk"},)"
                    R"("litres":{"value":1.5,"unit":"l"}})");
}
