#include "cli/study/sweep_page.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "cli/print/swarm_text.hpp"
#include "cli/study/figure_text.hpp"
#include "core/text/shell_word.hpp"
#include "page/study_page.hpp"

namespace rubicon::cli {

namespace {

/// What was given, but the options that change nothing of the page.
std::string command_of(const sweep_command& x) {
  auto text = "rubicon sweep " + shell_word(x.file);
  for (const auto& each : x.variations) {
    std::string values;
    for (const auto& value : each.values)
      values += (values.empty() ? "" : ",") + value;
    text += " --vary " + shell_word(each.path + '=' + values);
  }
  text += setting_options({.file = x.file, .settings = x.settings}) + " --seeds " +
          std::to_string(x.seeds.first) + ".." + std::to_string(x.seeds.last) + " --out " +
          shell_word(x.database);
  return text + (x.length.empty() ? "" : " --for " + shell_word(x.length));
}

page::study_scalar page_scalar(const study_summary& all, const scalar_values& x,
                               std::uint64_t first_seed) {
  page::study_scalar out{x.name, {}, {}};
  for (std::size_t i = 0; i < x.of_variants.size(); ++i) {
    const auto figure = figures_of(all, x, i).own;
    out.figures.push_back({figure.runs, figure.value, std::nullopt});
    if (figure.around)
      out.figures.back().interval = std::pair(figure.around->low, figure.around->high);
    auto& runs = out.runs.emplace_back();
    for (std::size_t j = 0; j < x.of_variants[i].size(); ++j)
      if (const auto& value = x.of_variants[i][j])
        runs.push_back({first_seed + j, *value});
  }
  return out;
}

} // namespace

std::string sweep_page(const sweep_command& x, const study_summary& summary, bool from_wall) {
  page::study_page out;
  out.file = x.file;
  out.command = command_of(x);
  out.figure = figure_name(summary);
  out.confidence = percent_text(summary.confidence);
  out.parameters = summary.paths;
  out.variants = summary.variants;
  for (const auto& each : summary.scalars)
    out.scalars.push_back(page_scalar(summary, each, x.seeds.first));
  out.replay = [&](std::size_t variant, std::uint64_t seed) {
    swarm_words words{
        .file = x.file, .length = x.length, .from_wall = from_wall, .settings = x.settings};
    for (std::size_t i = 0; i < summary.paths.size(); ++i)
      words.settings.push_back(summary.paths[i] + '=' + summary.variants[variant][i]);
    return replay_command(words, seed);
  };
  return html_of(out);
}

} // namespace rubicon::cli
