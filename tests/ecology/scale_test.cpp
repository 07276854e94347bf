// Many islands instead of few, each with the same to do (R1.SCALABILITY).
#include <sstream>

#include "ecology/island/lamp_and_climate.hpp"
#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr unsigned motes = 20; ///< of an island: one has a lamp that a rule of the PC switches

config::ecology_description islands(unsigned count) {
  std::ostringstream toml;
  toml << R"toml(
[ecology]
name = "islands"
duration = "4min"
[mote_type.climate]
type = 100
transducers = { temperature = { model = "sine", mean = 20, amplitude = 5, period = "20min" } }
[mote_type.lamp]
type = 200
actuators = [{ name = "switch", kind = "relay" }]
[[peer]]
id = 1001
name = "desk"
apps = [
  { app = "proxy_manager" },
  { app = "goal", name = "clock", outputs = [{ name = "seconds", value = 0, every = "10s", step = 1 }] },
  { app = "translate", rules = [{ from = "clock.seconds", to = "clock.odd", value = "x - 2 * floor(x / 2)" }] },
  { app = "rules", rules = [)toml";
  for (unsigned i = 1; i <= count; ++i)
    toml << "{ when = 'clock.odd', above = 0.6, below = 0.4, write = 'island-" << i
         << ".lamp.switch', then = 'on', otherwise = 'off' },\n";
  toml << "] }]\n" << lamp_and_climate;
  for (unsigned i = 1; i <= count; ++i) {
    toml << "[[island]]\nid = " << i << "\nname = 'island-" << i << "'\nsink.position_m = ["
         << 1000 * i << ", 0]\ngateway.links = ['inproc://desk']\n";
    for (unsigned mote = 0; mote < motes; ++mote) {
      const bool is_lamp = mote == 0;
      toml << "[[island.mote]]\nid = " << mote + 2 << "\nname = '"
           << (is_lamp ? "lamp" : "climate-" + std::to_string(mote)) << "'\ntype = '"
           << (is_lamp ? "lamp" : "climate") << "'\nposition_m = [" << 1000 * i + 2 + mote % 5
           << ", " << mote / 5 << "]\napps = ["
           << (is_lamp
                   ? "{ app = 'actuator', actuator = 'switch' }"
                   : "{ app = 'sampler', transducers = ['temperature'], every = '10s', jitter = "
                     "'5s' }")
           << "]\n";
    }
  }
  return describe(toml.str());
}

struct load_result {
  double received = 0;  ///< messages that an island's gateway has got from a mote
  double median_ms = 0; ///< from a word in a tuple to the mote's acknowledgement
  std::uint64_t actuations = 0;
};

load_result under(const report::run_report& x) {
  load_result sum;
  for (const auto& island : x.islands)
    sum.received += static_cast<double>(island.messages.arrived);
  sum.received /= static_cast<double>(x.islands.size() * motes);
  delay_histogram latency;
  for (const auto& proxy : x.proxies) {
    latency += proxy.actuations.latency;
    sum.actuations += proxy.actuations.acknowledged;
    CHECK(proxy.actuations.failed.empty());
  }
  sum.median_ms = latency.quantile_ms(0.5);
  return sum;
}

} // namespace

TEST_CASE("fifty islands do as well as two, each for itself", "[ecology][NFR-06]") {
  const auto few = run(islands(2));
  const auto many = run(islands(50));
  for (const auto* each : {&few, &many}) {
    INFO(told_violations(*each));
    CHECK(each->violations.empty());
    CHECK(each->motes_alive() == each->islands.size() * motes);
  }
  const auto alone = under(few);
  const auto crowded = under(many);
  CAPTURE(alone.received, crowded.received, alone.median_ms, crowded.median_ms);
  CHECK(alone.received > 20);
  CHECK(alone.actuations >= 2 * 20);
  CHECK(crowded.actuations >= 50 * 20);
  CHECK(std::abs(crowded.received / alone.received - 1) < 0.1);
  CHECK(std::abs(crowded.median_ms / alone.median_ms - 1) < 0.1);
}
