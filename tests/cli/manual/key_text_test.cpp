#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include "cli/manual/key_place.hpp"
#include "cli/manual/key_text.hpp"
#include "cli/manual/value_kind.hpp"
#include "config/load.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

key_explanation explained(const std::string& key) {
  return explain_key(config::describe_file(), key);
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("a key is explained by its whole path", "[cli][ACT-13]") {
  const auto x = explained("island.duty_cycle.period");
  CHECK(x.is_found);
  CHECK(x.text == "island.duty_cycle.period\n"
                  "  period of the windows, in island time\n"
                  "\n"
                  "  value:    time from 100 ms to 1 h\n"
                  "  unit:     ns, us, ms, s, min, h, d\n"
                  "  default:  \"4s\"\n"
                  "  table:    [island.duty_cycle]\n"
                  "  place:    island.duty_cycle.period\n"
                  "  example:\n"
                  "    [[island]]\n"
                  "    [island.duty_cycle]\n"
                  "    period = \"4s\"\n");
  CHECK(explained("[island.duty_cycle].period").text == x.text);
  CHECK(explained("*.duty_cycle.period").text == x.text);
  CHECK(explained("duty_cycle.period").text == x.text);
}

TEST_CASE("a key that may change while an ecology runs says so", "[cli][ACT-10][ACT-13]") {
  CHECK(contains(explained("proxy.qos.period").text,
                 "  change:   yes: its proxies request it at once\n"));
  CHECK_FALSE(contains(explained("island.duty_cycle.period").text, "change:"));
}

TEST_CASE("a table is explained by its last name, with its keys", "[cli][ACT-13]") {
  const auto x = explained("duty_cycle");
  CHECK(x.is_found);
  CHECK(x.text.starts_with("island.duty_cycle\n  lets radios sleep\n"));
  CHECK(contains(x.text, "  keys:\n"
                         "    period    period of the windows, in island time\n"
                         "    window    "));
  CHECK(x.text.ends_with("  example:\n"
                         "    [[island]]\n"
                         "    [island.duty_cycle]\n"
                         "    period = \"4s\"\n"));
}

TEST_CASE("of a table the keys that it needs are in its example", "[cli][ACT-13]") {
  const auto island = explained("island");
  CHECK(contains(island.text, " (required)\n"));
  CHECK(contains(island.text, "    [[island]]\n    id = 1\n    name = "));
  std::size_t tables = 0;
  const auto file = config::describe_file();
  for (const auto& each : all_places(file))
    if (each.key->table && ++tables % 7 == 0) { // some of the many
      INFO(each.path());
      const auto x = explained(each.path());
      CHECK(contains(x.text, "  keys:\n    "));
    }
  CHECK(tables > 50);
}

TEST_CASE("a name of a file stands for any name", "[cli][ACT-13]") {
  const auto x = explained("mote_type.climate.type");
  CHECK(x.is_found);
  CHECK(x.text.starts_with("mote_type.NAME.type\n"));
  CHECK(contains(x.text, "    [mote_type.NAME]\n    type = "));
  CHECK_FALSE(explained("anything").is_found);
}

TEST_CASE("a key of one kind of program has this kind in its example", "[cli][ACT-13]") {
  const auto x = explained("island.mote.apps.dead_band");
  CHECK(x.is_found);
  CHECK(contains(x.text, "    [[island]]\n    [[island.mote]]\n    [[island.mote.apps]]\n"
                         "    app = \"sampler\"\n    dead_band = { temperature = 0.5 }\n"));
}

TEST_CASE("what a key is in several tables is said once, with some of its places",
          "[cli][ACT-13]") {
  const auto power = explained("power");
  CHECK(contains(power.text, "\n  table:    [mote_type.NAME], [[island.mote]], [[island.group]]\n"
                             "  place:    mote_type.NAME.power\n"
                             "            island.mote.power\n"
                             "            island.group.power\n"));
  CHECK(power.text.find("island.mote.power") == power.text.rfind("island.mote.power"));
  const auto model = explained("transducers.temperature.model");
  CHECK(model.is_found);
  const auto all = explained("model");
  CHECK(contains(all.text, "\n            and 21 more\n"));
  CHECK(std::count(all.text.begin(), all.text.end(), '\n') < 60);
}

TEST_CASE("of many keys each has a line, and a longer path is asked for", "[cli][ACT-13]") {
  const auto x = explained("every");
  CHECK(x.is_found);
  CHECK(contains(x.text, "proxy.field.every"));
  CHECK(contains(x.text, "give more of the path"));
}

TEST_CASE("for a key that does not exist the nearest ones are suggested", "[cli][ACT-13]") {
  CHECK(explained("duty_cicle").text == "there is no key `duty_cicle`: did you mean `duty_cycle`?");
  CHECK(contains(explained("island.mote.tpye").text, "did you mean `island.mote.type`"));
  CHECK(contains(explained("island.*.duration").text, "`ecology.duration`"));
  CHECK(contains(explained("zzzzzzzz").text, "docs/configuration.md"));
  CHECK_FALSE(explained(std::string(100'000, 'a')).is_found);
  CHECK_FALSE(explained("").is_found);
  CHECK_FALSE(explained("*.*.*.*.*.*.*.*.*.*.*.*").is_found);
}

TEST_CASE("every key is found by its path, with an example of a value", "[cli][ACT-13]") {
  const auto file = config::describe_file();
  const auto all = all_places(file);
  REQUIRE(all.size() > 500);
  for (const auto& each : all) {
    CAPTURE(each.path(), each.title);
    const auto found = places_of(all, each.path());
    CHECK(std::ranges::find(found, each.key, &key_place::key) != found.end());
    if (each.key->part == config::part::value)
      CHECK_FALSE(sample_of(*each.key).empty());
    CHECK_FALSE(contains(plain_text(each.key->meaning), "]("));
  }
}

TEST_CASE("kinds of values have the units of the reference", "[cli][docs]") {
  std::ifstream file(RUBICON_SOURCE_DIR "/docs/configuration.md");
  std::ostringstream text;
  text << file.rdbuf();
  for (const auto& kind : kinds_with_units()) {
    CAPTURE(kind.name);
    const auto row = text.str().find("\n| " + std::string(kind.name) + " | ");
    REQUIRE(row != std::string::npos);
    const auto line = text.str().substr(row + 1, text.str().find('\n', row + 1) - row);
    std::istringstream units{std::string(kind.units)};
    for (std::string unit; units >> unit;) {
      unit.erase(std::remove(unit.begin(), unit.end(), ','), unit.end());
      if (unit != "none" && unit != "or")
        CHECK(contains(line, unit));
    }
  }
}

TEST_CASE("Markdown becomes plain text", "[cli]") {
  CHECK(plain_text("`a` or [b](#d), `[[\"0s\", 21.0]]`") == "a or b, [[\"0s\", 21.0]]");
  CHECK(plain_text("table [`[[island]]`](#island)") == "table [[island]]");
  CHECK(plain_text("[") == "[");
  CHECK(plain_text("a\\") == "a\\");
}
