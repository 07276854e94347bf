#include "cli/print/swarm_output.hpp"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "cli/print/progress_bar.hpp"
#include "config/run/variation.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"

namespace rubicon::cli {

swarm_output::swarm_output(const swarm_command& x, const swarm& seeds, swarm_words words)
    : command_(x), seeds_(seeds), words_(std::move(words)) {
  if (x.page_file.empty())
    return;
  errno = 0;
  page_.open(x.page_file, std::ios::binary | std::ios::trunc);
  if (!page_)
    throw std::runtime_error("cannot write " + x.page_file + ": " +
                             std::generic_category().message(errno != 0 ? errno : EIO));
}

void swarm_output::add(const std::vector<seed_outcome>& due) {
  for (const auto& x : due) {
    if (!command_.page_file.empty()) {
      figures_.add(x.seed, x.figures);
      if (!x.violations.empty() && failed_.size() < swarm::listed_max)
        failed_.push_back({x.seed, x.violations, replay_command(words_, x.seed),
                           to_text(config::variation_of(words_.text, words_.settings, x.seed))});
    }
    if (command_.json)
      json_.add(words_, x);
    else if (!x.violations.empty()) {
      erase_progress();
      is_read_ = is_read_ && print(stdout, violation_lines(words_, x));
    }
  }
}

duration swarm_output::drawn_every() const {
  return errors_.is_terminal ? progress_bar::redrawn_every : duration(1min);
}

void swarm_output::draw_progress() {
  const auto now = elapsed();
  if (!errors_.is_terminal || now < progress_bar::shown_after ||
      (drawn_at_ && now < *drawn_at_ + progress_bar::redrawn_every))
    return;
  drawn_at_ = now;
  const auto room = errors_.width - std::min<std::size_t>(errors_.width, 1);
  static_cast<void>(print(stderr, std::string(erase_line) + swarm_progress(seeds_, now, room)));
}

void swarm_output::erase_progress() {
  if (std::exchange(drawn_at_, std::nullopt))
    static_cast<void>(print(stderr, erase_line));
}

exit_status swarm_output::finish(bool interrupted) {
  erase_progress();
  const auto text = command_.json ? json_.text(seeds_, words_, elapsed(), interrupted)
                                  : swarm_summary(seeds_, words_, elapsed(), interrupted);
  if (!is_read_ || !print(stdout, text) || !write_page(interrupted))
    return exit_status::refused;
  if (interrupted)
    return exit_status::interrupted;
  return seeds_.so_far().failures == 0 && !seeds_.misses_situations() ? exit_status::good
                                                                      : exit_status::violated;
}

bool swarm_output::write_page(bool interrupted) {
  if (command_.page_file.empty())
    return true;
  const auto& totals = seeds_.so_far();
  page::swarm_page x{words_.file,       {},       totals.runs, totals.failures,
                     totals.violations, figures_, failed_};
  x.seeds = std::to_string(seeds_.seeds().first) + ".." + std::to_string(seeds_.seeds().last);
  x.command = "rubicon swarm " + shell_word(words_.file) + setting_options(words_) + " --seeds " +
              x.seeds + (words_.length.empty() ? "" : " --for " + shell_word(words_.length));
  x.real_s = seconds(elapsed());
  x.events = totals.events;
  x.interrupted = interrupted;
  for (const auto& each : totals.situations)
    x.situations.push_back({each.name, each.runs, each.first_seed});
  x.faults = runs_with_faults(seeds_, words_, interrupted);
  page_ << page::html_of(x);
  if (page_.flush())
    return true;
  static_cast<void>(print(stderr, printable(command_.page_file) + " is not complete\n"));
  return false;
}

} // namespace rubicon::cli
