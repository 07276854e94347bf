#include "cli/options/study_command_line.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/ecology_file.hpp"
#include "cli/options/add_option.hpp"
#include "cli/options/option_values.hpp"
#include "core/text/decimal.hpp"

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

study::stop_rule parse_rule(const std::string& text) {
  auto found = study::parse_stop_rule(text);
  if (const auto* why = std::get_if<std::string>(&found))
    throw CLI::ValidationError("--until", "'" + text + "' " + *why);
  return std::get<study::stop_rule>(std::move(found));
}

double parse_quantile(const std::string& text) {
  const auto found = number_in(text);
  if (!found || *found < 0 || *found > 1)
    throw CLI::ValidationError("--quantile", "'" + text + "' is no number from 0 to 1");
  return *found;
}

void add_scalars(CLI::App& app, std::vector<std::string>& scalars, const char* text) {
  app.add_option("--of", scalars, text)->allow_extra_args(false)->type_name("SCALAR");
}

} // namespace

study_command_line::study_command_line(CLI::App& app)
    : sweep_app_(*app.add_subcommand(
          "sweep", "Run an ecology with all combinations of some values, and keep the results")),
      compare_app_(*app.add_subcommand(
          "compare", "Show what differs between two files, binaries, studies or records")),
      shrink_app_(*app.add_subcommand("shrink",
                                      "Leave out of a file all that its violation does not need")),
      query_app_(*app.add_subcommand("query", "Ask the database of a sweep")) {
  add_sweep();
  add_compare();
  add_shrink();
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
           "SQLite database of the results; runs that it has are not repeated; default: room.db in "
           "this folder, of room.toml");
  add_settings(sweep_app_, sweep_.settings);
  add_runs(sweep_app_, sweep_.jobs, sweep_.length, sweep_.timeout);
  add_scalars(sweep_app_, sweep_.scalars,
              "Number of the report that the summary shows, such as messages.delivery; may be "
              "repeated");
  add_parsed(
      sweep_app_, "--until", "RULE",
      "Make runs of a variant only until the half-width of the interval of a number is below "
      "a limit, such as 'messages.delivery ci < 1%' of the mean, or 'events ci < 50'",
      [this](const auto& text) { sweep_.until = parse_rule(text); });
  add_parsed(sweep_app_, "--quantile", "Q",
             "Show this quantile, 0 to 1, with its bootstrap interval, in the place of the mean",
             [this](const auto& text) { sweep_.quantile = parse_quantile(text); });
  add_parsed(sweep_app_, "--series", "TIME",
             "Also keep how charge and losses grow in each run, with a point each TIME",
             [this](const auto& text) {
               static_cast<void>(parse_length(text, "--series"));
               sweep_.series_every = text;
             });
  add_path(sweep_app_, "--report", "FILE", sweep_.page_file,
           "Also write the summary as an HTML page: curves, maps and the runs themselves");
  sweep_app_.add_flag("--csv", sweep_.csv, "Print the summary as CSV");
  sweep_app_.footer("Ctrl-C ends it with status 130; runs that have ended are in the database.");
  sweep_app_.final_callback([this] { check_combination(); });
}

void study_command_line::add_runs(CLI::App& app, std::optional<std::uint64_t>& jobs,
                                  std::string& length, duration& timeout) {
  add_parsed(app, "--jobs", "N", "Number of parallel runs; default: one per core",
             [&jobs](const auto& text) { jobs = parse_jobs(text); });
  add_parsed(app, "--for", "TIME", "Ecology time of each run; default: the file's",
             [&length](const auto& text) {
               static_cast<void>(parse_length(text));
               length = text;
             });
  add_parsed(app, "--timeout", "TIME", "Real time after which a run is aborted; default: 5min",
             [&timeout](const auto& text) { timeout = parse_length(text, "--timeout"); });
}

void study_command_line::add_compare() {
  const auto add_word = [this](const char* name, std::string& to, const char* text) {
    compare_app_.add_option(name, to, text)->required()->type_name("");
  };
  add_word("A", compare_.a, "A file, a binary, a database of `rubicon sweep`, or a record");
  add_word("B", compare_.b, "Another of the same kind");
  add_path(compare_app_, "--file", "FILE", compare_.file, "File that two binaries run");
  add_parsed(compare_app_, "--seeds", "A..B",
             "The seeds that both run, both ends included; default: 1..20",
             [this](const auto& text) { compare_.seeds = parse_seeds(text); });
  add_settings(compare_app_, compare_.settings);
  add_runs(compare_app_, compare_.jobs, compare_.length, compare_.timeout);
  add_scalars(compare_app_, compare_.scalars,
              "Number of the report that is compared; default: all but real time; may be repeated");
  compare_app_.add_flag("--full", compare_.full, "Show all numbers that differ");
  compare_app_.add_flag("--csv", compare_.csv, "Print all numbers that differ as CSV");
  compare_app_.footer("Exit status: 0 nothing surely differs, 1 something does or a run had no\n"
                      "report, 2 bad command line or file.");
  compare_app_.final_callback([this] {
    if (compare_.file == standard_input)
      throw CLI::ValidationError("--file", "each run reads it again: not from standard input");
  });
}

void study_command_line::add_shrink() {
  add_file(shrink_app_, shrink_.file);
  add_parsed(shrink_app_, "--seed", "N", "The seed whose run has the violation",
             [this](const auto& text) { shrink_.seed = parse_seed(text); })
      ->required();
  add_path(shrink_app_, "--out", "FILE", shrink_.out,
           "The smaller file; default: NAME.small.toml beside FILE");
  add_settings(shrink_app_, shrink_.settings);
  add_parsed(shrink_app_, "--timeout", "TIME",
             "Real time after which a run is aborted; default: 5min",
             [this](const auto& text) { shrink_.timeout = parse_length(text, "--timeout"); });
  shrink_app_.footer("Ctrl-C ends it with status 130 and writes what it has come to.");
  shrink_app_.final_callback([this] {
    if (shrink_.file == standard_input)
      throw CLI::ValidationError("FILE", "each run reads it again: not from standard input");
  });
}

void study_command_line::add_query() {
  query_app_.add_option("DATABASE", query_.database, "As `rubicon sweep` has made it")
      ->required()
      ->type_name("");
  query_app_.add_option("SQL", query_.sql, "A SELECT of SQLite")->required()->type_name("");
  query_app_.add_flag("--csv", query_.csv, "Print the rows as CSV");
}

void study_command_line::check_combination() {
  if (sweep_.file == standard_input)
    throw CLI::ValidationError("FILE", "each run reads it again: not from standard input");
  if (sweep_.seeds.last > INT64_MAX)
    throw CLI::ValidationError("--seeds", "a database holds seeds up to 2^63 - 1");
  const auto variants = study::variants_of(sweep_.variations);
  if (const auto* why = std::get_if<std::string>(&variants))
    throw CLI::ValidationError("--vary", *why);
  if (sweep_.database.empty())
    sweep_.database = std::filesystem::path(sweep_.file).stem().string() + ".db";
}

std::optional<command> study_command_line::parsed() const {
  if (sweep_app_.parsed())
    return sweep_;
  if (compare_app_.parsed())
    return compare_;
  if (shrink_app_.parsed())
    return shrink_;
  if (query_app_.parsed())
    return query_;
  return std::nullopt;
}

} // namespace rubicon::cli
