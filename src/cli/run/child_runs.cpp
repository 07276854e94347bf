#include "cli/run/child_runs.hpp"

#include <algorithm>

#include <poll.h>

namespace rubicon::cli {

void child_runs::start(std::uint64_t id, const std::vector<std::string>& words,
                       const std::string& program) {
  runs_.push_back({id, steady::now(), child_process(program, words)});
}

int child_runs::patience_ms(duration longest) const {
  auto until = steady::time_point::max();
  for (const auto& each : runs_)
    until = std::min(until, each.started + limit_);
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - steady::now());
  const auto most = std::chrono::floor<std::chrono::milliseconds>(longest);
  return static_cast<int>(std::clamp(left, std::chrono::milliseconds(0), most).count());
}

std::vector<child_runs::ended_run> child_runs::wait(duration longest) {
  std::vector<pollfd> watched{{signals_.get(), POLLIN, 0}};
  for (const auto& each : runs_)
    for (const auto descriptor : each.child.descriptors())
      watched.push_back({descriptor, POLLIN, 0});
  static_cast<void>(::poll(watched.data(), watched.size(), patience_ms(longest)));
  interrupted_ = interrupted_ || signals_.take();
  std::vector<ended_run> ended;
  for (auto each = runs_.begin(); each != runs_.end() && !interrupted_;) {
    each->child.read();
    if (!each->overran && steady::now() - each->started >= limit_) {
      each->overran = true;
      each->child.kill();
    }
    if (!each->child.descriptors().empty()) {
      ++each;
      continue;
    }
    const auto real = each->overran ? limit_ : duration(steady::now() - each->started);
    ended.push_back({each->id, each->child.wait(), real, each->overran});
    each = runs_.erase(each);
  }
  return ended;
}

} // namespace rubicon::cli
