#include "actors/run.hpp"

#include <algorithm>
#include <chrono>

#include <caf/send.hpp>
#include <unistd.h>

#include "actors/debug_log.hpp"
#include "actors/ecology.hpp"
#include "actors/frame_captures.hpp"
#include "io/machine.hpp"
#include "io/signal_watch.hpp"
#include "scheduler/world.hpp"

namespace rubicon {

namespace {

using steady = std::chrono::steady_clock;

/// How long what peers say at the end may take to leave (ACT-11).
constexpr duration goodbye_time = 200ms;
/// How long inits may take to stop their components (SVC-05).
constexpr duration stop_time_max = 4s;

scheduler::world_options world_options_of(config::run_mode mode, double speed) {
  scheduler::world_options x;
  x.mode = mode == config::run_mode::wall ? scheduler::time_mode::wall
                                          : scheduler::time_mode::virtual_time;
  x.speed = speed;
  return x;
}

/// Runs to `end` in steps short enough for a progress bar; steps change the order of nothing.
scheduler::stop_cause run_with_progress(scheduler::world& world, instant end,
                                        const run_options& options, double speed) {
  if (!options.progress)
    return world.run_until(end);
  constexpr int steps = 500;
  auto step = std::max<duration>(end.time_since_epoch() / steps, 1ms);
  if (speed > 0) // paced: at least ten steps a real second
    step =
        std::min(step, std::max<duration>(duration(static_cast<std::int64_t>(speed * 1e8)), 1ms));
  for (;;) {
    const auto cause = world.run_until(std::min(end, world.now() + step));
    options.progress({world.now(), end, world.trace().events()});
    if (cause != scheduler::stop_cause::reached_end || world.now() >= end)
      return cause;
  }
}

/// In wall time peers may meet those of other processes, and must be told apart from them.
process_facts facts_of(scheduler::world& world, bool wall) {
  process_facts x;
  if (!wall)
    return x;
  x.machine = io::machine_name();
  x.loop = &world.loop();
  x.number = static_cast<std::uint32_t>(::getpid());
  x.clock_offset =
      std::chrono::duration_cast<duration>(std::chrono::system_clock::now().time_since_epoch());
  return x;
}

bool has_init(const config::ecology_description& x) {
  return std::ranges::any_of(x.peers, [](const auto& peer) {
    return std::ranges::any_of(
        peer.apps, [](const auto& app) { return std::holds_alternative<config::init_app>(app); });
  });
}

bool has_real_links(const config::ecology_description& x) {
  return std::ranges::any_of(
      x.peers, [](const auto& peer) { return peer.tcp || peer.lan || !peer.connect.empty(); });
}

} // namespace

runtime::report run_ecology(const config::ecology_description& file, const run_options& options) {
  auto description = file;
  description.seed = options.seed.value_or(file.seed);
  description.mode = options.mode.value_or(file.mode);
  description.length = options.length.value_or(file.length);
  const bool wall = description.mode == config::run_mode::wall;
  const auto speed = wall && options.speed == 0 ? 1 : options.speed;

  scheduler::world world(world_options_of(description.mode, speed));
  std::optional<debug_log> debug;
  if (!options.debug_folder.empty())
    debug.emplace(options.debug_folder, options.debug_file_octets_max);
  std::optional<run_record> record;
  if (!options.record_file.empty()) {
    record.emplace(options.record_file, description, options.source);
    world.trace().observe_remarks([&record](const scheduler::remark& x) { record->write(x); });
  }
  if (debug || record)
    world.trace().observe([&debug, &record](const scheduler::delivery& x) {
      if (debug)
        debug->write(x);
      if (record)
        record->write(x);
    });
  std::optional<io::signal_watch> signals;
  if (options.handle_signals)
    signals.emplace(world.loop(), [&world](int) { world.request_stop(); });

  std::optional<frame_captures> captures;
  frame_observer observe;
  if (!options.pcap_folder.empty())
    captures.emplace(options.pcap_folder, description, options.pcap_lost);
  if (captures || record)
    observe = [&captures, &record](const radio::overheard& x) {
      if (captures)
        captures->write(x);
      if (record)
        record->write(x);
    };

  runtime::report report;
  const auto started = steady::now();
  const auto end = instant(description.length);
  const auto path = "ecology/" + description.name;
  bool inits_run = has_init(description);
  auto facts = facts_of(world, wall);
  facts.on_inits_ended = [&inits_run] { inits_run = false; };
  const auto root = world.spawn(
      path, ecology, std::move(description),
      [&report](runtime::report x) { report = std::move(x); }, observe, std::move(facts));
  const auto cause = run_with_progress(world, end, options, speed);

  caf::anon_send(root, collect_report{});
  world.drain();
  caf::anon_send(root, deliver_report{});
  world.drain();
  caf::anon_send(root, end_run{});
  world.drain();
  for (const auto latest = world.now() + stop_time_max; inits_run && world.now() < latest;)
    static_cast<void>(world.run_for(50ms));
  if (wall && has_real_links(file))
    static_cast<void>(world.run_for(goodbye_time));
  if (captures)
    captures->finish();
  if (record)
    record->finish();
  report.mode = wall ? "wall" : "virtual";
  report.interrupted = cause == scheduler::stop_cause::requested;
  report.wall_s = std::chrono::duration<double>(steady::now() - started).count();
  report.events = world.trace().events();
  report.trace_hash = to_hex(world.trace().hash());
  return report;
}

} // namespace rubicon
