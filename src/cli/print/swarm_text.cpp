#include "cli/print/swarm_text.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "config/run/fault_variation.hpp"
#include "config/run/variation.hpp"
#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"
#include "report/expect/situation.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"
#include "report/print/variation_json.hpp"

namespace rubicon::cli {

namespace {

using nlohmann::ordered_json;
using report::counted;
using report::printable;

/// Of failed seeds on a line that is drawn again and again, and in the summary.
constexpr std::size_t seeds_shown_max = 20;

std::string seed_list(const std::vector<std::uint64_t>& seeds, std::uint64_t all) {
  std::string text;
  const auto shown = std::min(seeds.size(), seeds_shown_max);
  for (std::size_t i = 0; i < shown; ++i)
    text += ' ' + std::to_string(seeds[i]);
  return text + (all > shown ? " …" : "");
}

/// The number of seeds; of all 2^64, one less.
std::uint64_t size_of(seed_range x) {
  const auto steps = x.last - x.first;
  return steps == UINT64_MAX ? steps : steps + 1;
}

std::string speed(double simulated_s, duration real) {
  return report::speed_factor(duration(static_cast<std::int64_t>(simulated_s * 1e9)),
                              seconds(real));
}

ordered_json situations_json(const swarm& x) {
  auto all = ordered_json::array();
  for (const auto& each : x.so_far().situations) {
    all.push_back({{"name", each.name}, {"runs", each.runs}, {"first_seed", nullptr}});
    if (each.first_seed)
      all.back()["first_seed"] = *each.first_seed;
  }
  return all;
}

} // namespace

std::map<std::string, std::uint64_t> runs_with_faults(const swarm& x, const swarm_words& words,
                                                      bool interrupted) {
  std::map<std::string, std::uint64_t> out;
  if (interrupted)
    return out;
  const auto first = x.seeds().first;
  for (const auto& kind : words.fault_kinds)
    for (std::uint64_t i = 0; i < x.so_far().runs; ++i)
      out[kind] += config::leaves_out(first + i, kind) ? 0 : 1;
  return out;
}

std::string setting_options(const swarm_words& x) {
  std::string text;
  for (const auto& each : x.settings)
    text += " --set " + shell_word(each);
  return text;
}

std::string replay_command(const swarm_words& x, std::uint64_t seed) {
  return "rubicon run " + shell_word(x.file) + setting_options(x) + " --seed " +
         std::to_string(seed) + (x.length.empty() ? "" : " --for " + shell_word(x.length)) +
         (x.from_wall ? " --mode virtual" : "");
}

std::string violation_lines(const swarm_words& x, const seed_outcome& outcome) {
  std::string text;
  auto varied = to_text(config::variation_of(x.text, x.settings, outcome.seed));
  if (!varied.empty())
    varied = "  (" + printable(varied) + ')';
  for (const auto& found : outcome.violations)
    text += "seed " + std::to_string(outcome.seed) + varied + "  " + printable(found.invariant) +
            "  " + printable(found.detail) + "  replay: " + replay_command(x, outcome.seed) + '\n';
  return text;
}

std::string swarm_progress(const swarm& x, duration real, std::size_t width) {
  const auto all = size_of(x.seeds());
  const auto done = x.finished();
  const auto share = static_cast<double>(done) / static_cast<double>(all);
  auto text = report::with_thousands(done) + " of " + counted(all, "run") + "  " +
              std::to_string(static_cast<int>(share * 100)) + '%';
  if (done > 0 && done < all)
    text += "  " + report::real_time(seconds(real) * (1 - share) / share) + " left";
  const auto& totals = x.so_far();
  if (totals.failures > 0)
    text += "  " + report::with_thousands(totals.failures) +
            " with violations:" + seed_list(totals.failed_seeds, totals.failures);
  return report::cut(text, width);
}

std::string swarm_summary(const swarm& x, const swarm_words& words, duration real,
                          bool interrupted) {
  const auto& totals = x.so_far();
  auto text = counted(totals.runs, "run") + " in " + report::real_time(seconds(real)) + ", " +
              std::to_string(words.jobs) + " at a time: ";
  text += totals.failures == 0
              ? "no violations"
              : report::with_thousands(totals.failures) +
                    " with violations:" + seed_list(totals.failed_seeds, totals.failures);
  text += '\n';
  for (const auto& [invariant, count] : totals.violations)
    text += "  " + printable(invariant) + ": " + report::with_thousands(count) + '\n';
  for (const auto& each : totals.situations)
    text += "  " + std::string(report::sometimes) + printable(each.name) + ": " +
            (each.first_seed
                 ? report::with_thousands(each.runs) + " of " + counted(totals.runs, "run") +
                       ", first seed " + std::to_string(*each.first_seed)
                 : std::string("NEVER reached")) +
            '\n';
  for (const auto& [kind, runs] : runs_with_faults(x, words, interrupted))
    text += "  fault " + printable(kind) + ": " + report::with_thousands(runs) + " of " +
            counted(totals.runs, "run") + '\n';
  text += "  " + counted(totals.events, "event") + ", " + speed(totals.simulated_s, real);
  if (totals.slowest_seed)
    text += ", slowest seed " + std::to_string(*totals.slowest_seed) + " (" +
            report::real_time(seconds(totals.slowest)) + ')';
  text += '\n';
  if (interrupted)
    text += "interrupted: " + counted(size_of(x.seeds()) - totals.runs, "run") + " missing\n";
  return text;
}

swarm_json::swarm_json() = default;
swarm_json::~swarm_json() = default;

void swarm_json::add(const swarm_words& words, const seed_outcome& x) {
  if (x.violations.empty())
    return;
  const auto varied = config::variation_of(words.text, words.settings, x.seed);
  for (const auto& found : x.violations) {
    if (violations_.size() == swarm::listed_max) {
      ++left_out_;
      continue;
    }
    violations_.push_back({{"seed", x.seed},
                           {"at_s", seconds(found.at.time_since_epoch())},
                           {"invariant", found.invariant},
                           {"detail", found.detail},
                           {"replay", replay_command(words, x.seed)}});
    if (!varied.empty())
      violations_.back()["varied"] = report::variation_json(varied);
  }
}

std::string swarm_json::text(const swarm& x, const swarm_words& words, duration real,
                             bool interrupted) const {
  const auto& totals = x.so_far();
  ordered_json object{
      {"file", words.file},
      {"first_seed", x.seeds().first},
      {"last_seed", x.seeds().last},
      {"jobs", words.jobs},
      {"interrupted", interrupted},
      {"runs", totals.runs},
      {"failures", totals.failures},
      {"failed_seeds", totals.failed_seeds},
      {"events", totals.events},
      {"simulated_s", totals.simulated_s},
      {"wall_s", seconds(real)},
      {"slowest_seed", nullptr},
      {"slowest_s", seconds(totals.slowest)},
      {"violations", violations_},
      {"violations_left_out", left_out_},
      {"situations", situations_json(x)},
      {"faults", runs_with_faults(x, words, interrupted)},
  };
  if (totals.slowest_seed)
    object["slowest_seed"] = *totals.slowest_seed;
  return printable_json(json_lines(object)) + '\n';
}

} // namespace rubicon::cli
