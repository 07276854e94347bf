// Whether a tick has slots for what motes send at it, and what docs/radio.md says of that.
#include <fstream>
#include <sstream>
#include <string>

#include "config/checks/slot_check.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

constexpr std::size_t packet_max = 108;

/// Motes 20 m apart, who reach 25 m; the first and the last send each other vectors of `size`.
std::string line(int hops, int size, const std::string& tick, const std::string& mac = "standard") {
  std::ostringstream toml;
  toml << "[ecology]\nname = \"t\"\ntick = \"" << tick << "\"\n"
       << "[radio]\nrange = \"25m\"\nmac.micaz = \"" << mac << "\"\n"
       << "[[island]]\nname = \"k\"\nid = 1\nsink.position_m = [0, 0]\n";
  for (int i = 0; i <= hops; ++i) {
    toml << "[[island.mote]]\nid = " << 2 + i << "\nname = \"n" << i
         << "\"\ntype = 1\nposition_m = [" << 20 + 20 * i << ", 0]\n";
    if (i == 0 || i == hops) {
      const auto end = "[{ node = \"k/n" + std::to_string(hops - i) +
                       "\", size = " + std::to_string(size) + " }]";
      toml << "apps = [{ app = \"reservoir\", from = " << end << ", to = " << end << " }]\n";
    }
  }
  return toml.str();
}

/// The table of docs/radio.md.
std::string table() {
  constexpr std::size_t hops[] = {1, 2, 3, 4, 6, 8};
  std::ostringstream text;
  text << "| elements |";
  for (const auto each : hops)
    text << ' ' << each << (each == 1 ? " hop |" : " hops |");
  text << "\n|---|---|---|---|---|---|---|\n";
  for (const std::size_t elements : {6U, 10U, 25U, 26U, 50U, 64U}) {
    text << "| " << elements << " |";
    for (const auto each : hops) {
      const mote::vector_flow flow[] = {{elements, each}};
      const auto units = units_of(flow, packet_max, {});
      text << ' ' << units << " ms:";
      for (const auto tick : {100ms, 500ms, 2000ms})
        text << ' ' << network::tick_plan(tick).units() / units;
      text << " |";
    }
    text << '\n';
  }
  return text.str();
}

} // namespace

TEST_CASE("slots that a tick has no room for are told, with the sum", "[config][SYN-16]") {
  CHECK(problem_in(line(8, 64, "500ms")) == "none");
  CHECK(problem_in(line(8, 64, "2s", "cc2420")) == "none");
  CHECK(problem_in(line(1, 10, "80ms")) == "none");
  CHECK(problem_in(line(8, 64, "200ms")) ==
        "16:17: synaptic vectors of 2 motes need 328 ms of slots at each tick, 164 ms of them `n0` "
        "(64 "
        "elements in 3 packets over 8 hops), but a tick of 200 ms has 160 ms for them");
  CHECK(problem_in(line(8, 64, "500ms", "cc2420")).find("a tick of 500 ms has 400 ms for them") !=
        std::string::npos); // whose back-offs are longer
  CHECK(problem_in(line(8, 64, "399ms")).find("has 319 ms for them") != std::string::npos);
  CHECK(problem_in(line(8, 64, "420ms")) == "none");
}

TEST_CASE("the document's table of slots is what is reckoned with", "[config][SYN-16]") {
  std::ostringstream document;
  document << std::ifstream(RUBICON_SOURCE_DIR "/docs/radio.md").rdbuf();
  INFO(table());
  CHECK(document.str().find(table()) != std::string::npos);
}

TEST_CASE("hops are counted over motes that reach each other, the sink among them", "[config]") {
  const auto x = good(line(3, 10, "500ms"));
  const auto& island = x.islands.at(0);
  const auto needs = slot_needs(island, 25, access_of(x.radio, island), {});
  REQUIRE(needs.size() == 2);
  CHECK(needs[0].mote == "n0");
  REQUIRE(needs[0].flows.size() == 1);
  CHECK(needs[0].flows[0].hops == 3);
  CHECK(slot_needs(island, 45, access_of(x.radio, island), {})[0].flows[0].hops == 2);
  CHECK(slot_needs(island, {}, access_of(x.radio, island), {})[0].flows[0].hops == 1);
}
