#include "cli/run/viewed_run.hpp"

#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "cli/chain.hpp"
#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "view/ecology_json.hpp"

namespace rubicon::cli {

namespace {

std::string mode_of(const run_command& x, const config::ecology_description& ecology) {
  return x.options.mode.value_or(ecology.mode) == config::run_mode::wall ? "wall" : "virtual";
}

/// The picture under the map; empty: none.
std::string floor_plan_of(const std::string& file, const config::ecology_description& x) {
  if (!x.plan || file == standard_input)
    return {};
  return (std::filesystem::path(file).parent_path() / x.plan->picture).string();
}

/// Who has tuples: gateways and peers.
std::set<std::string> owners_of(const config::ecology_description& x) {
  std::set<std::string> names;
  for (const auto& island : x.islands) {
    names.insert(island.gateway_name);
    for (const auto& alias : island.aliases)
      names.insert(alias.name);
  }
  for (const auto& peer : x.peers)
    names.insert(peer.name);
  return names;
}

/// What the page may do to the run by hand, if it may.
std::optional<manual_control> manual_control_of(const run_command& x,
                                                const config::ecology_description& ecology) {
  if (!x.watch.control)
    return std::nullopt;
  auto packed = deploy::pack(x.file, x.instead, x.options.length, x.known);
  return std::optional<manual_control>(std::in_place, std::move(packed.what), x.known,
                                       owners_of(ecology), x.watch.control_kernel);
}

/// Whether a record costs nothing that anybody would notice: time passes slowly, for few.
bool has_time_for_record(const run_command& x, const config::ecology_description& ecology) {
  constexpr double speed_max = 10;
  constexpr std::size_t motes_max = 500;
  const bool is_wall = x.options.mode.value_or(ecology.mode) == config::run_mode::wall;
  const auto speed = is_wall && x.options.speed == 0 ? 1 : x.options.speed;
  std::size_t motes = 0;
  for (const auto& island : ecology.islands)
    motes += island.motes.size();
  return speed > 0 && speed <= speed_max && motes <= motes_max;
}

} // namespace

void viewed_run::own_record::attach(run_options& options) {
  try {
    folder_.emplace("rubicon");
  } catch (const std::system_error&) {
    return;
  }
  options.record_file = folder_->path() / "run.rec";
  options.record_octets_max = live_page::own_record_octets_max;
}

void viewed_run::own_record::read_by(live_page& page) {
  if (folder_)
    page.read_on(folder_->path() / "run.rec", /*is_own=*/true);
  folder_.reset();
}

viewed_run::viewed_run(const run_command& x, const config::ecology_description& ecology,
                       const std::string& command)
    : record_(x.options.record_file), manual_(manual_control_of(x, ecology)),
      keeps_own_(record_.empty() && has_time_for_record(x, ecology)),
      page_(*x.watch.view, view::ecology_json(ecology),
            {.file = x.file,
             .command = command,
             .controls = manual_.has_value(),
             .messages = keeps_own_ || !record_.empty()},
            mode_of(x, ecology), floor_plan_of(x.file, ecology),
            manual_ ? manual_->controls() : nullptr) {}

void viewed_run::attach(run_options& options, const config::ecology_description& ecology) {
  page_.attach(options, ecology);
  if (keeps_own_)
    own_.attach(options);
  chain(options.on_begun, [this](const run_control& x) {
    if (!record_.empty())
      page_.read_on(record_, /*is_own=*/false);
    own_.read_by(page_);
    performer_ = {[run = x](const std::string&, const config::fault& fault) { run.apply(fault); },
                  x.set_tuple};
  });
  if (manual_)
    chain(options.progress, [this](const run_progress& x) {
      for (const auto& each : manual_->perform(performer_, x.reached))
        page_.report_action(x.reached, each);
    });
}

void viewed_run::finish(const report::run_report& report) {
  if (manual_)
    manual_->end();
  page_.finish(report);
  if (manual_)
    static_cast<void>(print(stderr, manual_->repeated()));
  page_.stay();
}

} // namespace rubicon::cli
