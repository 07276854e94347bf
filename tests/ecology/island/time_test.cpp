// Islands and peers share one time: what two islands say of one event can be compared.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr int motes = 5;

/// Two islands whose motes look at the same thing ten times a second, which keeps radio and serial
/// line busy: it rises by one count a millisecond, from -15000 to 15000 in the last 25 s of the run
/// and 5 s more. The PCs' clocks are apart until they have met.
/// @param serial of the second island
config::ecology_description two_islands(int seconds, std::string_view serial = "") {
  std::ostringstream toml;
  toml << "[ecology]\nname = 'time'\nduration = '" << seconds << "s'\n"
       << "[radio]\nrange = '100m'\n"
       << "[mote_type.watcher]\ntype = 901\nplatform = 'micaz'\n"
       << "transducers.temperature = { model = 'points', resolution = 0.001, points = [['"
       << seconds - 25 << "s', -15], ['" << seconds + 5 << "s', 15]] }\n"
       << "apps = [{ app = 'sampler', transducers = ['temperature'], every = '100ms',"
       << " jitter = '20ms', stamped = true }]\n";
  for (int island = 1; island <= 2; ++island) {
    toml << "[[island]]\nname = '" << (island == 1 ? "east" : "west") << "'\nid = " << island
         << "\ncrystal_ppm = 50\nsink = { position_m = [0, " << 1000 * island
         << "], platform = 'micaz' }\n"
         << "gateway = { links = ['inproc://pc'] }\n";
    if (island == 2)
      toml << serial;
    for (int i = 0; i < motes; ++i)
      toml << "[[island.mote]]\nid = " << 2 + i << "\nname = 'm-" << 2 + i
           << "'\ntype = 'watcher'\nposition_m = [" << 2 + i << ", " << 1000 * island << "]\n";
  }
  toml << "[[peer]]\nid = 11\nname = 'pc'\napps = [{ app = 'proxy_manager' }]\n"
       << "[[proxy]]\nname = 'watcher'\ntypes = [901]\n"
       << "[[proxy.field]]\nname = 'value'\nchannel = 1\ndecimals = 0\n"
       << "[[proxy.field]]\nname = 'stamp'\nchannel = 1\noffset = 2\nencoding = 'stamp'\n"
       << "decimals = 0\n"
       << "[[fault]]\nat = '500ms'\nkind = 'clock_step'\npeer = 'east-gateway'\nby = '5s'\n"
       << "[[fault]]\nat = '500ms'\nkind = 'clock_step'\npeer = 'pc'\nby = '-5s'\n";
  return describe(toml.str());
}

/// What the motes of an island say last, with their stamps.
struct sightings {
  double stamp_min = 1e13;
  double stamp_max = 0;
  double event_min = 1e13; ///< when the value was 0, as their stamps say, in milliseconds
  double event_max = 0;
};

sightings sightings_of(const report::run_report& x, const std::string& island) {
  sightings all;
  for (int i = 0; i < motes; ++i) {
    const auto& proxy = proxy_of(x, island + ".m-" + std::to_string(2 + i));
    const auto stamp = std::stod(value(proxy, "stamp"));
    const auto event = stamp - std::stod(value(proxy, "value"));
    all.stamp_min = std::min(all.stamp_min, stamp);
    all.stamp_max = std::max(all.stamp_max, stamp);
    all.event_min = std::min(all.event_min, event);
    all.event_max = std::max(all.event_max, event);
  }
  return all;
}

/// Both islands agree on when the value was 0, and with what the peers' time was then.
void check_agreement(const report::run_report& report, int seconds) {
  CHECK(report.violations.empty());
  for (const auto& island : report.islands) {
    CAPTURE(island.name);
    CHECK(island.network.aligned == motes);
    CHECK(island.network.time_error_max < 2500us);
    CHECK(island.network.clock_error_max < 1ms);
  }
  const auto east = sightings_of(report, "east");
  const auto west = sightings_of(report, "west");
  CHECK(std::max(east.event_max, west.event_max) - std::min(east.event_min, west.event_min) < 5);
  const auto truth = 1e12 + 5000 + 1000.0 * (seconds - 10);
  CHECK(std::abs(east.event_min - truth) < 5);
}

} // namespace

TEST_CASE("one event has the same time in two islands", "[ecology][CLK-08][CLK-06][IF-06]") {
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    const auto seconds = static_cast<int>(60 + 13 * seed);
    check_agreement(run(two_islands(seconds), seed), seconds);
  }
}

TEST_CASE("motes know the time of every year that a file may name", "[ecology][CLK-08][IF-06]") {
  const auto day_of = [](std::chrono::year_month_day x) {
    return std::chrono::sys_days(x).time_since_epoch();
  };
  using namespace std::chrono_literals;
  for (const auto day : {1970y / 1 / 1, 2038y / 1 / 19, 2069y / 12 / 31, 2070y / 1 / 2,
                         2106y / 2 / 7, 2113y / 1 / 1, 2149y / 12 / 30}) {
    CAPTURE(static_cast<int>(day.year()));
    auto islands = two_islands(60);
    islands.faults.clear();
    islands.date = day_of(day);
    islands.day_begins = 24h - 30s; // so that the day ends while it runs
    const auto report = run(islands);
    const auto truth = static_cast<double>((*islands.date + islands.day_begins + 50s) / 1ms);
    for (const auto& island : report.islands) {
      CHECK(island.network.aligned == motes);
      CHECK(std::abs(sightings_of(report, island.name).event_min - truth) < 5);
    }
  }
}

TEST_CASE("it has so again after a gateway has started again and a cable was out",
          "[ecology][CLK-08][GW-15]") {
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto seconds = static_cast<int>(130 + 7 * seed);
    auto islands = two_islands(seconds);
    islands.faults.push_back({40s, config::kill_fault{peer_id{1}, 20s}});
    islands.faults.push_back({50s, config::unplug_fault{island_id{2}, 30s}});
    check_agreement(run(islands, seed), seconds);
  }
}

TEST_CASE("a datum that was delayed is recognisably older", "[ecology][IF-06][CLK-08]") {
  const auto seconds = 90;
  const auto report = run(two_islands(seconds, "serial = { latency = '400ms' }\n"));
  check_agreement(report, seconds);
  const auto east = sightings_of(report, "east");
  const auto west = sightings_of(report, "west");
  CHECK(west.stamp_max < east.stamp_min - 200);
  CHECK(west.stamp_max > east.stamp_min - 1000);
}

TEST_CASE("a line that readings fill hides neither the time nor a mote",
          "[ecology][CLK-08][GW-01]") {
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    // 50 readings a second, of which the line takes some 20.
    const auto report = run(two_islands(200, "serial = { baud = 9600 }\n"), seed);
    CHECK(report.violations.empty());
    const auto& west = report.islands.at(1);
    CHECK(west.serial.lost.at("sink_queue_full") > 2000);
    CHECK(west.network.aligned == motes);
    CHECK(west.network.time_error_max < 1500us); // an octet of the line is 1 ms
    CHECK(west.network.counters.at("time.good") * 10 > west.network.counters.at("time.asked") * 8);
    for (const auto& mote : west.motes)
      CHECK(mote.left_cause.empty());
    for (const auto& each : report.event_log)
      CHECK(each.what.find("left") == std::string::npos);
  }
}

TEST_CASE("an island that no gateway tells the time has its own", "[ecology][CLK-08][CLK-01]") {
  auto islands = two_islands(60);
  islands.faults.insert(islands.faults.begin(),
                        {10ms, config::kill_fault{peer_id{1}, std::nullopt}});
  const auto report = run(islands);
  for (const auto& x : report.violations) // who was never listed is told as missing
    CHECK(x.invariant == "every mote is joined");
  const auto& east = report.islands.at(0).network;
  CHECK(east.synchronised == motes);
  CHECK(east.clock_error_max < 1ms);
  CHECK(east.aligned == 0);
  CHECK(report.islands.at(1).network.aligned == motes);
}
