#include "cli/check_command.hpp"

#include "cli/console.hpp"
#include "cli/ecology_file.hpp"
#include "config/summary.hpp"

namespace rubicon::cli {

exit_status perform(const check_command& x) {
  const auto ecology = load_or_complain(x.file, x.instead);
  if (!ecology)
    return exit_status::refused;
  return print(stdout, config::summary(*ecology)) ? exit_status::good : exit_status::refused;
}

} // namespace rubicon::cli
