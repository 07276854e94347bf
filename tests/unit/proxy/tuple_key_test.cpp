#include <string>

#include "proxy/classes/tuple_key.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::proxy;

namespace {

proxy_identity kitchen_climate() {
  return {{island_id{5}, mote_id{7}}, "kitchen", "climate"};
}

} // namespace

TEST_CASE("a prefix names island, id and mote", "[proxy][PXY-15]") {
  const auto who = kitchen_climate();
  CHECK(key_prefix("{island}.{name}", who) == "kitchen.climate");
  CHECK(key_prefix("{island}.{name}-{id}", who) == "kitchen.climate-7");
  CHECK(key_prefix("home.{id}", who) == "home.7");
  CHECK(key_prefix("{name}{name}", who) == "climateclimate");
  CHECK(key_prefix("fixed", who) == "fixed");
}

TEST_CASE("a name never splits a key and never makes it a wildcard", "[proxy][TUP-03]") {
  CHECK(key_part("a.b") == "a_b");
  CHECK(key_part("*") == "_");
  CHECK(key_part("lamp 1(x)") == "lamp_1_x_");
  CHECK(key_part("Az-09_") == "Az-09_");
  CHECK(key_part("k\xc3\xbc"
                 "che") == "k__che");
  CHECK(key_part(std::string("a\0b", 3)) == "a_b");
  CHECK(key_part("") == "_");
  CHECK(key_parts("a..b*.c") == "a._.b_.c");
  CHECK(key_parts("") == "_");
  auto who = kitchen_climate();
  who.island_name = "old.town";
  who.mote_name = "{island}";
  CHECK(key_prefix("{island}.{name}", who) == "old_town._island_");
  CHECK(key_prefix("{color}.{name", who) == "_color_._name");
}

TEST_CASE("a mote or island without name is called by its id", "[proxy][PXY-15]") {
  const proxy_identity who{{island_id{5}, mote_id{7}}, "", ""};
  CHECK(key_prefix("{island}.{name}", who) == "5.mote-7");
}

TEST_CASE("a key fits with up to 127 characters and 7 parts", "[proxy][TUP-03]") {
  CHECK(fits_tuple_key(std::string(127, 'a')));
  CHECK_FALSE(fits_tuple_key(std::string(128, 'a')));
  CHECK(fits_tuple_key("1.2.3.4.5.6.7"));
  CHECK_FALSE(fits_tuple_key("1.2.3.4.5.6.7.8"));
}

TEST_CASE("keys are compared without letter case", "[proxy][TUP-03]") {
  CHECK(same_key("Kitchen.LAMP", "kitchen.lamp"));
  CHECK_FALSE(same_key("kitchen.lamp", "kitchen.lamps"));
  CHECK_FALSE(same_key("kitchen.lamp", "kitchen_lamp"));
  CHECK(same_key("", ""));
}
