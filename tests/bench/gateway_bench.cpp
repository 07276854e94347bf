// From motes to tuples and back: readings of one island at a remote subscriber, and the round trip
// of an actuation. Whole ecologies in virtual time, from the programs' actors down to medium and
// cable.
//
// The readings of the last minute of a run are those of the run less those of the same run without
// its last minute: equal seeds begin equally.
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include "actors/run/run.hpp"
#include "calibration.hpp"
#include "config/load.hpp"
#include "figures.hpp"

namespace {

using namespace rubicon;
using bench::at_least;
using bench::at_most;

constexpr duration settled_after = 1min;
constexpr duration measured = 1min;

config::ecology_description load(const std::string& toml) {
  auto loaded = config::load_text(toml, "gateway.toml", {}, {});
  if (!loaded.ecology)
    throw std::logic_error("the bench's own ecology is refused");
  return *std::move(loaded.ecology);
}

/// Eight motes around a sink, their gateway, and a robot that reads them over another computer.
/// Each mote sends eight counts every 50 ms.
config::ecology_description reading(unsigned baud) {
  std::ostringstream toml;
  toml << R"([ecology]
name = 'reading'
[radio]
range = '15m'
[[island]]
id = 1
name = 'room'
gateway.links = ['inproc://pc']
sink.position_m = [0, 0]
serial.baud = )"
       << baud << "\n[[island.group]]\ncount = 8\nlayout = 'ring'\nradius = '5m'\ntype = 1\n";
  std::string quantities;
  for (const std::string each : {"light", "temperature", "humidity", "voltage", "presence",
                                 "magnetism", "sound", "acceleration"}) {
    toml << "transducers." << each << " = { model = 'constant', value = 20 }\n";
    quantities += "'" + each + "', ";
  }
  toml << "apps = [{ app = 'sampler', every = '50ms', jitter = '50ms', transducers = ["
       << quantities << R"(] }]
[[peer]]
id = 11
name = 'pc'
[[peer]]
id = 30
name = 'robot'
links = ['inproc://pc']
apps = [{ app = 'collector', keys = ['devices.*.output.1'] }]
)";
  return load(toml.str());
}

struct counts {
  double readings = 0;  ///< at the subscriber
  double octets_up = 0; ///< arrived over the cable
  double cpu_s = 0;

  counts operator-(const counts& x) const {
    return {readings - x.readings, octets_up - x.octets_up, cpu_s - x.cpu_s};
  }
};

counts count(config::ecology_description what, duration length) {
  what.length = length;
  const auto started = bench::cpu_s();
  const auto report = run_ecology(what, {});
  counts x;
  x.cpu_s = bench::cpu_s() - started;
  x.readings = report.programs.at(0).figures.at(0).second;
  x.octets_up = static_cast<double>(report.islands.at(0).serial.octets_up);
  return x;
}

counts in_last_minute(const config::ecology_description& what) {
  return count(what, settled_after + measured) - count(what, settled_after);
}

void readings(bench::figures& out) {
  constexpr unsigned baud = 57'600;
  constexpr double line_octets_s = baud / 10.0;
  out.section("readings, 57 600 baud", "8 motes that have more to say than the cable carries");
  const auto limited = in_last_minute(reading(baud));
  const auto length = seconds(measured);
  out.add("readings at the subscriber", limited.readings / length, 1, "1/s");
  out.add("octets of the cable a reading", limited.octets_up / limited.readings, 1, "");
  out.add("cable in use, towards the PC", 100 * limited.octets_up / length / line_octets_s, 1, "%",
          at_least(95));

  out.section("readings, a cable that does not count", "the same motes");
  const auto free = in_last_minute(reading(3'000'000));
  out.add("readings at the subscriber", free.readings / length, 1, "1/s");
  out.add("the same, processor time", free.readings / free.cpu_s, 0, "1/s");
  out.add("the same in calibration steps", bench::calibrate() * 1e3 * free.cpu_s / free.readings, 0,
          "k steps");
}

/// A robot reads a light that swings to and fro and switches a relay with it, over two other
/// computers.
/// @param hops between the relay's mote and its sink
config::ecology_description switching(unsigned hops, const std::string& loss) {
  std::ostringstream toml;
  toml << R"([ecology]
name = 'switching'
duration = '2010s'
[radio]
range = '12m'
loss = ')"
       << loss << R"('
[[island]]
id = 1
name = 'hall'
gateway.links = ['inproc://pc']
sink.position_m = [0, 0]
[[island.mote]]
id = 2
name = 'light'
type = 10
position_m = [5, 0]
transducers.light = { model = 'sine', mean = 100, amplitude = 100, period = '4s' }
apps = [{ app = 'sampler', transducers = ['light'], every = '500ms' }]
)";
  for (unsigned i = 1; i <= hops; ++i)
    toml << "[[island.mote]]\nid = " << 2 + i << "\nname = 'mote-" << i
         << "'\ntype = " << (i == hops ? 20 : 1) << "\nposition_m = [" << 10 * i << ", 0]\n"
         << (i == hops ? "actuators = [{ name = 'switch', kind = 'relay' }]\n"
                         "apps = [{ app = 'actuator', actuator = 'switch' }]\n"
                       : "");
  toml << R"([[peer]]
id = 11
name = 'pc'
links = ['inproc://robot']
apps = [{ app = 'proxy_manager' }]
[[peer]]
id = 30
name = 'robot'
[[peer.apps]]
app = 'rules'
retry = '0s'
rules = [{ when = 'hall.light.light', above = 12, below = 8, write = 'hall.relay.switch', then = 'on', otherwise = 'off' }]
[[proxy]]
name = 'light'
types = [10]
field = [{ name = 'light', channel = 1, scale = 0.1 }]
[[proxy]]
name = 'relay'
types = [20]
prefix = 'hall.relay'
field = [{ name = 'state', channel = 2, encoding = 'u8', words = { 0 = 'off', 1 = 'on' } }]
input = [{ name = 'switch', channel = 2, words = { on = '01', off = '00' } }]
)";
  return load(toml.str());
}

void actuations(bench::figures& out, unsigned hops, const std::string& loss) {
  out.section("actuations, " + std::to_string(hops) + (hops == 1 ? " hop, " : " hops, ") + loss +
                  " loss",
              "from the robot's word to the acknowledgement at its proxy, simulated time");
  const auto report = run_ecology(switching(hops, loss), {});
  report::actuation_report all;
  for (const auto& x : report.proxies)
    all += x.actuations;
  const auto asked = static_cast<double>(all.requested);
  out.add("asked for", asked, 0, "", at_least(900));
  out.add("acknowledged", 100 * static_cast<double>(all.acknowledged) / asked, 1, "%",
          at_least(99));
  out.add("round trip, median", all.latency.quantile_ms(0.5), 1, "ms");
  out.add("round trip, 99 %", all.latency.quantile_ms(0.99), 1, "ms");
  out.add("round trip, slowest", 1e3 * seconds(all.slowest), 1, "ms", at_most(40'000));
}

} // namespace

int main(int argc, char** argv) {
  const bool json = argc == 2 && std::string(argv[1]) == "--json";
  if (argc > 1 && !json) {
    std::fprintf(stderr, "usage: bench_gateway [--json]\n");
    return 2;
  }
  spdlog::set_level(spdlog::level::err);
  bench::figures out;
  readings(out);
  for (const unsigned hops : {1U, 3U}) {
    actuations(out, hops, "0%");
    actuations(out, hops, "20%");
  }
  if (json)
    out.print_json();
  return out.failures() == 0 ? 0 : 1;
}
