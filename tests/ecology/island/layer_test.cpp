// The Communication Layer's examples: streams over several hops, and a learning network.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

double figure(const report::run_report& x, std::string_view who, std::string_view name) {
  for (const auto& program : x.programs) {
    if (program.who != who)
      continue;
    for (const auto& [each, value] : program.figures) {
      if (each == name)
        return value;
    }
  }
  FAIL("no such figure");
  return 0;
}

double duty_of(const report::mote_report& x) {
  return 1 - seconds(x.energy.radio_off) / seconds(x.energy.elapsed);
}

/// All programs of motes, which are in their mote's actor, come into actors of their own.
config::ecology_description separated(config::ecology_description x) {
  for (auto& island : x.islands) {
    for (auto& mote : island.motes) {
      for (auto& app : mote.apps.edit()) {
        if (auto* program = std::get_if<apps::app_config>(&app))
          app = config::separate_app{apps::app_config(*program)};
      }
    }
  }
  return x;
}

/// What programs have counted, for comparison.
std::string figures_of(const report::run_report& x) {
  std::ostringstream text;
  for (const auto& program : x.programs) {
    text << program.who << ' ' << program.kind;
    for (const auto& [name, value] : program.figures)
      text << ", " << name << ' ' << value;
    text << '\n';
  }
  return text.str();
}

/// Motes 2 to count + 1 of one island in a ring of synaptic channels, in rows of ten, 1 m apart.
/// @param radio lines of [radio]
config::ecology_description ring(int count, int size, std::string_view radio = "range = '100m'\n") {
  std::ostringstream toml;
  toml << "[ecology]\nname = 'ring'\n"
       << "[mote_type.unit]\ntype = 1\n"
       << "[radio]\n"
       << radio << "[[island]]\nname = 'hall'\nid = 1\nkeep_alive = '3min'\n"
       << "sink.position_m = [0, 0]\n";
  for (int i = 0; i < count; ++i) {
    const auto end = [&](int other) {
      std::ostringstream x;
      x << "[{ node = 'hall/n-" << 2 + other % count << "', size = " << size << " }]";
      return x.str();
    };
    toml << "[[island.mote]]\nid = " << 2 + i << "\nname = 'n-" << 2 + i << "'\ntype = 'unit'\n"
         << "position_m = [" << 1 + i % 10 << ", " << 1 + i / 10 << "]\n"
         << "apps = [{ app = 'reservoir', units = " << size << ", from = " << end(i + count - 1)
         << ", to = " << end(i + 1) << " }]\n";
  }
  return describe(toml.str());
}

struct vectors {
  double updated = 0;
  double missed = 0;
};

vectors vectors_of(const report::run_report& x) {
  vectors sum;
  for (const auto& program : x.programs) {
    sum.updated += figure(x, program.who, "vectors updated");
    sum.missed += figure(x, program.who, "vectors missed");
  }
  return sum;
}

} // namespace

TEST_CASE("a stream over five hops arrives, while the radios of its relays sleep",
          "[ecology][NRG-02][NRG-03][STR-18]") {
  auto lines = example("stream-line.toml");
  lines.length = 20min;
  const auto report = run(lines);
  CHECK(report.violations.empty());
  CHECK(report.motes_joined() == 12);
  for (const auto* reader : {"sleepy/reader", "awake/reader"}) {
    CHECK(figure(report, reader, "records") > 1000);
    CHECK(figure(report, reader, "delivery %") >= 99);
  }
  for (const auto& island : report.islands) {
    CHECK(island.network.clock_error_max < 1ms);
    for (const auto& mote : island.motes) {
      CAPTURE(island.name, mote.name);
      if (island.name == "awake")
        CHECK(duty_of(mote) == 1);
      else // all stay on for the first minute, a twentieth of the run
        CHECK(duty_of(mote) < 0.05 + 0.95 * 0.05);
    }
  }
}

TEST_CASE("a learning network over two islands and a PC says what comes next",
          "[ecology][SYN-06][SYN-10][SYN-16][PAR-01][IF-01]") {
  const auto seed = GENERATE(range(std::uint64_t{1}, seeds(3) + 1));
  CAPTURE(seed);
  auto network = example("learning.toml");
  network.length = 520s; // 1000 ticks and the time to set up
  const auto report = run(network, seed);
  CHECK(report.violations.empty());
  CHECK(report.motes_joined() == 16);
  REQUIRE(report.programs.size() == 17);
  for (const auto& program : report.programs) {
    CAPTURE(program.who);
    CHECK(figure(report, program.who, "ticks") >= 1000);
    CHECK(figure(report, program.who, "vectors updated") >= 990);
    CHECK(figure(report, program.who, "vectors missed") == 0);
  }
  CHECK(figure(report, "learner", "prediction error") <
        0.6 * figure(report, "learner", "error of the last value"));
}

TEST_CASE("100 motes in one place send ten values each at every tick, none in vain",
          "[ecology][SYN-16]") {
  const unsigned motes = seeds(3) == 1 ? 40U : GENERATE(40U, 80U, 100U);
  CAPTURE(motes);
  auto network = ring(static_cast<int>(motes), 10);
  const auto after = [&](duration length) {
    network.length = length;
    const auto report = run(network);
    CHECK(report.violations.empty());
    CHECK(report.motes_joined() == motes);
    return vectors_of(report);
  };
  const auto first = after(3min); // all channels are open by then
  const auto all = after(4min);
  CHECK(all.updated - first.updated == Approx(motes * 2 * 60).epsilon(0.01));
  CHECK(all.missed - first.missed == 0);
}

TEST_CASE("vectors over several hops arrive within their tick, hardly ever in vain",
          "[ecology][SYN-10][SYN-16]") {
  auto network = ring(40, 5, "range = '3m'\n");
  network.length = 4min;
  const auto report = run(network);
  CHECK(report.motes_joined() == 40);
  const auto all = vectors_of(report);
  CHECK(all.updated > 40 * 2 * 60 * 3);
  CHECK(all.missed < 0.002 * all.updated);
}

TEST_CASE("the rate of missed vectors is that of the loss injected", "[ecology][SYN-10]") {
  constexpr double loss = 0.4;
  constexpr int attempts = 3; // one in its slot and two more; the radio makes one of each
  std::ostringstream radio;
  radio << "range = '100m'\nretries = 0\n";
  for (int i = 0; i < 16; ++i) // the route back stays whole: nothing that has arrived is sent again
    radio << "[[radio.link]]\nfrom = 'hall/n-" << 2 + i << "'\nto = 'hall/n-" << 2 + (i + 1) % 16
          << "'\nloss = " << loss << "\n";
  auto network = ring(16, 3, radio.str());
  network.length = 20min;
  const auto report = run(network);
  const auto all = vectors_of(report);
  const auto total = all.updated + all.missed;
  CHECK(total > 16 * 2 * 60 * 15);
  // A channel that breaks, which takes four losses in a row, misses what is sent until it is open
  // again, and then may be one round the lossy link.
  const auto of_link = std::pow(loss, attempts);
  CHECK(all.missed / total < 1.25 * of_link);
  CHECK(all.missed / total > 0.6 * of_link);
}

TEST_CASE("operators over streams switch a lamp, and each run writes down the same",
          "[ecology][STR-22][PAR-02]") {
  auto room = example("operators.toml");
  auto& recorder = std::get<apps::recorder_config>(room.islands.at(0).gateway_apps.at(0));
  recorder.file = "operators-test.csv";
  const auto records_of = [&] {
    const auto report = run(room);
    CHECK(report.violations.empty());
    CHECK(report.motes_joined() == 5);
    CHECK(figure(report, "room/middle", "records written") > 800);
    CHECK(figure(report, "room/ceiling", "changes") >= 4); // two in each period of the light
    CHECK(figure(report, "room/ceiling", "commands failed") == 0);
    CHECK(figure(report, "room-gateway", "records dropped") == 0);
    CHECK(figure(report, "room-gateway", "lines not written") == 0);
    std::ostringstream text;
    text << std::ifstream(recorder.file).rdbuf();
    return text.str();
  };
  const auto first = records_of();
  CHECK(first.starts_with("time_s,island,mote,stream,value\n"));
  CHECK(std::ranges::count(first, '\n') > 400);
  CHECK(first.find(",1,5,9,") != std::string::npos);
  CHECK(records_of() == first);
}

TEST_CASE("programs in actors of their own read, write and switch as those in their motes do",
          "[ecology][PAR-05][STR-22]") {
  auto room = example("operators.toml");
  auto& recorder = std::get<apps::recorder_config>(room.islands.at(0).gateway_apps.at(0));
  recorder.file = "operators-place-test.csv";
  const auto records_of = [&](const config::ecology_description& x, std::string& figures) {
    const auto report = run(x);
    CHECK(report.violations.empty());
    CHECK(report.motes_joined() == 5);
    figures = figures_of(report);
    std::ostringstream text;
    text << std::ifstream(recorder.file).rdbuf();
    return text.str();
  };
  std::string in_motes;
  std::string beside;
  const auto first = records_of(room, in_motes);
  const auto second = records_of(separated(room), beside);
  CHECK(std::ranges::count(first, '\n') > 400);
  CHECK(first == second);
  CHECK(in_motes == beside);
}

TEST_CASE("a learning network learns the same with its parts in actors of their own",
          "[ecology][PAR-05][SYN-06][SYN-10]") {
  auto network = example("learning.toml");
  network.length = 150s;
  const auto in_motes = figures_of(run(network));
  const auto beside = figures_of(run(separated(network)));
  CHECK(in_motes.find("vectors updated") != std::string::npos);
  CHECK(in_motes == beside);
}

TEST_CASE("a program in an actor of its own begins again with its mote",
          "[ecology][PAR-05][ACT-03]") {
  auto room = separated(example("operators.toml"));
  std::get<apps::recorder_config>(room.islands.at(0).gateway_apps.at(0)).file =
      "operators-crash-test.csv";
  const mote_address middle{island_id{1}, mote_id{5}}; // who makes the average
  room.faults = {{4min, config::crash_fault{middle}}};
  const auto report = run(room);
  CHECK(report.violations.empty());
  CHECK(has_logged(report, "room/middle", "joined again"));
  const auto written = figure(report, "room/middle", "records written");
  CHECK(written > 800); // of both its lives
  CHECK(written < 1200);
}
