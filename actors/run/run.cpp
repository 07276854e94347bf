#include "actors/run/ecology_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include <unistd.h>

#include "actors/base/debug_log.hpp"
#include "actors/base/failure.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/tuple_teller.hpp"
#include "actors/run/frame_captures.hpp"
#include "actors/run/lifetime.hpp"
#include "actors/run/look.hpp"
#include "actors/run/run_record.hpp"
#include "actors/serial/serial_recorder.hpp"
#include "actors/supervision/ecology.hpp"
#include "core/hash.hpp"
#include "core/text/shell_word.hpp"
#include "core/tuples/device_keys.hpp"
#include "io/process/hangup_watch.hpp"
#include "io/process/machine.hpp"
#include "io/process/signal_watch.hpp"
#include "report/expectations.hpp"
#include "report/fault_plan.hpp"
#include "report/invariants.hpp"
#include "scheduler/world.hpp"

namespace rubicon {

namespace {

using steady = std::chrono::steady_clock;

/// How long what peers say at the end may take to leave (ACT-11).
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

/// Runs in steps short enough for a progress bar: some ten a real second, however fast time
/// passes. They change nothing.
class progress_steps {
public:
  /// @param speed ecology seconds a real second; 0: as fast as possible
  progress_steps(scheduler::world& world, instant end, const run_options& options, double speed)
      : world_(world), end_(end), options_(options),
        longest_(speed > 0 ? std::max(duration(static_cast<std::int64_t>(speed * 1e8)), shortest)
                           : end.time_since_epoch()) {}

  scheduler::stop_cause run_to(instant until) {
    if (!options_.progress)
      return world_.run_until(until);
    for (;;) {
      const auto started = steady::now();
      const auto cause = world_.run_until(std::min(until, parallel::later(world_.now(), length_)));
      const auto took = steady::now() - started;
      options_.progress({world_.now(), end_, world_.trace().events()});
      if (took > 200ms)
        length_ = std::max(length_ / 2, shortest);
      if (cause != scheduler::stop_cause::reached_end || world_.now() >= until)
        return cause;
      if (took < 50ms)
        length_ = std::min(2 * length_, longest_);
    }
  }

private:
  static constexpr duration shortest = 1ms;

  scheduler::world& world_;
  instant end_; ///< of the run
  const run_options& options_;
  duration longest_;
  duration length_ = shortest; ///< lasts over all calls: whoever runs ahead stops at each
};

/// Notices that a run in wall time has stood still: its process was stopped, or its computer was
/// suspended. Whoever waited for it meanwhile has given it up.
class standstill {
public:
  /// @param speed ecology seconds a real second
  explicit standstill(double speed) : speed_(speed) {}

  static constexpr duration look_every = 1s; ///< of ecology time, at speed 1

  /// @returns how long, once; nothing if it went on
  [[nodiscard]] std::optional<duration> look(instant now) {
    constexpr duration shortest = 5s; // others wait longer
    const std::chrono::microseconds real(io::time_since_boot_us());
    const auto passed = real - std::exchange(last_real_, real);
    const auto planned = duration(static_cast<duration::rep>(
        static_cast<double>((now - std::exchange(last_, now)).count()) / speed_));
    const auto still = passed - planned;
    if (!std::exchange(has_looked_, true) || still < shortest)
      return std::nullopt;
    return still;
  }

private:
  double speed_;
  bool has_looked_ = false;
  std::chrono::microseconds last_real_{};
  instant last_;
};

/// Processes of other machines may have the same pid, and a machine the name of another.
std::uint32_t process_number() {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return static_cast<std::uint32_t>(fold64()
                                        .add(io::machine_name())
                                        .add(static_cast<std::uint64_t>(::getpid()))
                                        .add(static_cast<std::uint64_t>(now))
                                        .value());
}

const char* mode_name(const config::ecology_description& x) {
  return x.mode == config::run_mode::wall ? "wall" : "virtual";
}

bool has_init(const config::ecology_description& x) {
  return std::ranges::any_of(x.peers, [](const auto& peer) {
    return std::ranges::any_of(
        peer.apps, [](const auto& app) { return std::holds_alternative<config::init_app>(app); });
  });
}

bool has_real_links(const config::ecology_description& x) {
  return std::ranges::any_of(x.peers,
                             [](const auto& peer) { return config::has_real_links(peer); });
}

/// What the run is to do, the command line's word before the file's.
config::ecology_description overridden(config::ecology_description x, const run_options& options) {
  x.seed = options.seed.value_or(x.seed);
  x.mode = options.mode.value_or(x.mode);
  x.length = options.length.value_or(x.length);
  return x;
}

/// What a program of a peer does to a tuple.
void tell_tuple(report::expectations& judge, const scheduler::delivery& x) {
  if (!x.received)
    return;
  if (const auto* set = x.as<set_tuple>())
    judge.on_tuple(set->key, tuple_text(set->value.view()), x.time);
  else if (const auto* remote = x.as<set_remote_tuple>())
    judge.on_tuple(remote->key, tuple_text(remote->value.view()), x.time);
  else if (const auto* gone = x.as<delete_tuple>())
    judge.on_tuple_gone(gone->key, x.time);
}

/// What is written while the ecology runs.
class run_files {
public:
  /// @param judge told of tuples; outlives this
  run_files(const config::ecology_description& description, const run_options& options,
            report::expectations& judge)
      : judge_(judge.watches_tuples() ? &judge : nullptr) {
    if (options.on_tuple)
      teller_.emplace(description, options.on_tuple);
    if (!options.debug_folder.empty())
      debug_.emplace(options.debug_folder, options.debug_file_octets_max,
                     config::debug_selection(options.debug_of));
    if (!options.record_file.empty())
      record_.emplace(options.record_file, description, options.source, options.record_octets_max);
    if (!options.serial_file.empty())
      serial_.emplace(options.serial_file);
    if (!options.pcap_folder.empty())
      captures_.emplace(options.pcap_folder, description, options.pcap_lost);
  }

  void watch(scheduler::trace_recorder& trace) {
    if (debug_ || record_)
      trace.observe_remarks([this](const scheduler::remark& x) {
        if (debug_)
          debug_->write(x);
        if (record_ && x.what != debug_log::selected)
          record_->write(x);
      });
    if (record_)
      trace.messages().observe([this](const message_end& x) { record_->write(x); });
    // Peers, whom one thread at a time executes, are the only ones with tuples.
    if (judge_ != nullptr || teller_)
      trace.watch("peis_peer/", [this](const scheduler::delivery& x) {
        if (judge_ != nullptr)
          tell_tuple(*judge_, x);
        if (teller_)
          teller_->write(x);
      });
    if (debug_ || record_ || serial_)
      trace.observe([this](const scheduler::delivery& x) {
        if (debug_)
          debug_->write(x);
        if (record_)
          record_->write(x);
        if (serial_)
          serial_->write(x);
      });
  }

  [[nodiscard]] bool records() const { return record_.has_value(); }
  void write(const report::run_sample& x) {
    if (record_)
      record_->write(x);
  }

  /// Empty if nobody wants to see frames.
  [[nodiscard]] frame_observer frames() {
    if (!captures_ && !record_)
      return {};
    return [this](const radio::overheard& x) {
      if (captures_)
        captures_->write(x);
      if (record_)
        record_->write(x);
    };
  }

  /// What is not complete.
  [[nodiscard]] std::vector<std::string> finish() {
    std::vector<std::string> failed;
    if (debug_)
      failed.push_back(debug_->finish());
    if (record_)
      failed.push_back(record_->finish());
    if (captures_)
      failed.push_back(captures_->finish());
    if (serial_)
      failed.push_back(serial_->finish());
    std::erase(failed, std::string());
    return failed;
  }

private:
  report::expectations* judge_;
  std::optional<tuple_teller> teller_;
  std::optional<debug_log> debug_;
  std::optional<run_record> record_;
  std::optional<frame_captures> captures_;
  std::optional<serial_recorder> serial_;
};

/// One run from its first event to its last word. Everything in `report` stays what it is until it
/// is known better: a run that breaks off anywhere is not complete.
class one_run {
public:
  one_run(const config::ecology_description& description, const run_options& options,
          run_files& files, report::expectations& judge, report::run_report& report)
      : judge_(judge), files_(files), description_(description), options_(options), report_(report),
        wall_(description.mode == config::run_mode::wall),
        speed_(wall_ && options.speed == 0 ? 1 : options.speed),
        world_(world_options_of(description.mode, speed_, options)),
        lifetime_(world_, description.until), inits_run_(has_init(description)) {
    files.watch(world_.trace());
    if (options.on_hangup)
      hangups_.emplace(world_.loop(), options.on_hangup);
    if (options.handle_signals)
      signals_.emplace(
          world_.loop(), [this](int) { world_.request_stop(); }, !options.on_hangup);
    root_ = world_.spawn(
        "ecology/" + description.name, ecology, description,
        [this](report::run_report x) { take(std::move(x)); }, files.frames(), facts());
    root_.get().attach_functor([this](const caf::error& reason) { on_root_ended(reason); });
    if (options.on_begun)
      options.on_begun(
          {world_.loop(), [this] { world_.request_stop(); },
           [this](const config::fault& x) { apply(x); },
           [this](const config::fault_description& x) { plan_rest(x); },
           [this] { return world_.now(); },
           [this](const std::string& peer, const std::string& key, const std::string& value) {
             return set_tuple_of(peer, key, value);
           }});
  }
  ~one_run() {
    over_ = true;
    signals_.reset(); // before its loop
    hangups_.reset();
    root_ = nullptr; // before its system
    world_.shutdown();
  }

  one_run(const one_run&) = delete;
  one_run& operator=(const one_run&) = delete;

  [[nodiscard]] scheduler::world& world() { return world_; }
  [[nodiscard]] const root_actor& root() const { return root_; }
  [[nodiscard]] const std::string& ended_early() const { return ended_early_; }

  [[nodiscard]] report::run_report report_so_far() {
    static_cast<void>(world_.drain());
    auto& state = root_state();
    const collected_answers kept = state;
    const auto before = report_;
    timers_ = world_.stats().waiting;
    tell(collect_report{});
    tell(deliver_report{});
    measure();
    static_cast<collected_answers&>(state) = kept;
    return std::exchange(report_, before);
  }

  void plan(const config::fault_description& x, const std::vector<duration>& times) {
    auto& faults = root_state().description.faults;
    faults.push_back(x);
    const apply_fault message{static_cast<std::uint32_t>(faults.size() - 1)};
    for (const auto at : times)
      scheduler::post_at(root_, instant(at), message);
    if (std::holds_alternative<config::battery_end_fault>(x.what))
      for (const auto at : times)
        lifetime_.expect_end(instant(at));
  }

  void run_until(instant end) { static_cast<void>(run_to(end)); }

  void perform() {
    const auto end = std::max(instant(description_.length), world_.now());
    const auto cause = run_to(end);
    lifetime_.close();
    timers_ = world_.stats().waiting;
    tell(collect_report{});
    world_.trace().messages().finish();
    tell(deliver_report{});
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

  /// What the run has been, however it ended.
  void measure() {
    if (!report_.complete)
      report_.simulated = world_.now().time_since_epoch();
    report_.events = world_.trace().events();
    report_.trace_hash = to_hex(world_.trace().hash());
    if (report_.complete)
      for (auto& each : report::check_timers(report_, timers_))
        report_.violations.push_back(std::move(each));
  }

private:
  /// Stops to look whether motes are heard and know the time, and around, where somebody wants to
  /// see that.
  scheduler::stop_cause run_to(instant end) {
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

  void note_standstill(duration length) {
    const auto text = std::to_string(length / 1s) + " s";
    post(root_, notable_event{"ecology", "this process or its computer was suspended for " + text +
                                             ": other processes may have considered it dead"});
  }

  [[nodiscard]] instant next_multiple(duration every) {
    return instant((world_.now().time_since_epoch() / every + 1) * every);
  }

  [[nodiscard]] duration look_every() const {
    if (options_.look_every > 0s && options_.on_sample)
      return options_.look_every;
    constexpr int samples = 100; // of a run that is only recorded
    return files_.records() ? std::max(description_.length / samples, duration(1s)) : 0s;
  }

  void look() {
    const auto sample = look_at(root_state(), world_.now());
    files_.write(sample);
    if (options_.on_sample)
      options_.on_sample(sample);
  }

  [[nodiscard]] ecology_state& root_state() {
    return static_cast<scheduler::shell<ecology_state, root_interface>&>(root_.get()).state;
  }

  void apply(const config::fault& x) {
    if (over_)
      return;
    auto& faults = root_state().description.faults;
    faults.push_back({world_.now().time_since_epoch(), x});
    post(root_, apply_fault{static_cast<std::uint32_t>(faults.size() - 1)});
  }

  void plan_rest(const config::fault_description& x) {
    if (over_)
      return;
    auto times = report::times_of(x, 0, description_.seed, description_.length);
    std::erase_if(times, [this](duration at) { return instant(at) <= world_.now(); });
    plan(x, times);
  }

  bool set_tuple_of(const std::string& peer, const std::string& key, const std::string& value) {
    if (over_)
      return false;
    const auto& peers = root_state().peers;
    const auto found = peers.find(peer);
    if (found == peers.end() || !found->second.handle)
      return false;
    if (found->second.handle.get().has_ended()) // nobody has heard of that yet
      return false;
    post(found->second.handle, set_tuple{key, payload(to_bytes(value)), true});
    return true;
  }

  void take(report::run_report x) {
    x.interrupted = report_.interrupted;
    report_ = std::move(x);
    report_.mode = mode_name(description_);
  }

  void break_off(const std::string& why) {
    report_.complete = false;
    report_.reason = why;
  }

  template <class Message>
  void tell(Message x) {
    post(root_, x);
    if (!world_.drain() && ended_early_.empty())
      ended_early_ = "actors kept sending each other messages without end";
  }

  /// Peers say goodbye, and inits stop their components.
  void leave() {
    tell(end_run{});
    for (const auto latest = world_.now() + stop_time_max; inits_run_ && world_.now() < latest;)
      static_cast<void>(world_.run_for(50ms));
    if (wall_ && has_real_links(description_))
      static_cast<void>(world_.run_for(goodbye_time));
  }

  void on_root_ended(const caf::error& reason) {
    if (over_)
      return;
    inits_run_ = false; // with it ends whoever could tell
    end_early("the supervisor of the ecology ended: " + text_of(reason));
    report_.complete = false;
  }

  void end_early(const std::string& why) {
    if (ended_early_.empty())
      ended_early_ = why;
    world_.request_stop();
  }

  /// In wall time peers may meet those of other processes, and must be told apart from them.
  process_facts facts() {
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

  report::expectations& judge_;
  run_files& files_;
  const config::ecology_description& description_;
  const run_options& options_;
  report::run_report& report_;
  const bool wall_;
  const double speed_;
  std::string ended_early_; ///< why; empty while nothing is wrong
  bool over_ = false;
  std::uint64_t timers_ = 0; ///< that waited at the end
  scheduler::world world_;
  lifetime lifetime_;
  bool inits_run_;
  std::optional<io::signal_watch> signals_;
  std::optional<io::hangup_watch> hangups_;
  root_actor root_;
};

/// What is known before anything has run: nothing that anybody could take for a good end.
report::run_report empty_report(const config::ecology_description& x) {
  report::run_report report;
  report.ecology = x.name;
  report.seed = x.seed;
  report.mode = mode_name(x);
  report.reason = "the run was aborted";
  return report;
}

/// `rubicon run home.toml --seed 7 --for 20s --record run.rec && rubicon explain run.rec --lost`
std::string command_for(const report::expectation_report& x, const report::run_report& report,
                        const run_options& options, const std::string& host) {
  const auto file = options.source.file.empty() ? "FILE" : shell_word(options.source.file);
  const auto& given = options.source.options;
  auto text = "rubicon run " + file;
  if (!given.empty())
    text += ' ' + given;
  else if (!host.empty())
    text += " --host " + shell_word(host);
  text += " --seed " + std::to_string(report.seed);
  if (x.at < instant{} + report.simulated)
    text += " --for " + std::to_string(x.at.time_since_epoch() / 1ms + 1) + "ms";
  else if (options.length)
    text += " --for " + std::to_string(*options.length / 1ms) + "ms";
  if (x.explain.empty())
    return text + " --log info";
  text += " --record run.rec && rubicon explain run.rec";
  for (const auto& word : x.explain)
    text += ' ' + shell_word(word);
  return text;
}

void judge_run(report::run_report& report, const report::expectations& judge,
               const run_options& options, const std::string& host) {
  report.expectations = judge.judge(report);
  for (auto& each : report.expectations) {
    if (each.outcome != report::expectation_report::verdict::unmet)
      continue;
    each.command = command_for(each, report, options, host);
    report.violations.push_back(report::violation_of(each));
  }
}

} // namespace

/// Members are in the order in which they need each other.
class ecology_run::parts {
public:
  parts(config::ecology_description file, run_options options)
      : options_(std::move(options)), description_(overridden(std::move(file), options_)),
        judge_(description_.expectations, description_.length),
        files_(description_, options_, judge_), report_(empty_report(description_)) {
    attempt([this] { run_.emplace(description_, options_, files_, judge_, report_); });
    for (auto& island : description_.islands)
      island.motes = std::vector<config::mote_description>(); // the ecology's actor has them
  }

  one_run& run() {
    if (!run_)
      throw std::runtime_error(report_.reason);
    if (!run_->ended_early().empty())
      throw std::runtime_error(run_->ended_early());
    return *run_;
  }

  report::run_report finish() {
    if (run_)
      attempt([this] {
        run_->perform();
        run_->measure();
      });
    run_.reset();
    const auto at_end = instant() + report_.simulated;
    for (auto& missing : files_.finish())
      report_.violations.push_back({at_end, report::requests_are_met, std::move(missing)});
    if (!report_.complete)
      report_.violations.push_back({at_end, report::run_is_complete, report_.reason});
    judge_run(report_, judge_, options_, description_.part ? description_.part->host : "");
    report_.wall_s = std::chrono::duration<double>(steady::now() - started_).count();
    return std::move(report_);
  }

private:
  /// Does it, whatever happens.
  template <class Action>
  void attempt(Action action) {
    const auto break_off = [this](const std::string& why) {
      report_.complete = false;
      report_.reason = why;
    };
    try {
      action();
    } catch (const std::bad_alloc&) {
      break_off("out of memory");
    } catch (const std::exception& error) {
      break_off(error.what());
    }
  }

  const steady::time_point started_ = steady::now();
  const run_options options_;
  config::ecology_description description_; ///< once the run has begun without its motes
  report::expectations judge_;
  run_files files_;
  report::run_report report_;
  std::optional<one_run> run_;
};

ecology_run::ecology_run(config::ecology_description description, run_options options)
    : parts_(std::make_unique<parts>(std::move(description), std::move(options))) {}
ecology_run::~ecology_run() = default;
ecology_run::ecology_run(ecology_run&&) noexcept = default;
ecology_run& ecology_run::operator=(ecology_run&&) noexcept = default;

scheduler::world& ecology_run::world() {
  return parts_->run().world();
}

const root_actor& ecology_run::root() {
  return parts_->run().root();
}

void ecology_run::plan(const config::fault_description& x, const std::vector<duration>& times) {
  parts_->run().plan(x, times);
}

void ecology_run::run_until(instant end) {
  parts_->run().run_until(end);
}

report::run_report ecology_run::report_so_far() {
  return parts_->run().report_so_far();
}

report::run_report ecology_run::finish() {
  return parts_->finish();
}

report::run_report run_ecology(config::ecology_description file, const run_options& options) {
  return ecology_run(std::move(file), options).finish();
}

} // namespace rubicon
