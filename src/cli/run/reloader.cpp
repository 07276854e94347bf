#include "cli/run/reloader.hpp"

#include <utility>

#include "cli/print/console.hpp"
#include "report/figures.hpp"

namespace rubicon::cli {

reloader::reloader(const std::string& toml, std::string file, const config::overrides& instead,
                   const config::extensions& known)
    : file_(std::move(file)), followed_(toml, file_, instead, known) {}

void reloader::read() {
  const auto read = config::read_file(file_, config::file_octets_max);
  if (!read.text) {
    say(file_ + ' ' + read.reason + "; nothing changes");
    return;
  }
  const auto found = followed_.read(*read.text, run_->now() - instant{});
  for (const auto& each : found.refused)
    say(to_string(each));
  for (const auto& each : found.changes)
    run_->apply(config::fault(each));
  for (const auto& each : found.plan)
    run_->plan(each);
  say(file_ + " was read again: " + report::counted(found.changes.size(), "change") + ", " +
      std::to_string(found.plan.size()) + " planned, " + std::to_string(found.refused.size()) +
      " refused");
}

} // namespace rubicon::cli
