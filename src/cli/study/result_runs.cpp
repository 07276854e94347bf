#include "cli/study/result_runs.hpp"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "cli/print/progress_bar.hpp"
#include "cli/study/sweep_text.hpp"
#include "cli/swarm.hpp"
#include "core/text/decimal.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

result_runs::result_runs(std::optional<std::uint64_t> jobs, duration timeout)
    : jobs_(std::max<std::uint64_t>(1, jobs.value_or(std::thread::hardware_concurrency()))),
      runs_(timeout) {}

exit_status result_runs::run_all(result_plan& plan) {
  for (start_some(plan); runs_.size() > 0 && !runs_.interrupted(); start_some(plan)) {
    for (const auto& each :
         runs_.wait(errors_.is_terminal ? progress_bar::redrawn_every : duration(1min)))
      collect(plan, each);
    draw_progress(plan);
  }
  runs_.kill_all();
  erase_progress();
  return runs_.interrupted() ? exit_status::interrupted
         : failed_           ? exit_status::failed
                             : exit_status::good;
}

void result_runs::start_some(result_plan& plan) {
  while (runs_.size() < jobs_) {
    auto job = plan.next();
    if (!job)
      return;
    runs_.start(next_, job->words, job->program);
    jobs_in_progress_.emplace(next_++, *std::move(job));
  }
}

void result_runs::collect(result_plan& plan, const child_runs::ended_run& x) {
  if (runs_.interrupted())
    return;
  const auto job = std::move(jobs_in_progress_.extract(x.id).mapped());
  ++ended_;
  std::optional<study::run_result> result;
  if (!x.overran && x.how.signal == 0 && !x.how.overlong)
    result = result_of(x.how.out);
  if (result) {
    result->seed = job.seed;
    result->real_s = seconds(x.real);
    return plan.take(x.id, std::move(result));
  }
  const auto judged = judge(job.seed, x.how, x.real, x.overran);
  if (!judged)
    return runs_.interrupt(); // the same Ctrl-C that comes to us
  failed_ = true;
  erase_progress();
  for (const auto& each : judged->violations)
    say(job.label + ": " + each.detail);
  plan.take(x.id, std::nullopt);
}

void result_runs::draw_progress(const result_plan& plan) {
  const duration now = steady::now() - started_;
  if (!errors_.is_terminal || now < progress_bar::shown_after ||
      (drawn_at_ && now < *drawn_at_ + progress_bar::redrawn_every))
    return;
  drawn_at_ = now;
  const auto room = errors_.width - std::min<std::size_t>(errors_.width, 1);
  static_cast<void>(
      print(stderr, std::string(erase_line) + study_progress(ended_, plan.expected(), now, room)));
}

void result_runs::erase_progress() {
  if (std::exchange(drawn_at_, std::nullopt))
    static_cast<void>(print(stderr, erase_line));
}

std::string study_progress(std::size_t ended, std::size_t expected, duration real,
                           std::size_t width) {
  std::string text = std::to_string(ended) + " of " + std::to_string(expected) + " runs";
  if (ended > 0 && ended <= expected && real > duration::zero()) {
    const double speed = static_cast<double>(ended) / seconds(real);
    const auto left = std::ceil(static_cast<double>(expected - ended) / speed);
    text += "  " + std::to_string(100 * ended / expected) + "%  " + decimal_text(speed, 1) +
            " runs/s  " + decimal_text(left, 0) + " s left";
  }
  return report::cut(text, width);
}

} // namespace rubicon::cli
