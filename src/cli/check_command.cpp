#include "cli/check_command.hpp"

#include "cli/console.hpp"
#include "cli/ecology_file.hpp"
#include "config/doubts.hpp"
#include "config/listing.hpp"
#include "config/summary.hpp"
#include "core/printable.hpp"

namespace rubicon::cli {

exit_status perform(const check_command& x) {
  const auto file = load_or_complain(x.file, x.instead, x.known);
  if (!file)
    return exit_status::refused;
  const auto& ecology = file->ecology;
  std::string warnings;
  for (auto each : file->doubts) {
    each.message.insert(0, "warning: ");
    warnings += to_string(each) + '\n';
  }
  for (const auto& each : config::doubts(ecology))
    warnings += printable(x.file + ": warning: " + each) + '\n';
  static_cast<void>(print(stderr, warnings)); // nobody reads it, nobody misses it
  const auto text = x.list ? config::listing(ecology) : config::summary(ecology);
  return print(stdout, text) ? exit_status::good : exit_status::refused;
}

} // namespace rubicon::cli
