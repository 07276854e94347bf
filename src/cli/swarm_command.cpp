#include "cli/swarm_command.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <list>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "cli/child_process.hpp"
#include "cli/console.hpp"
#include "cli/ecology_file.hpp"
#include "cli/progress_bar.hpp"
#include "cli/swarm.hpp"
#include "cli/swarm_text.hpp"

namespace rubicon::cli {

namespace {

using steady = std::chrono::steady_clock;

/// This binary, also after the file has been replaced by a newer one.
constexpr const char* own_binary = "/proc/self/exe";

/// SIGINT, SIGTERM and SIGHUP as a descriptor that poll() knows; they end the process again
/// afterwards.
class signal_descriptor {
public:
  signal_descriptor() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    if (struct sigaction how{};
        ::sigaction(SIGHUP, nullptr, &how) == 0 && how.sa_handler != SIG_IGN)
      sigaddset(&signals, SIGHUP);
    static_cast<void>(pthread_sigmask(SIG_BLOCK, &signals, &before_));
    descriptor_ = ::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
    if (descriptor_ == -1)
      throw std::system_error(errno, std::generic_category(), "no signal descriptor");
  }
  ~signal_descriptor() {
    static_cast<void>(take());
    ::close(descriptor_);
    static_cast<void>(pthread_sigmask(SIG_SETMASK, &before_, nullptr));
  }
  signal_descriptor(const signal_descriptor&) = delete;
  signal_descriptor& operator=(const signal_descriptor&) = delete;

  [[nodiscard]] int get() const { return descriptor_; }

  /// Whether a signal came since the last time.
  [[nodiscard]] bool take() const {
    signalfd_siginfo what{};
    return ::read(descriptor_, &what, sizeof what) == sizeof what;
  }

private:
  int descriptor_ = -1;
  sigset_t before_{};
};

struct seed_run {
  std::uint64_t seed = 0;
  steady::time_point started;
  child_process child;
  bool overran = false;
};

/// The runs under way, the terminal and the clock; what they mean is decided in `swarm`.
class swarm_runs {
public:
  swarm_runs(const swarm_command& x, swarm_words words)
      : command_(x), words_(std::move(words)), seeds_(x.seeds) {}

  exit_status run_all() {
    for (start_some(); !runs_.empty() && !stopped() && output_ok_; start_some())
      wait_and_collect();
    runs_.clear(); // kills those that a signal left
    if (stopped())
      tell(seeds_.give_up());
    return finish();
  }

private:
  [[nodiscard]] bool stopped() const { return interrupted_; }
  [[nodiscard]] duration elapsed() const { return steady::now() - started_; }

  void start_some() {
    while (runs_.size() < words_.jobs) {
      const auto seed = seeds_.next();
      if (!seed)
        return;
      std::vector<std::string> words{
          "rubicon", "run",     words_.file, "--seed", std::to_string(*seed), "--json",
          "--mode",  "virtual", "--log",     "off",    "--threads",           "1"};
      if (!words_.length.empty())
        words.insert(words.end(), {"--for", words_.length});
      runs_.push_back({*seed, steady::now(), child_process(own_binary, words)});
    }
  }

  /// Until something happened, a run has had its time, or the progress is to be drawn again.
  [[nodiscard]] int patience_ms() const {
    auto until = steady::time_point::max();
    for (const auto& run : runs_)
      until = std::min(until, run.started + command_.timeout);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - steady::now());
    const auto longest = errors_.is_terminal ? std::chrono::milliseconds(100)
                                             : std::chrono::milliseconds(std::chrono::minutes(1));
    return static_cast<int>(std::clamp(left, std::chrono::milliseconds(0), longest).count());
  }

  void wait_and_collect() {
    std::vector<pollfd> watched{{signals_.get(), POLLIN, 0}};
    for (const auto& run : runs_) {
      for (const auto descriptor : run.child.descriptors())
        watched.push_back({descriptor, POLLIN, 0});
    }
    static_cast<void>(::poll(watched.data(), watched.size(), patience_ms()));
    interrupted_ = interrupted_ || signals_.take();
    for (auto run = runs_.begin(); run != runs_.end() && !stopped();) {
      run->child.read();
      if (!run->overran && steady::now() - run->started >= command_.timeout) {
        run->overran = true;
        run->child.kill();
      }
      if (!run->child.descriptors().empty()) {
        ++run;
        continue;
      }
      collect(*run);
      run = runs_.erase(run);
    }
    draw_progress();
  }

  void collect(seed_run& run) {
    const auto real = run.overran ? command_.timeout : duration(steady::now() - run.started);
    auto outcome = judge(run.seed, run.child.wait(), real, run.overran);
    if (outcome)
      tell(seeds_.ended(*std::move(outcome)));
    else
      interrupted_ = true; // the same Ctrl-C that comes to us
  }

  void tell(const std::vector<seed_outcome>& due) {
    for (const auto& x : due) {
      if (command_.json)
        json_.add(words_, x);
      else if (!x.violations.empty()) {
        erase_progress();
        output_ok_ = output_ok_ && print(stdout, violation_lines(words_, x));
      }
    }
  }

  exit_status finish() {
    erase_progress();
    const auto text = command_.json ? json_.text(seeds_, words_, elapsed(), stopped())
                                    : swarm_summary(seeds_, words_, elapsed(), stopped());
    if (!output_ok_ || !print(stdout, text))
      return exit_status::refused;
    if (stopped())
      return exit_status::interrupted;
    return seeds_.so_far().failures == 0 ? exit_status::good : exit_status::violated;
  }

  void draw_progress() {
    const auto now = elapsed();
    if (!errors_.is_terminal || now < progress_bar::shown_after ||
        (drawn_at_ && now < *drawn_at_ + progress_bar::redrawn_every))
      return;
    drawn_at_ = now;
    const auto room = errors_.width - std::min<std::size_t>(errors_.width, 1);
    static_cast<void>(print(stderr, std::string(erase_line) + swarm_progress(seeds_, now, room)));
  }

  void erase_progress() {
    if (std::exchange(drawn_at_, std::nullopt))
      static_cast<void>(print(stderr, erase_line));
  }

  const swarm_command& command_;
  swarm_words words_;
  swarm seeds_;
  swarm_json json_;
  const console errors_ = console_of(stderr);
  const steady::time_point started_ = steady::now();
  std::optional<duration> drawn_at_;
  bool interrupted_ = false;
  bool output_ok_ = true;
  signal_descriptor signals_;
  std::list<seed_run> runs_; // ends before the signals are let through
};

} // namespace

exit_status perform(const swarm_command& x) {
  config::overrides instead;
  instead.seed = x.seeds.first;
  instead.mode = config::run_mode::virtual_time;
  const auto file = load_or_complain(x.file, instead, x.known);
  if (!file)
    return exit_status::refused;
  swarm_words words{x.file, x.length, x.jobs.value_or(std::thread::hardware_concurrency())};
  words.jobs = std::max<std::uint64_t>(words.jobs, 1);
  words.from_wall = file->ecology.mode == config::run_mode::wall;
  return swarm_runs(x, std::move(words)).run_all();
}

} // namespace rubicon::cli
