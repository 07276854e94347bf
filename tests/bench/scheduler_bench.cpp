// How many timed messages a second one core carries under virtual time: actors send each other
// delayed messages with a shared payload, without and with trace. A calibration loop in the same
// run makes the numbers of different machines comparable: the ratio is messages per thousand
// calibration steps.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/hash.hpp"
#include "core/numbers/random.hpp"
#include "scheduler/messages/define_messages.hpp"
#include "scheduler/world.hpp"

namespace bench {

using namespace rubicon;

/// A frame on its way: what a mote sends with every sample, by size.
struct parcel {
  std::uint32_t hops = 0;
  std::uint16_t from = 0;
  payload octets;
};

RUBICON_FIELDS(parcel, hops, from, octets);

struct station_interface : scheduler::takes<parcel> {};
using station_actor = scheduler::ref<station_interface>;

} // namespace bench

template void rubicon::scheduler::define_messages<bench::station_interface>();

namespace bench {

struct station_state {
  random_stream rng;
  std::uint16_t index = 0;
  const std::vector<station_actor>* all = nullptr;
};

using station_pointer = scheduler::actor_pointer<station_state, station_actor>;

/// Passes every parcel on to another station, 1 to 10 ms later.
station_actor::behavior_type station(station_pointer self, std::uint16_t index,
                                     const std::vector<station_actor>* all) {
  self->state.rng = random_stream(index);
  self->state.index = index;
  self->state.all = all;
  return {[self](const parcel& x) {
    auto& [rng, from, others] = self->state;
    const auto dice_word = rng.next();
    const auto& next = (*others)[dice_word % others->size()];
    const duration delay = 1ms + duration((dice_word >> 32) % 9'000'000);
    self->delayed_send(next, delay, parcel{x.hops + 1, from, x.octets});
  }};
}

struct outcome {
  double rate = 0; ///< timed messages a second of processor time
  std::uint64_t hash = 0;
};

outcome measure(std::size_t stations, std::size_t parcels, std::uint64_t messages, bool trace) {
  scheduler::world world({.trace = trace});
  std::vector<station_actor> all(stations);
  for (std::size_t i = 0; i < stations; ++i)
    all[i] =
        world.spawn("station/" + std::to_string(i), station, static_cast<std::uint16_t>(i), &all);
  const payload octets{bytes(40, 0x5a)};
  for (std::size_t i = 0; i < parcels; ++i)
    post(all[i % stations], parcel{0, 0, octets});
  world.run_for(20ms); // every station has had its turn
  const auto before = world.stats().timeouts;
  const auto start = cpu_s();
  while (world.stats().timeouts < before + messages)
    world.run_for(10ms);
  const auto rate = static_cast<double>(world.stats().timeouts - before) / (cpu_s() - start);
  all.clear();
  return {rate, world.trace().hash()};
}

void report(const char* what, const outcome& x, double calibration) {
  std::printf("%-34s %8.0f messages/s  ratio %6.3f  trace %s\n", what, x.rate,
              x.rate / (calibration * 1e3), to_hex(x.hash).c_str());
}

} // namespace bench

int main(int argc, char** argv) {
  const auto messages = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 2'000'000;
  const auto calibration = bench::calibrate();
  std::printf("calibration %.1f million steps/s\n", calibration);
  for (const bool trace : {false, true}) {
    const auto* name = trace ? "with trace" : "without trace";
    for (const auto& [stations, parcels] : {std::pair{100, 100}, {1000, 1000}, {10000, 10000}}) {
      const auto what = std::to_string(stations) + " actors, " + name;
      bench::report(what.c_str(),
                    bench::measure(static_cast<std::size_t>(stations),
                                   static_cast<std::size_t>(parcels), messages, trace),
                    calibration);
    }
  }
}
