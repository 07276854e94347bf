// Keys that may change while an ecology runs, in a struct of this file.
#include <optional>
#include <string>
#include <vector>

#include "core/describe/changes.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using keys::key_changes;

namespace {

struct lamp {
  duration every = 10s;
  std::uint8_t level = 3;
  double scale = 1;
  bool on = false;
  std::string unit;
  std::optional<duration> off_after;
  std::vector<int> levels; ///< no key_value holds it
  int fixed = 0;

  friend bool operator==(const lamp&, const lamp&) = default;
};

auto keys_of(const lamp*) {
  return keys::of(
      keys::optional("every", &lamp::every, keys::time_span{}, "period").changeable("at once"),
      keys::optional("level", &lamp::level, keys::whole<std::uint8_t>{}, "level").changeable(),
      keys::optional("scale", &lamp::scale, keys::real{}, "scale").changeable(),
      keys::optional("on", &lamp::on, keys::flag{}, "lit").changeable(),
      keys::optional("unit", &lamp::unit, keys::text{}, {"unit", "none"}).replaceable(),
      keys::optional("off_after", &lamp::off_after, keys::time_span{}, {"rest", "never"})
          .replaceable(),
      keys::optional("levels", &lamp::levels, keys::list_of<keys::whole<int>>{}, "levels"),
      keys::optional("fixed", &lamp::fixed, keys::whole<int>{}, "number"));
}

} // namespace

TEST_CASE("what two structs differ in changes the one to the other", "[core][ACT-10]") {
  const lamp before;
  CHECK(keys::changes_between(before, before).empty());
  lamp now;
  now.every = 5s;
  now.level = 200;
  now.on = true;
  now.unit = "lx";
  now.off_after = 1min;
  const auto changes = keys::changes_between(before, now);
  CHECK(changes == key_changes{{"every", duration(5s)},
                               {"level", std::int64_t{200}},
                               {"on", true},
                               {"unit", "lx"},
                               {"off_after", duration(1min)}});
  auto changed = before;
  keys::apply(changes, changed);
  CHECK(changed == now);
  CHECK(keys::values_before(changes, before) ==
        key_changes{{"every", duration(10s)},
                    {"level", std::int64_t{3}},
                    {"on", false},
                    {"unit", ""},
                    {"off_after", duration(1min)}}); // there was none
}

TEST_CASE("what cannot change, or was removed and must not be, is no change", "[core][ACT-10]") {
  lamp before;
  before.unit = "lx";
  before.off_after = 1min;
  lamp now;
  now.fixed = 7;
  now.levels = {1};
  CHECK(keys::changes_between(before, now).empty());
}

TEST_CASE("a value that does not fit leaves its key as it was", "[core][ACT-10]") {
  lamp x;
  keys::apply({{"level", std::int64_t{256}},
               {"every", "often"},
               {"scale", true},
               {"fixed", std::int64_t{1}},
               {"colour", "red"}},
              x);
  CHECK(x == lamp());
}

TEST_CASE("changes read as a file has them, without quotes", "[core][ACT-10]") {
  CHECK(keys::to_text(keys::key_change{"every", duration(5s)}) == "every 5 s");
  CHECK(keys::to_text(keys::key_change{"scale", 0.25}) == "scale 0.25");
  CHECK(keys::to_text(keys::key_change{"on", true}) == "on true");
  CHECK(keys::to_text(keys::key_value(std::int64_t{-3})) == "-3");
  CHECK(keys::to_text(keys::key_value("lx")) == "lx");
}
