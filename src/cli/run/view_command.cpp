#include "cli/run/view_command.hpp"

#include <filesystem>
#include <memory>
#include <utility>
#include <variant>

#include "cli/print/console.hpp"
#include "cli/record/read_record.hpp"
#include "cli/run/live_page.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"

namespace rubicon::cli {

namespace {

/// The picture under the map, where it was when the run was recorded; empty: none.
std::string floor_plan_of(const explain::traces& x) {
  const auto picture = view::plan_picture(x.ecology);
  if (picture.empty() || x.about.file.empty())
    return {};
  return (std::filesystem::path(x.about.file).parent_path() / picture).string();
}

} // namespace

exit_status perform(const view_command& x) {
  const auto refuse = [](const std::string& why) {
    static_cast<void>(print(stderr, printable(why) + '\n'));
    return exit_status::refused;
  };
  auto found = read_record(x.record);
  if (const auto* why = std::get_if<std::string>(&found))
    return refuse(*why);
  const auto all =
      std::make_shared<const explain::traces>(std::move(std::get<explain::traces>(found)));
  const view::run_facts facts{.file = all->about.file,
                              .command = all->about.file.empty()
                                             ? ""
                                             : "rubicon run " + shell_word(all->about.file) +
                                                   " --seed " + std::to_string(all->about.seed),
                              .controls = false,
                              .messages = true};
  if (view::with_facts(all->ecology, facts, "record").empty())
    return refuse(x.record + ": it lacks the positions of the motes: record the run again");
  live_page page(x.where, all->ecology, facts, "record", floor_plan_of(*all), nullptr, all);
  page.stay();
  return exit_status::good;
}

} // namespace rubicon::cli
