#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "proxy/classes/program.hpp"
#include "proxy/proxy.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"

using namespace rubicon;
using rubicon::proxy::encoding;
using rubicon::proxy::make_occupancy;
using rubicon::proxy::program_factory;
using rubicon::proxy::program_problem;
using rubicon::proxy::proxy_class;
using rubicon::proxy::publish;
using test::start;

namespace {

proxy_class room() {
  proxy_class x;
  x.name = "room";
  x.fields = {{"motion", 1, 0, encoding::u8, 1, 0, 0, "", {}},
              {"sound", 1, 1, encoding::u8, 1, 0, 0, "dB", {}},
              {"door", 1, 2, encoding::u8, 1, 0, 0, "", {{0, "closed"}}}};
  return x;
}

using lines = std::vector<std::string>;

/// The tuples of programs, without those of fields and states.
lines lines_of(const proxy::proxy::outputs& outputs, const std::string& name) {
  lines out;
  for (const auto& x : outputs)
    if (const auto* set = std::get_if<publish>(&x))
      if (set->key.find(name) != std::string::npos)
        out.push_back(set->key + " = " + set->text);
  return out;
}

proxy::proxy with_program(program_factory make) {
  auto what = room();
  what.make_program = std::move(make);
  return proxy::proxy(what, {{island_id{5}, mote_id{7}}, "hall", "room"});
}

proxy::proxy with_occupancy(const proxy::program_settings& settings) {
  return with_program(std::get<program_factory>(make_occupancy(room(), settings)));
}

/// A program as somebody else may write it: how much the sound has risen, and how often it reported
/// that.
class rise final : public proxy::program {
public:
  [[nodiscard]] std::vector<std::string> names() const override { return {"rise"}; }
  [[nodiscard]] readings start(instant) override { return {}; }
  [[nodiscard]] readings on_readings(const readings& x, instant) override {
    const auto value = std::stoi(x.at(1).text);
    const auto by = value - std::exchange(last_, value);
    return {{"rise", std::to_string(by), "dB"}, {"stranger", "1", ""}};
  }

private:
  int last_ = 0;
};

} // namespace

TEST_CASE("occupancy holds for a while after the last sign", "[proxy][PXY-04]") {
  auto aut = with_occupancy({{"motion", 0}, {"sound", 60}, {"hold_s", 30}});
  CHECK(lines_of(aut.start(start), "occupied") ==
        lines{"hall.room.occupied.by = none", "hall.room.occupied = no"});
  CHECK(lines_of(aut.on_output(1, bytes{0, 60, 0}, start + 1s), "occupied").empty());
  CHECK(lines_of(aut.on_output(1, bytes{0, 61, 0}, start + 2s), "occupied") ==
        lines{"hall.room.occupied.by = sound", "hall.room.occupied = yes"});
  CHECK(lines_of(aut.on_output(1, bytes{1, 0, 0}, start + 20s), "occupied").empty());
  CHECK(aut.deadline() == start + 50s);
  CHECK(lines_of(aut.on_time(start + 49s), "occupied").empty());
  CHECK(lines_of(aut.on_time(start + 50s), "occupied") ==
        lines{"hall.room.occupied.by = none", "hall.room.occupied = no"});
  CHECK(!aut.deadline());
  CHECK(lines_of(aut.on_output(1, bytes{1, 61, 0}, start + 60s), "occupied") ==
        lines{"hall.room.occupied.by = motion", "hall.room.occupied = yes"});
}

TEST_CASE("occupancy refuses settings that mean nothing", "[proxy][GEN-06]") {
  struct row {
    proxy::program_settings settings;
    const char* setting;
    const char* message;
  };
  const std::vector<row> rows{
      {{}, "", "needs a setting with the name of a field"},
      {{{"hold_s", 30}}, "", "needs a setting with the name of a field"},
      {{{"motion", 0}, {"hold_s", 0}}, "hold_s", "must be more than 0 and at most 86400"},
      {{{"motion", 0}, {"hold_s", 86401}}, "hold_s", "must be more than 0 and at most 86400"},
      {{{"light", 0}}, "light", "is neither \"hold_s\" nor a field of the proxy"},
      {{{"door", 0}}, "door", "is a field with words, which cannot be compared with a number"},
  };
  for (const auto& r : rows) {
    CAPTURE(r.message);
    const auto made = make_occupancy(room(), r.settings);
    const auto* wrong = std::get_if<program_problem>(&made);
    REQUIRE(wrong != nullptr);
    CHECK(wrong->setting == r.setting);
    CHECK(wrong->message == r.message);
  }
}

TEST_CASE("a registry knows each name once", "[proxy]") {
  auto programs = proxy::built_in_programs();
  CHECK(programs.names() == std::vector<std::string>{"occupancy"});
  CHECK(programs.find("rise") == nullptr);
  const auto make =
      [](const proxy_class&,
         const proxy::program_settings&) -> std::variant<program_factory, program_problem> {
    return program_factory([] { return std::make_unique<rise>(); });
  };
  CHECK(programs.add("rise", make));
  CHECK(!programs.add("rise", make_occupancy));
  CHECK(programs.names() == std::vector<std::string>{"occupancy", "rise"});
  REQUIRE(programs.find("rise") != nullptr);
  CHECK(std::holds_alternative<program_factory>((*programs.find("rise"))(room(), {})));
}

TEST_CASE("a program of one's own speaks below its proxy's prefix", "[proxy][PXY-04]") {
  const program_factory make = [] { return std::make_unique<rise>(); };
  auto one = with_program(make);
  auto other = with_program(make);
  static_cast<void>(one.start(start));
  static_cast<void>(other.start(start));
  CHECK(lines_of(one.on_output(1, bytes{0, 10, 0}, start), "rise") ==
        lines{"hall.room.rise.unit = dB", "hall.room.rise = 10"});
  CHECK(lines_of(one.on_output(1, bytes{0, 12, 0}, start), "rise") == lines{"hall.room.rise = 2"});
  // Each proxy has a program of its own.
  CHECK(lines_of(other.on_output(1, bytes{0, 12, 0}, start), "rise").back() ==
        "hall.room.rise = 12");
  CHECK(one.counters().foreign_names == 2);
  const auto values = one.values();
  CHECK(std::ranges::count(values, std::pair<std::string, std::string>("rise", "2 dB")) == 1);
}
