#include "cli/check_command.hpp"

#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "config/listing.hpp"
#include "config/plan/placement.hpp"
#include "config/run/summary.hpp"
#include "core/text/printable.hpp"

namespace rubicon::cli {

exit_status perform(const check_command& x) {
  auto file = load_or_complain(x.file, x.instead, x.known);
  if (!file)
    return exit_status::refused;
  const auto& ecology = file->ecology;
  for (const auto& each : config::placement_problems(ecology))
    file->warnings.push_back({x.file, 0, 0, printable("on several hosts it cannot run: " + each)});
  if (x.is_strict && !file->warnings.empty()) {
    complain({std::nullopt, file->warnings}, x.file);
    return exit_status::refused;
  }
  warn(*file);
  const auto text = x.list ? config::listing(ecology) : config::summary(ecology);
  return print(stdout, text) ? exit_status::good : exit_status::refused;
}

} // namespace rubicon::cli
