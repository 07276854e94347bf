#include <string>
#include <utility>
#include <vector>

#include "proxy/classes/class_table.hpp"
#include "support/catch.hpp"
#include "unit/proxy/fixture.hpp"

using namespace rubicon;
using namespace rubicon::proxy;
using test::claims;

namespace {

constexpr mote_address some_mote{island_id{5}, mote_id{7}};

std::string class_of(const class_table& table, std::uint32_t type) {
  const auto* const found = table.find(signature_of(some_mote, type));
  return found == nullptr ? "" : found->name;
}

} // namespace

TEST_CASE("a mote's signature names its channel, itself and its type", "[proxy][PXY-11][PXY-15]") {
  CHECK(signature_of(some_mote, 142) == signature{"wsn", "5/7", 142});
  CHECK(proxy_id(some_mote) == "5/7");
}

TEST_CASE("the narrowest range around a type wins", "[proxy][PXY-11][PXY-13][A-33]") {
  const class_table table({claims("any", {{0, 0xffffffff}}), claims("sensors", {{100, 199}}),
                           claims("lamps", {{140, 149}, {500, 500}}),
                           claims("kitchen lamp", {{142, 142}}), claims("twin", {{142, 142}}),
                           claims("upper", {{150, 249}}), claims("reversed", {{20, 10}})});
  const std::vector<std::pair<std::uint32_t, std::string>> expected{
      {0, "any"},       {15, "any"},      {99, "any"},           {100, "sensors"}, {139, "sensors"},
      {140, "lamps"},   {141, "lamps"},   {142, "kitchen lamp"}, {143, "lamps"},   {149, "lamps"},
      {150, "sensors"}, {199, "sensors"}, {200, "upper"},        {249, "upper"},   {250, "any"},
      {500, "lamps"},   {501, "any"},     {0xffffffff, "any"}};
  for (const auto& [type, name] : expected) {
    CAPTURE(type);
    CHECK(class_of(table, type) == name);
  }
}

TEST_CASE("of equally narrow ranges the first in the table wins", "[proxy][PXY-11][A-33]") {
  const auto a = claims("a", {{1, 10}});
  const auto b = claims("b", {{5, 14}});
  CHECK(class_of(class_table({a, b}), 7) == "a");
  CHECK(class_of(class_table({b, a}), 7) == "b");
  CHECK(class_of(class_table({b, a}), 3) == "a");
}

TEST_CASE("a type or channel that no class claims has no class", "[proxy][PXY-10][PXY-11]") {
  const class_table table({claims("sensors", {{100, 199}}), claims("none", {})});
  CHECK(class_of(table, 99).empty());
  CHECK(class_of(table, 200).empty());
  CHECK(class_of(class_table(), 100).empty());
  CHECK(table.find(signature{"rfid", "5/7", 142}) == nullptr);
}

TEST_CASE("a class is found by its name", "[proxy][PXY-09]") {
  const class_table table({claims("sensors", {{100, 199}}), claims("none", {})});
  REQUIRE(table.find("none") != nullptr);
  CHECK(table.find("none")->name == "none");
  CHECK(table.find("sensor") == nullptr);
  CHECK(table.size() == 2);
}
