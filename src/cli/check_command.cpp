#include "cli/check_command.hpp"

#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "config/listing.hpp"
#include "config/plan/placement.hpp"
#include "config/run/reload.hpp"
#include "config/run/summary.hpp"
#include "config/summary_parts.hpp"
#include "core/text/printable.hpp"

namespace rubicon::cli {

namespace {

/// A line for each change, those that apply at once first.
std::string text_of(const config::reloaded& x, config::ecology_description described) {
  described.faults.clear();
  for (const auto& each : x.changes)
    described.faults.push_back({.at = {}, .what = config::fault(each)});
  described.faults.insert(described.faults.end(), x.plan.begin(), x.plan.end());
  std::string text;
  const auto rows = config::fault_rows(described);
  for (std::size_t i = 0; i < rows.size(); ++i)
    text += (i < x.changes.size() ? "at once" : rows[i].front()) + "  " +
            config::fault_text(rows[i]) + '\n';
  return text.empty() ? "nothing changes\n" : text;
}

exit_status show_changes(const check_command& x) {
  const auto old = load_or_complain(x.changes_from, x.instead, x.known);
  auto file = old ? load_or_complain(x.file, x.instead, x.known) : std::nullopt;
  if (!file)
    return exit_status::refused;
  config::followed_file followed(old->text, name_of_file(x.file), x.instead, x.known);
  const auto found = followed.read(file->text, -1ns); // all that is planned is still to come
  complain({std::nullopt, found.refused}, name_of_file(x.file));
  const bool printed = print(stdout, text_of(found, std::move(file->ecology)));
  return printed && found.refused.empty() ? exit_status::good : exit_status::refused;
}

} // namespace

exit_status perform(const check_command& x) {
  if (!x.changes_from.empty())
    return show_changes(x);
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
