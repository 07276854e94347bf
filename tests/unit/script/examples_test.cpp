// The scripts of config/lua, each alone.
#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "config/load.hpp"
#include "support/catch.hpp"
#include "unit/script/node.hpp"

using namespace rubicon;
using communication::SUCCESS;
using script::scripted;
using script::texts;

namespace {

std::string example(const std::string& name) {
  const auto path = std::string(RUBICON_SOURCE_DIR) + "/config/lua/" + name;
  auto file = config::read_file(path, script::source_octets_max);
  INFO(path << ' ' << file.reason);
  REQUIRE(file.text);
  return *std::move(file.text);
}

void read(scripted& x, int count) {
  x.program.transducersRead(std::array{static_cast<std::int16_t>(count)}, 0x01020304);
}

bytes counts(int x) {
  const auto octets = static_cast<std::uint16_t>(x);
  return {static_cast<std::uint8_t>(octets >> 8), static_cast<std::uint8_t>(octets & 0xff)};
}

} // namespace

TEST_CASE("the sampler in Lua samples while its mote is a member", "[script][MCK-01]") {
  scripted x(example("sampler.lua"), 1, {}, {{"every", 10}});
  x.start();
  CHECK_FALSE(x.program.deadline());
  x.program.joined(5, 2, SUCCESS);
  x.run_for(35s);
  CHECK(x.node.commands.size() >= 3);
  CHECK(x.node.commands.back() == "read_transducers 0");
  read(x, -2);
  CHECK(x.node.commands.back() == "send 255/65533 type 1 255 254 1 2 3 4");
  x.program.joined(5, 2, communication::FAIL);
  CHECK_FALSE(x.program.deadline());
}

TEST_CASE("the dead band in Lua sends what has changed, and after a silence", "[script]") {
  scripted x(example("band.lua"), 1, {}, {{"to", 4}, {"band", 5}, {"silence", 60}});
  x.start();
  for (const int count : {200, 204, 196, 205, 209, 201})
    read(x, count);
  CHECK(x.node.commands ==
        texts{"send 255/4 type 30 reliable 0 200", "send 255/4 type 30 reliable 0 205"});
  x.node.time += 60s;
  read(x, 205);
  CHECK(x.node.commands.size() == 3);
  x.program.joined(5, 2, SUCCESS);
  read(x, 205);
  CHECK(x.node.commands.size() == 4);
}

TEST_CASE("the average in Lua sends rounded means", "[script]") {
  scripted x(example("average.lua"), 1, {}, {{"samples", 4}});
  x.start();
  for (const int count : {1, 2, 2, 1, 3, 3, 3, 3})
    read(x, count);
  CHECK(x.node.commands == texts{"send 255/65533 type 1 0 2", "send 255/65533 type 1 0 3"});
}

TEST_CASE("the controller in Lua has two thresholds, and repeats what is not acknowledged",
          "[script]") {
  scripted x(example("controller.lua"), 1, {}, {{"to", 5}, {"on_at", 250}, {"off_at", 230}});
  x.start();
  x.node.commands.clear();
  const auto give = [&](int count) {
    x.program.receiveFrom({island_id{1}, mote_id{2}}, counts(count), 30);
  };
  for (const int count : {249, 250, 240, 231, 230, 240, 249})
    give(count);
  CHECK(x.node.commands == texts{"send 255/5 type 2 reliable 1", "send 255/5 type 2 reliable 0"});
  x.program.ackOf(7, communication::FAIL);
  x.run_for(5s);
  CHECK(x.node.commands.size() == 3);
  x.program.ackOf(7, SUCCESS);
  CHECK_FALSE(x.program.deadline());
  x.node.accepts = false;
  give(260);
  x.run_for(11s);
  CHECK(x.node.commands.size() == 6);
  CHECK(x.program.figures().back() == apps::figure{"switched", 3, false});
}

TEST_CASE("the actuator in Lua obeys and answers", "[script]") {
  scripted x(example("actuator.lua"));
  x.start();
  x.program.receiveFrom({island_id{1}, mote_id{4}}, bytes{1}, 2);
  x.program.receiveFrom({island_id{1}, mote_id{4}}, bytes{}, 2);
  x.program.actuatorChanged("fan", 1, true);
  CHECK(x.node.commands ==
        texts{"provide 2", "set_actuator fan 1", "send 255/65533 type 2 reliable 1"});
}

TEST_CASE("the roster in Lua lists motes in ascending order", "[script]") {
  scripted x(example("roster.lua"));
  x.start();
  for (const int mote : {9, 3, 9, 5})
    x.program.moteJoined(static_cast<std::uint16_t>(mote), {});
  CHECK(x.program.take_notices().back() == "motes so far: 3 5 9");
}

TEST_CASE("the scripts of docs/lua.md run", "[script][docs]") {
  auto file = config::read_file(std::string(RUBICON_SOURCE_DIR) + "/docs/lua.md", 1 << 20);
  REQUIRE(file.text);
  const std::string_view all = *file.text;
  constexpr std::string_view opening = "```lua\n";
  std::size_t count = 0;
  for (auto at = all.find(opening); at != std::string_view::npos; at = all.find(opening, at + 1)) {
    at += opening.size();
    scripted x(std::string(all.substr(at, all.find("```\n", at) - at)));
    x.start();
    for (const int degrees : {200, 260, 240, 225})
      read(x, degrees);
    x.run_for(1min);
    ++count;
    if (count == 1) // the fan
      CHECK(std::ranges::count(x.node.commands, "set_actuator fan 1") == 1);
  }
  CHECK(count == 3);
}
