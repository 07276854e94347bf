#include "cli/swarm_output.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "cli/progress_bar.hpp"

namespace rubicon::cli {

void swarm_output::tell(const std::vector<seed_outcome>& due) {
  for (const auto& x : due) {
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
  if (!is_read_ || !print(stdout, text))
    return exit_status::refused;
  if (interrupted)
    return exit_status::interrupted;
  return seeds_.so_far().failures == 0 ? exit_status::good : exit_status::violated;
}

} // namespace rubicon::cli
