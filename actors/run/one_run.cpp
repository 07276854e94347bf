#include "actors/run/one_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <unistd.h>

#include "actors/messages/peis.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/run/look.hpp"
#include "actors/run/run_steps.hpp"
#include "core/hash.hpp"
#include "io/process/machine.hpp"
#include "report/fault_plan.hpp"
#include "report/invariants.hpp"

namespace rubicon {

namespace {

/// So long the last messages of peers may take to be sent (ACT-11).
constexpr duration goodbye_time = 200ms;
/// How long inits may take to stop their components (SVC-05).
constexpr duration stop_time_max = 4s;

scheduler::world_options world_options_of(config::run_mode mode, double speed,
                                          const run_options& options) {
  scheduler::world_options x;
  x.mode = mode == config::run_mode::wall ? scheduler::time_mode::wall
                                          : scheduler::time_mode::virtual_time;
  x.speed = speed;
  x.threads = options.threads;
  x.in_order =
      !options.pcap_folder.empty(); // frames are captured as they end, by whoever sees them
  return x;
}

/// Processes of other machines may have the same pid, and a machine the name of another.
std::uint32_t process_number() {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return static_cast<std::uint32_t>(fold64()
                                        .add(io::machine_name())
                                        .add(static_cast<std::uint64_t>(::getpid()))
                                        .add(static_cast<std::uint64_t>(now))
                                        .value());
}

bool has_any_init(const config::ecology_description& x) {
  return std::ranges::any_of(x.peers, [](const auto& peer) {
    return std::ranges::any_of(
        peer.apps, [](const auto& app) { return std::holds_alternative<config::init_app>(app); });
  });
}

bool has_real_links(const config::ecology_description& x) {
  return std::ranges::any_of(x.peers,
                             [](const auto& peer) { return config::has_real_links(peer); });
}

} // namespace

const char* mode_name(const config::ecology_description& x) {
  return x.mode == config::run_mode::wall ? "wall" : "virtual";
}

one_run::one_run(const config::ecology_description& description, const run_options& options,
                 run_files& files, report::expectations& judge, report::run_report& report)
    : judge_(judge), files_(files), description_(description), options_(options), report_(report),
      wall_(description.mode == config::run_mode::wall),
      reports_(wall_ ? options.report_every : duration{}),
      speed_(wall_ && options.speed == 0 ? 1 : options.speed),
      world_(world_options_of(description.mode, speed_, options)),
      lifetime_(world_, description.until), inits_run_(has_any_init(description)) {
  files.watch(world_.trace());
  if (options.on_hangup)
    hangups_.emplace(world_.loop(), options.on_hangup);
  if (options.handle_signals)
    signals_.emplace(
        world_.loop(), [this](int) { world_.request_stop(); }, !options.on_hangup);
  root_ = world_.spawn(
      "ecology/" + description.name, ecology, description,
      [this](report::run_report& x) { take(x); }, files.frames(), facts());
  root_.get().attach_functor([this](const caf::error& reason) { on_root_ended(reason); });
  if (options.on_begun)
    options.on_begun({world_.loop(), [this] { world_.request_stop(); },
                      [this](const config::fault& x) { apply(x); },
                      [this](const config::fault_description& x) { plan_rest(x); },
                      [this] { return world_.now(); },
                      [this](const std::string& peer, const std::string& key,
                             const std::string& value) { return set_tuple_of(peer, key, value); }});
}

one_run::~one_run() {
  over_ = true;
  signals_.reset(); // before its loop
  hangups_.reset();
  root_ = nullptr; // before its system
  world_.shutdown();
}

report::run_report one_run::report_so_far() {
  static_cast<void>(world_.drain());
  auto& state = root_state();
  const collected_answers kept = state;
  const auto before = report_;
  timers_ = world_.stats().waiting;
  is_so_far_ = true;
  deliver(collect_report{});
  deliver(deliver_report{});
  is_so_far_ = false;
  measure();
  static_cast<collected_answers&>(state) = kept;
  return std::exchange(report_, before);
}

void one_run::plan(const config::fault_description& x, const std::vector<duration>& times) {
  auto& faults = root_state().description.faults;
  faults.push_back(x);
  const apply_fault message{static_cast<std::uint32_t>(faults.size() - 1)};
  for (const auto at : times)
    scheduler::post_at(root_, instant(at), message);
  if (std::holds_alternative<config::battery_end_fault>(x.what))
    for (const auto at : times)
      lifetime_.expect_end(instant(at));
}

void one_run::perform() {
  const auto end = std::max(instant(description_.length), world_.now());
  const auto cause = run_to(end);
  lifetime_.close();
  timers_ = world_.stats().waiting;
  deliver(collect_report{});
  world_.trace().messages().finish();
  deliver(deliver_report{});
  report_.ended_by = lifetime_.ended_by();
  const bool is_cut_short = report_.ended_by.empty() && ended_early_.empty();
  report_.interrupted = is_cut_short && cause == scheduler::stop_cause::requested;
  if (report_.complete && !report_.interrupted && is_cut_short && world_.now() < end)
    ended_early_ = "the run ended early";
  if (!ended_early_.empty())
    break_off(ended_early_);
  leave();
  over_ = true;
}

void one_run::measure() {
  if (!report_.complete)
    report_.simulated = world_.now().time_since_epoch();
  report_.events = world_.trace().events();
  report_.trace_hash = to_hex(world_.trace().hash());
  if (report_.complete)
    for (auto& each : report::check_timers(report_, timers_))
      report_.violations.push_back(std::move(each));
}

scheduler::stop_cause one_run::run_to(instant end) {
  if (options_.reseed && !reseeded_ && options_.reseed->since < end) {
    if (const auto cause = run_on(options_.reseed->since);
        cause != scheduler::stop_cause::reached_end)
      return cause;
    reseeded_.emplace(*options_.reseed);
  }
  return run_on(end);
}

scheduler::stop_cause one_run::run_on(instant end) {
  progress_steps steps(world_, end, options_, speed_);
  standstill still(speed_);
  const auto next_still_look = [&] {
    return wall_ ? world_.now() +
                       static_cast<std::int64_t>(std::ceil(speed_)) * standstill::look_every
                 : instant::max();
  };
  const auto every = look_every();
  auto look_next = every > 0s ? next_multiple(every) : instant::max();
  auto watch_next = next_multiple(report::time_watch::every);
  while (lifetime_.ended_by().empty()) {
    const auto cause = steps.run_to(
        std::min({look_next, watch_next, next_still_look(), lifetime_.next_look(), end}));
    if (wall_)
      if (const auto length = still.look(world_.now()))
        note_standstill(*length);
    const bool is_last = cause != scheduler::stop_cause::reached_end || world_.now() >= end;
    if (!is_last && !over_ && ended_early_.empty())
      report_on_time();
    if (!over_ && ended_early_.empty()) {
      if (world_.now() >= watch_next)
        watch_time(root_state(), world_.now());
      if (every > 0s && (world_.now() >= look_next || is_last))
        look();
    }
    if (is_last)
      return cause;
    if (world_.now() >= watch_next)
      watch_next = next_multiple(report::time_watch::every);
    if (world_.now() >= look_next)
      look_next = next_multiple(every);
    if (world_.now() >= lifetime_.next_look())
      lifetime_.look(root_state());
  }
  return scheduler::stop_cause::requested;
}

void one_run::report_on_time() {
  const auto real = [] { return duration(std::chrono::steady_clock::now().time_since_epoch()); };
  const auto begun = real();
  if (!reports_.is_due(begun))
    return;
  auto report = report_so_far();
  const auto ended = real();
  reports_.on_report(begun, ended);
  options_.on_report(std::move(report), ended - begun);
}

void one_run::note_standstill(duration length) {
  const auto text = std::to_string(length / 1s) + " s";
  post(root_, notable_event{"ecology", "this process or its computer was suspended for " + text +
                                           ": other processes may have considered it dead"});
}

instant one_run::next_multiple(duration every) {
  return instant((world_.now().time_since_epoch() / every + 1) * every);
}

duration one_run::look_every() const {
  if (options_.look_every > 0s && options_.on_sample)
    return options_.look_every;
  constexpr int samples = 100; // of a run that is only recorded
  return files_.records() ? std::max(description_.length / samples, duration(1s)) : 0s;
}

void one_run::look() {
  const auto sample = look_at(root_state(), world_.now());
  files_.write(sample);
  if (options_.on_sample)
    options_.on_sample(sample);
}

ecology_state& one_run::root_state() {
  return static_cast<scheduler::shell<ecology_state, root_interface>&>(root_.get()).state;
}

void one_run::apply(const config::fault& x) {
  if (over_)
    return;
  auto& faults = root_state().description.faults;
  faults.push_back({world_.now().time_since_epoch(), x});
  post(root_, apply_fault{static_cast<std::uint32_t>(faults.size() - 1)});
}

void one_run::plan_rest(const config::fault_description& x) {
  if (over_)
    return;
  auto times = report::times_of(x, 0, description_.seed, description_.length);
  std::erase_if(times, [this](duration at) { return instant(at) <= world_.now(); });
  plan(x, times);
}

bool one_run::set_tuple_of(const std::string& peer, const std::string& key,
                           const std::string& value) {
  if (over_)
    return false;
  const auto& peers = root_state().peers;
  const auto found = peers.find(peer);
  if (found == peers.end() || !found->second.handle)
    return false;
  if (found->second.handle.get().has_ended()) // its end is not known to the ecology yet
    return false;
  post(found->second.handle, set_tuple{key, payload(to_bytes(value)), true});
  return true;
}

void one_run::take(report::run_report& x) {
  x.interrupted = report_.interrupted;
  if (is_so_far_) // what was collected is forgotten: of many motes a copy takes long
    report_ = std::move(x);
  else
    report_ = x;
  report_.mode = mode_name(description_);
}

void one_run::break_off(const std::string& why) {
  report_.complete = false;
  report_.reason = why;
}

void one_run::leave() {
  deliver(end_run{});
  for (const auto latest = world_.now() + stop_time_max; inits_run_ && world_.now() < latest;)
    static_cast<void>(world_.run_for(50ms));
  if (wall_ && has_real_links(description_))
    static_cast<void>(world_.run_for(goodbye_time));
}

void one_run::on_root_ended(const caf::error& reason) {
  if (over_)
    return;
  inits_run_ = false; // nobody else could report it
  end_early("the supervisor of the ecology ended: " + text_of(reason));
  report_.complete = false;
}

void one_run::end_early(const std::string& why) {
  if (ended_early_.empty())
    ended_early_ = why;
  world_.request_stop();
}

process_facts one_run::facts() {
  process_facts x;
  x.on_inits_ended = [this] { inits_run_ = false; };
  x.on_end_wanted = [this](const std::string& why) { end_early(why); };
  x.on_flat = [this](const std::string& mote) { lifetime_.on_flat(mote); };
  if (!judge_.empty())
    x.judge = &judge_;
  x.on_late_violation = [this](report::violation late) {
    report_.violations.push_back(std::move(late));
  };
  x.on_event = options_.on_event;
  x.on_counters = options_.on_counters;
  x.writes_debug_log = !options_.debug_folder.empty();
  x.starts = options_.starts;
  x.on_starts = options_.on_starts;
  if (!wall_ && description_.date)
    x.clock_offset = *description_.date + description_.day_begins;
  if (!wall_)
    return x;
  x.machine = io::machine_name();
  x.loop = &world_.loop();
  x.number = process_number();
  x.clock_offset =
      std::chrono::duration_cast<duration>(std::chrono::system_clock::now().time_since_epoch());
  return x;
}

} // namespace rubicon
