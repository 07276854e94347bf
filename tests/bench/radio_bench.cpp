// What the radio channel costs: events a second and nanoseconds a frame delivered, for an island of
// 54 motes that hear each other and for 1000 and 10 000 radios spread over a field. A calibration
// loop in the same run makes the numbers of different machines comparable: the ratio is events per
// thousand calibration steps.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <variant>
#include <vector>

#include "core/hash.hpp"
#include "radio/channel.hpp"

namespace {

using namespace rubicon;
using namespace rubicon::radio;

struct field {
  const char* name;
  std::uint32_t radios;
  double side_m;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return seconds(std::chrono::steady_clock::now() - start);
}

/// Million steps of integer work a second.
double calibrate() {
  constexpr std::uint64_t steps = 100'000'000;
  const auto start = std::chrono::steady_clock::now();
  fold64 fold;
  for (std::uint64_t i = 0; i < steps; ++i)
    fold.add(i);
  const auto rate = static_cast<double>(steps) / 1e6 / seconds_since(start);
  return fold.value() == 0 ? 0 : rate; // uses the result, so that the loop stays
}

/// Radio 0 of every group of 54 is its sink; all others report to it.
constexpr std::uint32_t group = 54;

channel make_channel(const field& x) {
  channel made({}, random_stream(1));
  random_stream places(2);
  position centre;
  for (std::uint32_t i = 0; i < x.radios; ++i) {
    if (i % group == 0)
      centre = {places.unit() * x.side_m, places.unit() * x.side_m, 0};
    radio_config config;
    config.address = mote_id{static_cast<std::uint16_t>(1 + i % group)};
    config.pan = static_cast<std::uint16_t>(1 + i / group);
    config.place = {centre.x_m + places.unit() * 20, centre.y_m + places.unit() * 20, 0};
    config.kind = &platforms()[0];
    made.add(config, instant{});
  }
  return made;
}

/// Every mote sends an acked 20-octet report each 31 s (54 motes: 150 000 a day).
void measure(const field& x, std::uint64_t reports, double calibration) {
  auto start = std::chrono::steady_clock::now();
  auto air = make_channel(x);
  const auto built_s = seconds_since(start);
  random_stream dice(3);
  std::uint64_t received = 0;
  const auto count = [&](const outputs& all) {
    for (const auto& y : all)
      received += std::holds_alternative<delivered>(y) ? 1 : 0;
  };
  const auto gap = duration(31s) / x.radios;
  instant now;
  start = std::chrono::steady_clock::now();
  for (std::uint64_t i = 0; i < reports; ++i) {
    now += dice.between(0ns, 2 * gap);
    for (auto due = air.deadline(); due && *due <= now; due = air.deadline())
      count(air.on_time(*due));
    auto from = static_cast<std::uint32_t>(dice.below(x.radios));
    if (from % group == 0)
      ++from; // the sink only listens
    count(air.send(radio_index{from}, {i, mote_id{1}, 18, bytes(20), true}, now));
  }
  const auto run_s = seconds_since(start);
  const auto events = static_cast<double>(air.events());
  const auto copies = air.counted().copies;
  std::printf("%-26s %6.2f s  %9.0f events/s  ratio %6.3f  %5.0f ns/copy  %6.0f ns/delivered  "
              "%5.1f neighbours  built in %.2f s  %s\n",
              x.name, run_s, events / run_s, events / run_s / (calibration * 1e3),
              1e9 * run_s / static_cast<double>(copies.sent),
              1e9 * run_s / static_cast<double>(received),
              static_cast<double>(copies.sent) / static_cast<double>(air.counted().transmissions),
              built_s, air.balanced() ? "balanced" : "NOT BALANCED");
}

} // namespace

int main(int argc, char** argv) {
  const auto reports = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 150'000;
  const auto calibration = calibrate();
  std::printf("calibration %.1f million steps/s\n", calibration);
  for (const auto& x : {field{"54 in one room", 54, 0}, field{"1000 in one room", 1000, 0},
                        field{"1000 in a field", 1000, 230}, field{"10000 in a field", 10000, 730}})
    measure(x, reports, calibration);
}
