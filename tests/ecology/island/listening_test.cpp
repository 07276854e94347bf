// Islands whose radios listen at low power: what arrives, how late, and what it costs.
#include <cstdio>
#include <sstream>
#include <string>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// Three motes in a line, that measure once a minute.
std::string line(const std::string& interval, double loss) {
  std::ostringstream toml;
  toml << R"(
    ecology = { name = "low-power", duration = "1h" }
    mote_type.sensor = { type = 700, transducers.temperature = { model = "constant", value = 20 }, apps = [
      { app = "sampler", transducers = ["temperature"], every = "1min" }] }
    [[island]]
    id = 1
    name = "hall"
    low_power_listening = { interval = ")"
       << interval << R"(" }
    mote = [
      { id = 2, name = "near", type = "sensor", position_m = [19, 0] },
      { id = 3, name = "middle", type = "sensor", position_m = [38, 0] },
      { id = 4, name = "far", type = "sensor", position_m = [57, 0] },
    ]
    [radio]
    range = "24m"
    loss = )"
       << loss << '\n';
  return toml.str();
}

/// The same line with medium access alone: packets over its three hops, every 9.7 s, no multiple of
/// an interval.
std::string relays(const std::string& listening, double loss) {
  std::ostringstream toml;
  toml << R"(
    ecology = { name = "low-power-relays", duration = "1h" }
    [[island]]
    id = 1
    name = "hall"
    stack = "mac"
    )" << listening
       << R"(
    sink.apps = [{ app = "receiver" }]
    mote = [
      { id = 2, name = "near", position_m = [19, 0], apps = [{ app = "relay", next = "sink" }] },
      { id = 3, name = "middle", position_m = [38, 0], apps = [{ app = "relay", next = "hall/near" }] },
      { id = 4, name = "far", position_m = [57, 0], apps = [
        { app = "sender", to = "sink", via = "hall/middle", every = "9.7s", start = "1s" }] },
    ]
    [radio]
    range = "24m"
    loss = )"
       << loss << '\n';
  return toml.str();
}

double radio_on(const report::energy_report& x) {
  const auto on = x.radio_listen + x.radio_receive + x.radio_transmit;
  return seconds(on) / seconds(on + x.radio_off);
}

double radio_on(const report::island_report& x) {
  double sum = 0;
  for (const auto& mote : x.motes)
    sum += radio_on(mote.energy);
  return sum / static_cast<double>(x.motes.size());
}

struct setting {
  const char* interval;
  double seconds;
  double most_on; ///< share of the time that a radio may be on, of the full stack
};

constexpr setting settings[] = {{"128ms", 0.128, 0.2}, {"512ms", 0.512, 0.12}, {"2s", 2, 0.15}};

} // namespace

TEST_CASE("motes whose radios listen at low power join, and their readings arrive",
          "[ecology][radio][NRG-02]") {
  for (const auto& x : settings)
    for (const auto loss : {0.0, 0.2}) {
      const auto result = run(describe(line(x.interval, loss)));
      const auto& hall = result.islands.at(0);
      const auto sent = hall.messages.reliable_sent + hall.messages.unreliable_sent;
      const auto arrived = hall.messages.arrived;
      std::printf("interval %5s, loss %2.0f %%: %llu of %llu readings, radio on %.1f %%\n",
                  x.interval, 100 * loss, static_cast<unsigned long long>(arrived),
                  static_cast<unsigned long long>(sent), 100 * radio_on(hall));
      INFO(x.interval << ", loss " << loss);
      CHECK(told_violations(result).empty());
      for (const auto& mote : hall.motes) {
        CHECK(mote.joined);
        CHECK(mote.left_cause.empty());
      }
      CHECK(sent >= 170);
      CHECK(static_cast<double>(arrived) >= 0.99 * static_cast<double>(sent));
      CHECK(radio_on(hall) <= x.most_on);
      CHECK(radio_on(hall) >= 0.011 / x.seconds); // the checks alone
      const auto radio = result.radio();
      CHECK(radio.sent == radio.delivered + report::total(radio.lost));
      CHECK(radio.requests == radio.mac_sent + report::total(radio.mac_failed) + radio.mac_open);
    }
}

TEST_CASE("a packet waits up to an interval at each hop to a mote that sleeps",
          "[ecology][radio][NRG-02]") {
  for (const auto& x : settings)
    for (const auto loss : {0.0, 0.2}) {
      const auto listening =
          std::string("low_power_listening = { interval = \"") + x.interval + "\" }";
      const auto result = run(describe(relays(listening, loss)));
      const auto& flow = result.flows.at(0);
      std::printf("interval %5s, loss %2.0f %%: %.1f %% of packets over 3 hops, delay %.0f ms "
                  "(median %.0f, 95 %% %.0f), radio on %.1f %%\n",
                  x.interval, 100 * loss, 100 * flow.pdr, flow.delay_mean_ms, flow.delay_p50_ms,
                  flow.delay_p95_ms, 100 * radio_on(result.islands.at(0)));
      INFO(x.interval << ", loss " << loss);
      CHECK(told_violations(result).empty());
      CHECK(flow.pdr >= 0.99);
      // Two hops to motes that sleep, and one to the sink. From the first to the second it is
      // always as long as between their checks.
      CHECK(flow.delay_mean_ms >= 1000 * x.seconds * 0.45);
      CHECK(flow.delay_mean_ms <= 1000 * x.seconds * 1.55 + 40);
    }
  const auto awake = run(describe(relays("", 0)));
  CHECK(awake.flows.at(0).delay_p95_ms < 30);
}
