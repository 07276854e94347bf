#include "cli/print/report_output.hpp"

#include "cli/print/console.hpp"
#include "report/print/report_text.hpp"

namespace rubicon::cli {

exit_status status_of(const report::run_report& x) {
  if (x.interrupted)
    return exit_status::interrupted;
  return x.complete && x.violations.empty() ? exit_status::good : exit_status::violated;
}

exit_status print_report(const report::run_report& x, const report_form& form,
                         const config::label_table& labels, const config::variation& varied) {
  const auto output = console_of(stdout);
  const auto text = form.json ? to_json(x, labels, varied)
                              : to_text(x, {.width = output.width,
                                            .colour = output.colour,
                                            .cuts = output.cuts,
                                            .full = form.full,
                                            .brief = form.brief,
                                            .labels = labels,
                                            .varied = varied});
  return print(stdout, text) ? status_of(x) : exit_status::refused;
}

} // namespace rubicon::cli
