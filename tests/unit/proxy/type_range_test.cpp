#include <cstdint>

#include "core/numbers/random.hpp"
#include "proxy/classes/class_table.hpp"
#include "proxy/classes/type_range.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using rubicon::proxy::overlap;
using rubicon::proxy::type_range;
using rubicon::proxy::width;

TEST_CASE("a mask claims the types that agree under it", "[proxy][PXY-11]") {
  const type_range x{0x0100, 0x0100, 0xff00};
  CHECK(holds(x, 0x0100));
  CHECK(holds(x, 0x01ff));
  CHECK(holds(x, 0x770142));
  CHECK(!holds(x, 0x0200));
  CHECK(width(x) == 0xffffff);
  CHECK(width({5, 5, 0xffffffff}) == 0);
  CHECK(width({0, 0, 1}) == 0x7fffffff);
  CHECK(width({100, 199}) == 99);
}

TEST_CASE("the tightest of values, ranges and masks claims a type", "[proxy][PXY-11]") {
  const auto claims = [](const char* name, type_range types) {
    proxy::proxy_class x;
    x.name = name;
    x.types = {types};
    return x;
  };
  const proxy::class_table table(
      {claims("any", {1, 0xffffffff}), claims("family", {0x0100, 0x0100, 0xffffff00}),
       claims("some", {0x0110, 0x011f}), claims("one", {0x0112, 0x0112})});
  const auto of = [&table](std::uint32_t type) {
    return table.find(proxy::signature_of({island_id{1}, mote_id{2}}, type))->name;
  };
  CHECK(of(0x0112) == "one");
  CHECK(of(0x0113) == "some");
  CHECK(of(0x0120) == "family");
  CHECK(of(0x0200) == "any");
}

TEST_CASE("whether two claims overlap is what trying all types says", "[proxy][PXY-11]") {
  random_stream rng(7, "overlap");
  constexpr std::uint32_t types = 64; // of 6 bits; the higher ones are masked as 0
  const auto drawn = [&rng] {
    const auto below = [&rng](std::uint32_t n) { return static_cast<std::uint32_t>(rng.below(n)); };
    if (below(2) == 0) {
      const auto first = below(types);
      return type_range{first, first + below(types - first), 0};
    }
    const auto mask = (below(types - 1) + 1) | ~(types - 1);
    const auto value = below(types) & mask;
    return type_range{value, value, mask};
  };
  unsigned found = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto a = drawn();
    const auto b = drawn();
    bool both = false;
    for (std::uint32_t type = 0; type < types; ++type)
      both = both || (holds(a, type) && holds(b, type));
    found += both ? 1 : 0;
    CAPTURE(a.first, a.last, a.mask, b.first, b.last, b.mask);
    REQUIRE(overlap(a, b) == both);
    REQUIRE(overlap(b, a) == both);
  }
  CHECK(found > 100);
  CHECK(found < 1900);
}
