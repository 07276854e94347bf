// A line of motes whose radios sleep, with crystals that are off, a lossy air, and reboots of an
// end and of a relay: what arrives, how soon streams are open again, what the radios cost.
//
// The far mote writes a stream to the near one and has a lamp that a robot switches once a minute.
// The near one is the sink's only neighbour. One of the two crashes at 5 minutes (the writer with
// even seeds, the reader with odd ones), and the mote in the middle at an hour.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "actors/run/run.hpp"
#include "config/load.hpp"

namespace {

using namespace rubicon;

struct setting {
  unsigned hops = 1; ///< from the writer to the reader
  unsigned ppm = 0;
  unsigned loss_percent = 0;
};

constexpr unsigned period_s = 4;

/// The longest that a reader may go without a record.
constexpr double pause_max_s(unsigned hops) {
  return 30 + 3.0 * period_s * hops;
}

std::string name_of(unsigned mote, unsigned hops) {
  return mote == 0 ? "near" : mote == hops ? "far" : "relay-" + std::to_string(mote);
}

std::string ecology_of(const setting& x, bool writer_crashes, const std::string& length) {
  std::ostringstream toml;
  toml << "[ecology]\nname = 'sleep'\nduration = '" << length << "'\n"
       << "[radio]\nrange = '24m'\nloss = '" << x.loss_percent << "%'\n"
       << "[mote_type.m]\ntype = 1\n"
       << "transducers = { temperature = { model = 'sine', mean = 18, amplitude = 4, period = "
          "'40min' } }\n"
       << "[mote_type.lamp]\ntype = 2\n"
       << "transducers = { temperature = { model = 'sine', mean = 18, amplitude = 4, period = "
          "'40min' } }\n"
       << "actuators = [{ name = 'switch', kind = 'relay' }]\n"
       << "[[island]]\nid = 1\nname = 'line'\nsink.position_m = [0, 0]\nkeep_alive = '1min'\n"
       << "crystal_ppm = " << x.ppm << "\ngateway.links = ['inproc://desk']\n"
       << "duty_cycle = { period = '" << period_s << "s', window = '80ms' }\n"
       << "[[peer]]\nid = 21\nname = 'desk'\napps = [{ app = 'proxy_manager' }, { app = 'goal', "
          "name "
          "= 'clock', outputs = [{ name = 'minutes', value = 0, every = '1min', step = 1 }] }, { "
          "app "
          "= 'translate', rules = [{ from = 'clock.minutes', to = 'clock.odd', value = 'x - 2 * "
          "floor(x / 2)' }] }]\n"
       << "[[peer]]\nid = 22\nname = 'watchman'\nlinks = ['inproc://desk']\napps = [{ app = "
          "'rules', retry = '0s', rules = [{ when = 'clock.odd', above = 0.6, below = 0.4, write = "
          "'line.far.switch', then = 'on', otherwise = 'off' }] }]\n"
       << "[[proxy]]\nname = 'lamp'\ntypes = [2]\n"
       << "[[proxy.field]]\nname = 'state'\nchannel = 2\nencoding = 'u8'\n"
       << "[[proxy.input]]\nname = 'switch'\nchannel = 2\nwords = { on = '01', off = '00' }\n";
  for (unsigned i = 0; i <= x.hops; ++i) {
    toml << "[[island.mote]]\nid = " << i + 2 << "\nname = '" << name_of(i, x.hops) << "'\ntype = '"
         << (i == x.hops ? "lamp" : "m") << "'\nposition_m = [" << 19 * (i + 1) << ", 0]\n";
    if (i == 0)
      toml << "apps = [{ app = 'stream_reader', stream = 3, every = '1s' }]\n";
    if (i == x.hops)
      toml << "apps = [{ app = 'stream_writer', transducer = 'temperature', stream = 3, every = "
              "'1s', to = 'line/near' }, { app = 'actuator', actuator = 'switch' }]\n";
  }
  const auto crash = [&](const char* at, unsigned mote) {
    toml << "[[fault]]\nat = '" << at << "'\nkind = 'crash'\nmote = 'line/" << name_of(mote, x.hops)
         << "'\n";
  };
  crash("5min", writer_crashes ? x.hops : 0);
  if (x.hops > 1)
    crash("60min", x.hops / 2);
  toml << "[[expect]]\nkind = 'clock'\nat_most = '1ms'\nshare = '99.9%'\nfrom = '5min'\n"
       << "[[expect]]\nkind = 'clock'\nat_most = '3ms'\nfrom = '5min'\n"
       << "[[expect]]\nkind = 'members'\n";
  return toml.str();
}

struct line_result {
  double delivery = 0;
  double pause_s = 0;
  unsigned opens_failed = 0;
  double acked = 0;
  double radio = 0; ///< of the mote that is on most
  bool clock = false;
  bool sane = false; ///< no other violation
};

line_result run_one(const setting& what, std::uint64_t seed, const std::string& length) {
  auto loaded = config::load_text(ecology_of(what, seed % 2 == 0, length), "sleep.toml", {}, {});
  if (!loaded.ecology)
    throw std::logic_error("the bench's own ecology is refused: " +
                           (loaded.problems.empty() ? "" : loaded.problems.front().message));
  run_options options;
  options.seed = seed;
  const auto report = run_ecology(*loaded.ecology, options);
  line_result x;
  if (!report.streams.empty()) {
    const auto& stream = report.streams.front();
    x.delivery = stream.delivery().value_or(0);
    x.pause_s = seconds(stream.pause);
    x.opens_failed = static_cast<unsigned>(stream.opens_failed);
  }
  const auto all = report.messages();
  const auto ended = all.reliable_sent - all.reliable_open;
  x.acked = ended == 0 ? 0 : static_cast<double>(all.reliable_acked) / static_cast<double>(ended);
  for (const auto& mote : report.islands.front().motes)
    x.radio = std::max(x.radio, 1 - seconds(mote.energy.radio_off) / seconds(mote.energy.elapsed));
  x.clock = report.expectations.at(0).outcome == report::expectation_report::verdict::met &&
            report.expectations.at(1).outcome == report::expectation_report::verdict::met;
  x.sane = std::ranges::all_of(report.violations, [](const auto& each) {
    return each.detail.find("clock") != std::string::npos ||
           each.invariant.find("clock") != std::string::npos;
  });
  return x;
}

double share_wanted(unsigned loss_percent) {
  return loss_percent == 0 ? 0.999 : loss_percent <= 5 ? 0.99 : 0.95;
}

void print_row(const setting& what, const std::vector<line_result>& all,
               const std::string& failed) {
  const auto count = [&all](auto fits) { return std::ranges::count_if(all, fits); };
  double delivery = 0;
  double worst = 1;
  double pause = 0;
  double acked = 0;
  double radio = 0;
  unsigned opens_failed = 0;
  for (const auto& x : all) {
    delivery += x.delivery / static_cast<double>(all.size());
    acked += x.acked / static_cast<double>(all.size());
    worst = std::min(worst, x.delivery);
    pause = std::max(pause, x.pause_s);
    radio = std::max(radio, x.radio);
    opens_failed += x.opens_failed;
  }
  const auto seeds = static_cast<long>(all.size());
  std::printf(
      "%4u %4u %4u%% %8.2f %7.2f %5ld/%-3ld %7.0f %5ld/%-3ld %6u %7.2f %6.2f %5ld/%-3ld "
      "%3ld/%-3ld%s\n",
      what.hops, what.ppm, what.loss_percent, 100 * delivery, 100 * worst,
      count([&](const line_result& x) { return x.delivery >= share_wanted(what.loss_percent); }),
      seeds, pause,
      count([&](const line_result& x) { return x.pause_s <= pause_max_s(what.hops); }), seeds,
      opens_failed, 100 * acked, 100 * radio, count([](const line_result& x) { return x.clock; }),
      seeds, count([](const line_result& x) { return x.sane; }), seeds, failed.c_str());
  std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv) {
  std::vector<unsigned> hops{1, 2, 3, 4, 5, 6, 7, 8};
  std::vector<unsigned> ppm{0, 50, 100};
  std::vector<unsigned> loss{0, 5, 20};
  std::uint64_t seeds = 3;
  std::string length = "2h";
  bool show = false;
  CLI::App command{"Sleeping lines: hops, crystals, loss, reboots"};
  command.add_option("--hops", hops, "from writer to reader");
  command.add_option("--ppm", ppm, "crystals are off by up to this");
  command.add_option("--loss", loss, "of frames, in percent");
  command.add_option("--seeds", seeds, "1 to this one each")->check(CLI::PositiveNumber);
  command.add_option("--for", length, "how long each run is");
  command.add_flag("--show", show,
                   "print the ecology of the first row's last seed, and run nothing");
  CLI11_PARSE(command, argc, argv);
  spdlog::set_level(spdlog::level::off);

  if (show) {
    const setting first{hops.front(), ppm.front(), loss.front()};
    std::printf("%s", ecology_of(first, seeds % 2 == 0, length).c_str());
    return 0;
  }
  std::printf("%4s %4s %5s %8s %7s %9s %7s %9s %6s %7s %6s %9s %7s\n", "hops", "ppm", "loss",
              "read %", "worst", "enough", "pause s", "short", "failed", "acked %", "radio",
              "clock", "sane");
  for (const auto h : hops)
    for (const auto p : ppm)
      for (const auto l : loss) {
        const setting what{h, p, l};
        std::vector<line_result> all;
        std::string insane;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
          all.push_back(run_one(what, seed, length));
          if (!all.back().sane)
            insane += "  seed " + std::to_string(seed);
        }
        print_row(what, all, insane);
      }
  return 0;
}
