#include "cli/hosts/hosted_seeds.hpp"

#include <algorithm>
#include <csignal>
#include <thread>
#include <utility>
#include <variant>

#include "cli/child_process.hpp"
#include "cli/own_binary.hpp"
#include "cli/run/bundle_file.hpp"
#include "cli/swarm.hpp"

namespace rubicon::cli {

namespace {

/// Of the results in one answer, roughly: the others come with the next one.
constexpr std::size_t results_octets_max = std::size_t{64} << 20;

/// Nobody has asked for so long: who has given the seeds is gone.
constexpr duration forgotten_after = 1min;

} // namespace

hosted_seeds::hosted_seeds(io::loop& loop, const hosting& with)
    : loop_(loop), with_(with), jobs_(std::max(1U, std::thread::hardware_concurrency())) {}

hosted_seeds::~hosted_seeds() = default;

std::filesystem::path hosted_seeds::file() const {
  return with_.folder / (with_.host + "-swarm.bundle");
}

deploy::verdict hosted_seeds::offer(const deploy::offer_seeds& x) {
  deploy::verdict out;
  config::overrides instead;
  instead.mode = config::run_mode::virtual_time;
  const auto loaded = deploy::load(x.what, instead, with_.known);
  for (const auto& each : loaded.problems)
    out.problems.push_back(to_string(each));
  if (loaded.ecology)
    if (auto why = deploy::firmware_refusal(*loaded.ecology, with_.access); !why.empty())
      out.problems.push_back(std::move(why));
  if (!out.problems.empty())
    return out;
  experiment_.reset(); // the file is read by its runs
  if (auto why = write_bundle(file().string(), x.what); !why.empty()) {
    out.problems.push_back(std::move(why));
    return out;
  }
  experiment_.emplace();
  experiment_->id = x.experiment;
  experiment_->timeout = x.timeout;
  experiment_->asked = steady::now();
  return out;
}

deploy::seeds_news hosted_seeds::run(const deploy::run_seeds& x) {
  deploy::seeds_news out;
  if (!experiment_ || experiment_->id != x.experiment) {
    out.problems.emplace_back("it no longer has the files of this experiment");
    return out;
  }
  auto& all = *experiment_;
  all.asked = steady::now();
  if (x.ends) {
    experiment_.reset();
    return out;
  }
  while (!all.results.empty() && all.results.front().number <= x.after)
    all.results.pop_front();
  if (all.waiting.size() + x.seeds.size() > seeds_max) {
    out.problems.emplace_back("it has too many seeds already");
    return out;
  }
  all.waiting.insert(all.waiting.end(), x.seeds.begin(), x.seeds.end());
  start_some();
  out.upto = all.last_number;
  std::size_t octets = 0;
  for (const auto& each : all.results) {
    octets += each.result.out.size() + each.result.err.size();
    if (octets > results_octets_max && !out.results.empty())
      break;
    out.results.push_back(each.result);
    out.upto = each.number;
  }
  out.jobs = jobs_;
  return out;
}

void hosted_seeds::start_some() {
  auto& all = *experiment_;
  while (all.runs.size() < jobs_ && !all.waiting.empty()) {
    const auto seed = all.waiting.front();
    all.waiting.pop_front();
    start(seed);
  }
}

void hosted_seeds::start(std::uint64_t seed) {
  auto& x = experiment_->runs.emplace_back();
  x.result.seed = seed;
  x.began = steady::now();
  io::spawn_request what;
  what.program = own_binary;
  what.words = run_words(file().string(), seed);
  what.words.emplace_back("--bundled");
  auto begun = io::process::start(
      loop_, std::move(what),
      {[this, &x](io::process::output from, byte_view octets) { take_output(x, from, octets); },
       [this, &x](io::process_end how) { on_end(x, how); }});
  if (auto* why = std::get_if<std::string>(&begun)) {
    x.result.status = -1;
    x.result.err = std::move(*why);
    finish(x);
  } else {
    x.process.emplace(std::get<io::process>(std::move(begun)));
  }
}

void hosted_seeds::take_output(seed_run& x, io::process::output from, byte_view octets) {
  const bool is_report = from == io::process::output::out;
  auto& text = is_report ? x.result.out : x.result.err;
  text.append(octets.begin(), octets.end());
  if (is_report && text.size() > child_process::out_octets_max) {
    x.result.overlong = true;
    text.clear();
    x.process->signal(SIGKILL);
  }
  if (!is_report && text.size() > child_process::err_octets_max)
    text.erase(0, text.size() - child_process::err_octets_max);
}

void hosted_seeds::on_end(seed_run& x, io::process_end how) {
  x.process.reset();
  x.result.status = how.status;
  x.result.signal = how.signal;
  finish(x);
  start_some();
}

void hosted_seeds::finish(seed_run& x) {
  auto& all = *experiment_;
  x.result.real = x.result.overran ? all.timeout : duration(steady::now() - x.began);
  all.results.push_back({++all.last_number, std::move(x.result)});
  all.runs.remove_if([&x](const seed_run& each) { return &each == &x; });
}

void hosted_seeds::on_time() {
  if (!experiment_)
    return;
  if (steady::now() - experiment_->asked > forgotten_after) {
    experiment_.reset();
    return;
  }
  for (auto& each : experiment_->runs)
    if (!each.result.overran && steady::now() - each.began >= experiment_->timeout) {
      each.result.overran = true;
      each.process->signal(SIGKILL);
    }
}

} // namespace rubicon::cli
