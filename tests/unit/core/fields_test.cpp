#include <map>
#include <string>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "support/catch.hpp"

namespace rubicon {

namespace {

struct nothing {};
RUBICON_FIELDS(nothing);

struct load {
  int packets = 0;
  std::map<std::string, int> lost;
  largest<duration> slowest{};
};
RUBICON_FIELDS(load, packets, lost, slowest);

struct plain {
  int packets = 0;
};

template <class T>
std::vector<std::string> names(const T& x) {
  std::vector<std::string> all;
  for_each_field(x, [&](std::string_view name, const auto&) { all.emplace_back(name); });
  return all;
}

TEST_CASE("fields are walked in the order of their list", "[core]") {
  static_assert(described<load> && described<nothing> && !described<plain>);
  CHECK(names(load{}) == std::vector<std::string>{"packets", "lost", "slowest"});
  CHECK(names(nothing{}).empty());
  load x;
  for_each_field(x, [](std::string_view, auto& value) {
    if constexpr (std::is_same_v<std::remove_reference_t<decltype(value)>, int>)
      value = 7;
  });
  CHECK(x.packets == 7);
}

TEST_CASE("records add up field by field", "[core]") {
  load sum{1, {{"full", 2}}, 5ms};
  sum += load{10, {{"crc", 4}, {"full", 3}}, 9ms};
  sum += load{100, {}, 2ms};
  CHECK(sum.packets == 111);
  CHECK(sum.lost == std::map<std::string, int>{{"crc", 4}, {"full", 5}});
  CHECK(sum.slowest.value == 9ms);
}

} // namespace

} // namespace rubicon
