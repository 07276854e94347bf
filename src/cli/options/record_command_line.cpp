#include "cli/options/record_command_line.hpp"

#include <algorithm>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/options/add_option.hpp"
#include "cli/options/option_values.hpp"

namespace rubicon::cli {

record_command_line::record_command_line(CLI::App& app)
    : explain_app_(*app.add_subcommand("explain", "Trace a message or a value in a recorded run")),
      view_app_(*app.add_subcommand("view", "Show any moment of a recorded run in a browser")) {
  add_explain();
  add_view();
}

void record_command_line::add_explain() {
  explain_app_.add_option("RECORD", explain_.record, "File written by run --record")
      ->required()
      ->type_name("");
  explain_app_
      .add_option("WHAT", explain_.what,
                  "A message such as kitchen/fan#3, or a tuple such as kitchen.fan.state; with "
                  "--when words of a violation")
      ->type_name("");
  add_parsed(explain_app_, "--at", "TIME",
             "The value of the tuple at this time, such as 90s or 1:30, not the newest",
             [&](const auto& text) { explain_.at = parse_moment(text, "--at"); });
  explain_app_.add_flag("--all", explain_.all, "All values of the tuple, one per line");
  explain_app_.add_flag("--lost", explain_.list.lost_only, "Only messages that were lost");
  explain_app_
      .add_option("--from", explain_.list.from, "Only messages from this mote, island or PC")
      ->type_name("WHO");
  add_parsed(explain_app_, "--limit", "N", "Only the newest N; 0 for all; default: 20",
             [&](const auto& text) {
               const auto limit = parse_whole(text);
               if (!limit)
                 throw CLI::ValidationError("--limit", "not a number: '" + text + "'");
               explain_.list.limit = *limit;
             });
  explain_app_.add_flag("--json", explain_.json, "Print JSON only");
  explain_app_
      .add_option("--perfetto", explain_.trace_events,
                  "Write the record into this file as trace events, for Perfetto")
      ->type_name("FILE");
  explain_app_
      .add_option("--mcap", explain_.mcap,
                  "Write the record into this file as MCAP, for Foxglove and Rerun")
      ->type_name("FILE");
  add_when();
  explain_app_.footer("Without WHAT it lists the messages with their outcomes, and the tuples.");
  explain_app_.final_callback([this] { check_explain(); });
}

void record_command_line::add_when() {
  auto* const when = explain_app_.add_flag(
      "--when", asks_when_,
      "Since when the violation WHAT, or the first, was inevitable: repeats the run with other "
      "random numbers from some time on");
  add_parsed(explain_app_, "--futures", "N", "Runs that each time is judged by; default: 20",
             [&](const auto& text) {
               const auto count = parse_whole(text);
               if (!count || *count < 1 || *count > 10'000)
                 throw CLI::ValidationError("--futures",
                                            "not a number from 1 to 10000: '" + text + "'");
               when_.futures = *count;
             })
      ->needs(when);
  add_parsed(explain_app_, "--within", "TIME", "How exact that time is; default: 100ms",
             [&](const auto& text) {
               when_.within = std::max<duration>(1ms, parse_length(text, "--within"));
             })
      ->needs(when);
  add_parsed(explain_app_, "--jobs", "N", "Number of parallel runs; default: one per core",
             [&](const auto& text) { when_.jobs = parse_jobs(text); })
      ->needs(when);
  add_parsed(explain_app_, "--timeout", "TIME",
             "Real time after which a run is aborted; default: 5min",
             [&](const auto& text) { when_.timeout = parse_length(text, "--timeout"); })
      ->needs(when);
}

void record_command_line::add_view() {
  view_app_.add_option("RECORD", view_.record, "File written by run --record")
      ->required()
      ->type_name("");
  add_parsed(view_app_, "--port", "PORT",
             "Address of the page; default: any free port of 127.0.0.1",
             [&](const auto& text) { parse_page_place(text, view_.where); });
  add_page_host(view_app_, [this] { return &view_.where; });
  view_app_.footer("It prints the address of the page, and keeps serving until Ctrl-C.");
}

void record_command_line::check_explain() const {
  for (const auto* other : {"--at", "--all", "--lost", "--from", "--limit", "--perfetto", "--mcap"})
    if (asks_when_ && explain_app_.count(other) > 0)
      throw CLI::ValidationError(other, "not with --when");
  const bool exports = !explain_.trace_events.empty() || !explain_.mcap.empty();
  if (exports && (!explain_.what.empty() || explain_.list.lost_only || explain_.json ||
                  !explain_.list.from.empty()))
    throw CLI::ValidationError(explain_.trace_events.empty() ? "--mcap" : "--perfetto",
                               "writes the whole record, and prints nothing of it");
  if (explain_.what.empty() && (explain_.at || explain_.all))
    throw CLI::ValidationError(explain_.at ? "--at" : "--all", "of which tuple?");
  if (explain_.at && explain_.all)
    throw CLI::ValidationError("--at", "selects one time, --all selects all");
  if (!explain_.what.empty() && (explain_.list.lost_only || !explain_.list.from.empty()))
    throw CLI::ValidationError(explain_.list.lost_only ? "--lost" : "--from",
                               "filters the list, which is printed only without WHAT");
}

std::optional<command> record_command_line::parsed() const {
  if (explain_app_.parsed() && asks_when_) {
    auto x = when_;
    x.record = explain_.record;
    x.what = explain_.what;
    x.json = explain_.json;
    return x;
  }
  if (explain_app_.parsed())
    return explain_;
  if (view_app_.parsed())
    return view_;
  return std::nullopt;
}

} // namespace rubicon::cli
