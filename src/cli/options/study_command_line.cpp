#include "cli/options/study_command_line.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/ecology_file.hpp"
#include "cli/options/add_option.hpp"
#include "cli/options/option_values.hpp"

namespace rubicon::cli {

namespace {

std::vector<study::variation> parse_variations(const std::vector<std::string>& texts) {
  std::vector<study::variation> out;
  for (const auto& text : texts) {
    auto found = study::parse_variation(text);
    if (const auto* why = std::get_if<std::string>(&found))
      throw CLI::ValidationError("--vary", "'" + text + "' " + *why);
    out.push_back(std::get<study::variation>(std::move(found)));
  }
  return out;
}

} // namespace

study_command_line::study_command_line(CLI::App& app)
    : sweep_app_(*app.add_subcommand(
          "sweep", "Run an ecology with all combinations of some values, and keep the results")),
      query_app_(*app.add_subcommand("query", "Ask the database of a sweep")) {
  add_sweep();
  add_query();
}

void study_command_line::add_sweep() {
  add_file(sweep_app_, sweep_.file);
  sweep_app_
      .add_option_function<std::vector<std::string>>(
          "--vary", [this](const auto& all) { sweep_.variations = parse_variations(all); },
          "A key or parameter, as of --set, and its values: a list as in loss=0,0.1,0.2, or a "
          "range with its step as in range=15m..40m/5; may be repeated")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUES")
      ->required();
  add_parsed(sweep_app_, "--seeds", "A..B", "The seeds of each variant, both ends included",
             [this](const auto& text) { sweep_.seeds = parse_seeds(text); })
      ->required();
  add_path(sweep_app_, "--out", "DATABASE", sweep_.database,
           "SQLite database of the results; runs that it has are not repeated")
      ->required();
  add_settings(sweep_app_, sweep_.settings);
  add_parsed(sweep_app_, "--jobs", "N", "Number of parallel runs; default: one per core",
             [this](const auto& text) { sweep_.jobs = parse_jobs(text); });
  add_parsed(sweep_app_, "--for", "TIME", "Ecology time of each run; default: the file's",
             [this](const auto& text) {
               static_cast<void>(parse_length(text));
               sweep_.length = text;
             });
  add_parsed(sweep_app_, "--timeout", "TIME",
             "Real time after which a run is aborted; default: 5min",
             [this](const auto& text) { sweep_.timeout = parse_length(text, "--timeout"); });
  sweep_app_
      .add_option("--of", sweep_.scalars,
                  "Number of the report that the summary shows, such as messages.delivery; may be "
                  "repeated")
      ->allow_extra_args(false)
      ->type_name("SCALAR");
  sweep_app_.add_flag("--csv", sweep_.csv, "Print the summary as CSV");
  sweep_app_.footer("Ctrl-C ends it with status 130; runs that have ended are in the database.");
  sweep_app_.final_callback([this] { check_combination(); });
}

void study_command_line::add_query() {
  query_app_.add_option("DATABASE", query_.database, "As `rubicon sweep` has made it")
      ->required()
      ->type_name("");
  query_app_.add_option("SQL", query_.sql, "A SELECT of SQLite")->required()->type_name("");
  query_app_.add_flag("--csv", query_.csv, "Print the rows as CSV");
}

void study_command_line::check_combination() const {
  if (sweep_.file == standard_input)
    throw CLI::ValidationError("FILE", "each run reads it again: not from standard input");
  if (sweep_.seeds.last > INT64_MAX)
    throw CLI::ValidationError("--seeds", "a database holds seeds up to 2^63 - 1");
  const auto variants = study::variants_of(sweep_.variations);
  if (const auto* why = std::get_if<std::string>(&variants))
    throw CLI::ValidationError("--vary", *why);
}

std::optional<command> study_command_line::parsed() const {
  if (sweep_app_.parsed())
    return sweep_;
  if (query_app_.parsed())
    return query_;
  return std::nullopt;
}

} // namespace rubicon::cli
