// Attacks a running ecology over TCP on this computer, and measures what becomes of it: one line a
// play. Or reads the report of the run that was attacked.
#include <cstdio>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hostile/control_loop.hpp"
#include "hostile/driver/options.hpp"
#include "hostile/driver/report.hpp"
#include "hostile/victim.hpp"

namespace {

using namespace rubicon;
using namespace rubicon::hostile;

// What must hold, whatever the attack.
constexpr std::uint64_t growth_max = 200'000'000;     ///< octets of memory above idle
constexpr std::uint64_t left_max = 30'000'000;        ///< of these, once the attack is over
constexpr std::uint64_t left_by_all_max = 60'000'000; ///< the same after several attacks
constexpr double p99_max_ms = 250;
constexpr duration newcomer_patience = 10s;
constexpr duration crowd_least = 6s;  ///< how long a crowd stays: a newcomer must get in meanwhile
constexpr duration back_within = 60s; ///< memory, after an attack

/// What was seen of one play.
struct observation {
  play_result play;
  std::uint64_t idle = 0;
  std::uint64_t peak = 0;
  std::uint64_t after = 0;
  double settled_s = 0; ///< after the end of the play
  bool alive = true;
  loop_figures during;
  bool loop_back = true; ///< values come back when the play is over
  std::optional<double> newcomer;
  bool newcomer_came = false;
};

class measurement {
public:
  explicit measurement(const options& x) : options_(x) {
    if (x.loop) {
      loop_ = std::make_unique<control_loop>(x.play.whom);
      if (!loop_->await_value(20s))
        std::fputs("hostile_peer: no value comes back from the ecology\n", stderr);
    }
    if (x.victim)
      memory_ = std::make_unique<memory_watch>(*x.victim);
    idle_ = memory_ ? memory_->now() : 0;
  }

  [[nodiscard]] bool victim_alive() const { return !memory_ || memory_->alive(); }

  /// @returns whether the limits were kept
  bool play(const attack_kind& kind, std::size_t links) {
    const auto seen = observe(kind, links);
    const auto wrong = faults(seen);
    if (options_.table)
      print_row(kind, links, seen, wrong);
    else
      print(kind, links, seen, wrong);
    return wrong.empty();
  }

  /// In the end memory is back, and every request of the honest peer has had an outcome.
  bool conclude() {
    bool good = true;
    if (memory_) {
      const bool one = options_.attacks.size() * options_.links.size() == 1;
      const auto most = one ? left_max : left_by_all_max;
      const auto took = seconds(await_memory(back_within, most));
      good = victim_alive() && memory_->now() <= idle_ + most;
      if (!options_.table)
        std::printf("memory    %.0f MB after %.1f s  %s\n",
                    static_cast<double>(memory_->now()) / 1e6, took,
                    good ? "good" : "BAD: memory kept");
    }
    return await_requests() && good;
  }

private:
  bool await_requests() {
    if (!loop_)
      return true;
    loop_->stop_requests();
    const auto until = steady::now() + 20s;
    while (loop_->requests().open() > 0 && steady::now() < until)
      std::this_thread::sleep_for(100ms);
    const auto x = loop_->requests();
    if (options_.table)
      return x.open() == 0 && x.made > 0;
    std::printf("requests  %llu made, %llu done, %llu failed, %llu without outcome",
                static_cast<unsigned long long>(x.made), static_cast<unsigned long long>(x.done),
                static_cast<unsigned long long>(x.failed),
                static_cast<unsigned long long>(x.open()));
    for (const auto& [cause, count] : x.causes)
      std::printf(", %s %llu", cause.c_str(), static_cast<unsigned long long>(count));
    const bool good = x.open() == 0 && x.made > 0;
    std::printf("  %s\n", good ? "good" : "BAD: requests without outcome");
    return good;
  }

  /// @returns how long that took
  duration await_memory(duration patience, std::uint64_t most = left_max) const {
    const auto start = steady::now();
    while (victim_alive() && memory_->now() > idle_ + most && steady::now() - start < patience)
      std::this_thread::sleep_for(50ms);
    return steady::now() - start;
  }

  observation observe(const attack_kind& kind, std::size_t links) {
    observation x;
    x.idle = idle_;
    if (memory_)
      static_cast<void>(memory_->take_peak());
    if (loop_)
      loop_->begin();
    auto config = options_.play;
    config.links = links;
    if (kind.crowd && links > 1)
      config.length = std::max(config.length, crowd_least);
    std::future<std::optional<double>> newcomer;
    if (loop_) {
      const auto wait = config.length / 3;
      const auto patience = kind.crowd && links > 1
                                ? std::min(newcomer_patience, config.length - wait)
                                : newcomer_patience;
      newcomer = std::async(std::launch::async, [whom = config.whom, wait, patience] {
        std::this_thread::sleep_for(wait);
        return newcomer_s(whom, patience);
      });
    }
    x.play = player(kind, config).play();
    if (loop_)
      x.during = loop_->figures();
    settle(x);
    if (newcomer.valid()) {
      x.newcomer = newcomer.get();
      x.newcomer_came = true;
    }
    return x;
  }

  void settle(observation& x) {
    if (loop_)
      x.loop_back = loop_->await_value(5s) && loop_->await_value(1s);
    if (!memory_)
      return;
    x.settled_s = seconds(await_memory(options_.settle));
    x.peak = memory_->take_peak();
    x.after = memory_->now();
    x.alive = memory_->alive();
  }

  [[nodiscard]] std::string faults(const observation& x) const {
    std::vector<std::string> all;
    if (!x.alive)
      all.emplace_back("DEAD");
    if (memory_ && x.peak > x.idle + growth_max)
      all.emplace_back("memory");
    if (options_.settle >= back_within && x.alive && x.after > x.idle + left_max)
      all.emplace_back("memory kept");
    if (loop_ && (!x.loop_back || (options_.timed && x.during.values == 0)))
      all.emplace_back("no loop");
    else if (loop_ && options_.timed && x.during.p99_ms > p99_max_ms)
      all.emplace_back("slow loop");
    if (x.newcomer_came && !x.newcomer)
      all.emplace_back("newcomer kept out");
    std::string text;
    for (const auto& fault : all)
      text += (text.empty() ? "" : ", ") + fault;
    return text;
  }

  void print(const attack_kind& kind, std::size_t links, const observation& x,
             const std::string& wrong) const {
    const auto mega = [](std::uint64_t octets) { return static_cast<double>(octets) / 1e6; };
    const auto took = seconds(x.play.took);
    std::printf("%-20s links %3zu  said %8llu (%6.0f/s, %5.1f MB/s)  cut %5llu",
                std::string(kind.name).c_str(), links,
                static_cast<unsigned long long>(x.play.counts.packages),
                static_cast<double>(x.play.counts.packages) / took,
                mega(x.play.counts.octets) / took,
                static_cast<unsigned long long>(x.play.counts.cut));
    if (memory_)
      std::printf("  MB %4.0f %5.0f %5.0f in %4.1f s", mega(x.idle), mega(x.peak), mega(x.after),
                  x.settled_s);
    if (loop_)
      std::printf("  loop ms %6.1f %7.1f %7.1f of %zu, %zu missing", x.during.p50_ms,
                  x.during.p99_ms, x.during.longest_ms, x.during.values, x.during.missing);
    if (x.newcomer_came && x.newcomer)
      std::printf("  newcomer %.1f s", *x.newcomer);
    std::printf("  %s\n", wrong.empty() ? "good" : ("BAD: " + wrong).c_str());
    std::fflush(stdout);
  }

  /// All but the last cell, which tells of the report.
  static void print_row(const attack_kind& kind, std::size_t links, const observation& x,
                        const std::string& wrong) {
    const auto mega = [](std::uint64_t octets) { return static_cast<double>(octets) / 1e6; };
    std::printf("| %s | %zu | %.0f | %.0f, %.0f, %.0f | %.0f s | %.1f, %.0f | %s | ",
                std::string(kind.name).c_str(), links,
                static_cast<double>(x.play.counts.packages) / seconds(x.play.took), mega(x.idle),
                mega(x.peak), mega(x.after), x.settled_s, x.during.p50_ms, x.during.p99_ms,
                wrong.empty() ? "kept" : wrong.c_str());
    std::fflush(stdout);
  }

  options options_;
  std::unique_ptr<control_loop> loop_;
  std::unique_ptr<memory_watch> memory_;
  std::uint64_t idle_ = 0;
};

int list() {
  for (const auto& x : all_attacks())
    std::printf("%-20s %s\n", std::string(x.name).c_str(), std::string(x.what).c_str());
  return 0;
}

} // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 1 && words.front() == "--list")
    return list();
  if (words.size() >= 3 && words.front() == "--report")
    return tell_report(words[1], words[2], words.back() == "--table") ? 0 : 1;
  options x;
  if (const auto wrong = parse(words, x)) {
    std::fprintf(stderr, "hostile_peer: %s\n%s", wrong->c_str(), usage);
    return 2;
  }
  measurement all(x);
  bool good = true;
  for (const auto* kind : x.attacks) {
    for (const auto links : x.links)
      good = all.victim_alive() && all.play(*kind, crowd_of(*kind, links)) && good;
  }
  good = all.conclude() && good;
  return good || !x.check ? 0 : 1;
}
