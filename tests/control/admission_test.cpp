#include "control/admission.hpp"

#include <set>

#include "support/catch.hpp"

using namespace rubicon;
using control::admission;

namespace {

constexpr ipv4_address crowd{10, 0, 0, 1};
constexpr ipv4_address friendly{10, 0, 0, 2};

} // namespace

TEST_CASE("whoever holds many connections pushes out its own, the oldest first", "[control]") {
  admission doors({.all_max = 8, .of_address_max = 4, .per_second = 1000, .at_once = 1000});
  CHECK(doors.arrive(1, friendly, {}).enters);
  for (admission::id who = 2; who < 50; ++who) {
    const auto found = doors.arrive(who, crowd, {});
    CHECK(found.enters);
    CHECK(found.leaves == (who < 6 ? std::nullopt : std::optional(who - 4)));
  }
  CHECK(doors.waiting() == 5);
}

TEST_CASE("when all places are taken, the address with the most gives one up", "[control]") {
  admission doors({.all_max = 4, .of_address_max = 3, .per_second = 1000, .at_once = 1000});
  for (admission::id who = 1; who <= 3; ++who)
    static_cast<void>(doors.arrive(who, crowd, {}));
  CHECK_FALSE(doors.arrive(4, friendly, {}).leaves);
  CHECK(doors.arrive(5, {10, 0, 0, 3}, {}).leaves == 1U);
  doors.leave(2);
  CHECK_FALSE(doors.arrive(6, {10, 0, 0, 4}, {}).leaves);
  doors.leave(99); // harmless
  CHECK(doors.waiting() == 4);
}

TEST_CASE("who comes too often is turned away, others are not", "[control]") {
  admission doors({.all_max = 64, .of_address_max = 16, .per_second = 10, .at_once = 20});
  admission::id who = 0;
  std::size_t entered = 0;
  for (auto now = instant(); now < instant(10s); now += 1ms)
    entered += doors.arrive(++who, crowd, now).enters ? 1 : 0;
  CHECK(entered >= 119);
  CHECK(entered <= 121); // 20 at once, then 10 a second
  CHECK(doors.arrive(++who, friendly, instant(10s)).enters);
  CHECK(doors.arrive(++who, crowd, instant(11s)).enters);
}

TEST_CASE("any number of addresses takes a bounded place", "[control]") {
  admission doors;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const ipv4_address from{10, 1, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)};
    CHECK(doors.arrive(i, from, instant(1ms * i)).enters);
  }
  CHECK(doors.waiting() == control::admission_limits{}.all_max);
}
