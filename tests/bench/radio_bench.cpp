// What the air costs: whole ecologies of motes that only measure, from the program's actors down to
// the medium. Every mote sends 20 octets of MAC payload each second to its sink, acknowledged, at a
// random phase; there is no gateway and no PEIS peer.
//
// Layout `islands`: islands of 100 motes within 10 m around their sink, each with an air of its
// own. Layout `field`: one air, a sink for every 16 motes, about 19 neighbours for each radio.
//
// A calibration loop in the same run makes figures of different machines comparable.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <malloc.h>

#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/run/run.hpp"
#include "calibration.hpp"
#include "core/numbers/math.hpp"
#include "core/numbers/random.hpp"
#include "scheduler/world.hpp"

namespace {

using namespace rubicon;
using bench::cpu_s;
using bench::wall_s;

double allocated() {
  return static_cast<double>(mallinfo2().uordblks);
}

/// Uniform in a disk around `centre`.
position near(const position& centre, double radius_m, random_stream& rng) {
  const auto distance = radius_m * std::sqrt(rng.unit());
  const auto turns = rng.unit();
  return {centre.x_m + distance * math::sine_of_turns(turns + 0.25),
          centre.y_m + distance * math::sine_of_turns(turns), 0};
}

config::island_description island_of(std::uint32_t id, std::uint32_t motes, const position& centre,
                                     double radius_m, bool sending, random_stream& rng) {
  const auto* kind = radio::find_platform("micaz");
  config::island_description island;
  island.id = island_id{id};
  island.name = "island-" + std::to_string(id);
  island.stack = config::stack::mac;
  island.sink.platform = kind;
  island.sink.place = centre;
  island.sink.apps = {traffic::receiver_config{}};
  for (std::uint32_t i = 1; i <= motes; ++i) {
    config::mote_description mote;
    mote.id = mote_id{static_cast<std::uint16_t>(island.sink.id.value + i)};
    mote.name = "mote-" + std::to_string(i);
    mote.platform = kind;
    mote.place = near(centre, radius_m, rng);
    if (sending) {
      traffic::sender_config sender;
      sender.to = island.sink.id;
      mote.apps = {sender};
    }
    island.motes.push_back(std::move(mote));
  }
  return island;
}

config::ecology_description base(double cutoff_dbm) {
  config::ecology_description x;
  x.name = "bench";
  x.radio.propagation = radio::log_distance{.exponent = 3, .reference_db = 46.68};
  x.radio.noise = radio::constant_noise{.floor_dbm = -106.99};
  x.radio.collisions = radio::collision_rule::sinr;
  x.radio.cutoff_dbm = cutoff_dbm;
  return x;
}

config::ecology_description islands(std::uint32_t motes, bool sending) {
  auto x = base(-95);
  random_stream rng(7);
  for (std::uint32_t i = 0; i < motes / 100; ++i) {
    x.islands.push_back(island_of(i + 1, 100, {100.0 * i, 0, 0}, 10, sending, rng));
    x.airs.push_back({x.islands.back().name, {x.islands.back().id}});
  }
  return x;
}

config::ecology_description field(std::uint32_t motes, bool sending) {
  constexpr double cell_m = 60;
  constexpr double reach_m = 37.2; // pi reach^2 x 17 radios / cell^2 = 20.5
  auto x = base(-46.68 - 30 * std::log10(reach_m));
  random_stream rng(7);
  const auto count = motes / 16;
  const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(count)));
  x.airs.push_back({"field", {}});
  for (std::uint32_t i = 0; i < count; ++i) {
    const position centre{cell_m * (i % columns), cell_m * (i / columns), 0};
    x.islands.push_back(island_of(i + 1, 16, centre, cell_m / 2, sending, rng));
    x.airs[0].islands.push_back(x.islands.back().id);
  }
  return x;
}

struct figures {
  std::string layout;
  std::uint64_t motes = 0;
  double neighbours = 0;
  double simulated_s = 0;
  double cpu_s = 0; ///< of the simulated time alone
  double wall_s = 0;
  double setup_s = 0;
  unsigned threads = 1;
  double speed = 0;      ///< simulated seconds a real second
  double mac_events = 0; ///< requests, transmissions and copies ended, a second of processor time
  double messages = 0;   ///< between actors, a second of processor time
  double ratio = 0;      ///< messages a thousand steps of calibration
  double pdr = 0;
  double us_per_packet = 0;
  double idle_octets = 0; ///< of memory for each mote that does nothing
};

/// Runs `x` and calls back after its set-up and at its end.
/// @param at told whether it is the first call, and the ecology time
report::run_report run(config::ecology_description x, duration length, unsigned threads,
                       const std::function<void(bool first, instant reached)>& at) {
  x.length = length;
  run_options options;
  options.threads = threads;
  bool begun = false;
  options.progress = [&](const run_progress& p) {
    if (!begun || p.reached >= p.end)
      at(!begun, p.reached);
    begun = true;
  };
  return run_ecology(x, options);
}

struct empty_state {};

mote_actor::behavior_type empty_mote(scheduler::actor_pointer<empty_state, mote_actor>) {
  return {
      [](const frame_received&) {},
      [](const radio_done&) {},
      [](battery_low) {},
      [](battery_flat) {},
      [](const attach_program&) {},
      [](const program_commands&) {},
      [](const move_mote&) {},
      [](crash_now) {},
      [](end_battery) {},
      [](const change_program&) {},
      [](const set_network_keys&) {},
      [](const send_as_program&) {},
      [](const step_clock&) {},
      [](const backbone_received&) {},
      [](const backbone_sent&) {},
      [](const timer_expired&) {},
      [](status_request) {},
  };
}

/// Octets of memory of one of CAF's actors with a mote's interface and a path, doing nothing.
double octets_of_empty_actor() {
  constexpr int count = 1000;
  scheduler::world world;
  const auto before = allocated();
  std::vector<mote_actor> all;
  for (int i = 0; i < count; ++i)
    all.push_back(world.spawn("mote/island-1/mote-" + std::to_string(i), empty_mote));
  world.drain();
  return (allocated() - before) / count;
}

double octets_of_idle_mote(const config::ecology_description& x, std::uint64_t motes) {
  const auto before = allocated();
  double used = 0;
  run(x, 10ms, 1, [&](bool first, instant) {
    if (first)
      used = allocated() - before;
  });
  return used / static_cast<double>(motes);
}

figures measure(const std::string& layout, std::uint32_t motes, duration length, unsigned threads,
                double calibration) {
  const auto make = layout == "islands" ? islands : field;
  figures x;
  x.layout = layout;
  x.motes = motes;
  x.idle_octets = octets_of_idle_mote(make(motes, false), motes) - octets_of_empty_actor();
  const auto started = wall_s();
  double cpu_first = 0;
  double wall_first = 0;
  const auto report = run(make(motes, true), length, threads, [&](bool first, instant reached) {
    if (first) // the first step has the set-up
      x.simulated_s = seconds(length - reached.time_since_epoch());
    (first ? cpu_first : x.cpu_s) = cpu_s();
    (first ? wall_first : x.wall_s) = wall_s();
  });
  x.setup_s = wall_first - started;
  x.cpu_s -= cpu_first;
  x.wall_s -= wall_first;
  const auto radio = report.radio();
  std::uint64_t sent = 0;
  std::uint64_t delivered = 0;
  for (const auto& flow : report.flows) {
    sent += flow.sent;
    delivered += flow.delivered;
  }
  x.pdr = static_cast<double>(delivered) / static_cast<double>(sent);
  x.neighbours = static_cast<double>(radio.sent) / static_cast<double>(radio.transmissions);
  x.threads = threads;
  x.speed = x.simulated_s / x.wall_s;
  x.mac_events = static_cast<double>(radio.requests + radio.transmissions + radio.sent) / x.cpu_s;
  x.messages = static_cast<double>(report.events) / x.cpu_s;
  x.ratio = x.messages / (calibration * 1e3);
  x.us_per_packet = 1e6 * x.cpu_s / static_cast<double>(sent);
  if (!report.violations.empty())
    std::fprintf(stderr, "bench_radio: %s\n",
                 (report.violations[0].invariant + ": " + report.violations[0].detail).c_str());
  return x;
}

void print_table(const std::vector<figures>& all, double calibration) {
  std::printf("calibration %.1f million steps/s\n", calibration);
  std::printf("%-8s %6s %7s %6s  %10s %9s %9s %9s %8s %7s %6s %9s %9s\n", "layout", "motes",
              "threads", "neigh", "x realtime", "simulated", "cpu", "wall", "set-up", "us/pkt",
              "pdr", "events/s", "B/idle");
  for (const auto& x : all)
    std::printf(
        "%-8s %6llu %7u %6.1f  %10.1f %7.0f s %7.2f s %7.2f s %6.2f s %7.2f %6.3f %7.2f M %9.0f\n",
        x.layout.c_str(), static_cast<unsigned long long>(x.motes), x.threads, x.neighbours,
        x.speed, x.simulated_s, x.cpu_s, x.wall_s, x.setup_s, x.us_per_packet, x.pdr,
        x.mac_events / 1e6, x.idle_octets);
}

void print_json(const std::vector<figures>& all, double calibration) {
  std::printf("{\"calibration_msteps\": %.1f, \"radio\": [\n", calibration);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& x = all[i];
    std::printf("  {\"layout\": \"%s\", \"motes\": %llu, \"threads\": %u, \"neighbours\": %.1f, "
                "\"speed\": %.2f, "
                "\"simulated_s\": %.1f, \"cpu_s\": %.3f, \"wall_s\": %.3f, \"setup_s\": %.3f, "
                "\"us_per_packet\": %.3f, \"pdr\": %.4f, \"mac_events_per_s\": %.0f, "
                "\"messages_per_s\": %.0f, \"ratio\": %.3f, \"octets_per_idle_mote\": %.0f}%s\n",
                x.layout.c_str(), static_cast<unsigned long long>(x.motes), x.threads, x.neighbours,
                x.speed, x.simulated_s, x.cpu_s, x.wall_s, x.setup_s, x.us_per_packet, x.pdr,
                x.mac_events, x.messages, x.ratio, x.idle_octets, i + 1 < all.size() ? "," : "");
  }
  std::printf("]}\n");
}

} // namespace

int main(int argc, char** argv) {
  std::vector<std::uint32_t> sizes{100, 1000, 10'000};
  std::vector<std::string> layouts{"islands", "field"};
  std::vector<unsigned> threads{1};
  CLI::App command{"What the air costs"};
  command.add_option("--motes", sizes, "sizes")->check(CLI::Range(100, 100'000));
  command.add_option("--layout", layouts, "islands, field")
      ->check(CLI::IsMember({"islands", "field"}));
  command.add_option("--threads", threads, "numbers of threads")->check(CLI::Range(1, 256));
  CLI11_PARSE(command, argc, argv);
  const auto calibration = bench::calibrate();
  std::vector<figures> all;
  for (const auto& layout : layouts)
    for (const auto size : sizes)
      for (const auto each : threads)
        all.push_back(measure(layout, size, 1s * (200'000 / size), each, calibration));
  print_table(all, calibration);
  print_json(all, calibration);
}
