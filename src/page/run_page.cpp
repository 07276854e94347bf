#include "page/run_page.hpp"

#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/figures.hpp"

namespace rubicon::page {

namespace {

std::string fact(std::string_view name, std::string_view value) {
  return "<div>" + element("dt", name) + element("dd", value) + "</div>";
}

std::string verdict(const report::run_report& x) {
  if (!x.complete)
    return "not complete: " + (x.reason.empty() ? "the run was aborted" : x.reason);
  if (!x.violations.empty())
    return report::counted(x.violations.size(), "violation");
  return x.interrupted ? "no violations until it was interrupted" : "no violations";
}

std::string facts_of(const report::run_report& x) {
  const auto messages = x.messages();
  std::string out = "<dl class='facts'>";
  const auto motes = x.motes_configured() + x.motes_measuring();
  if (motes > 0) {
    out += fact("motes", report::with_thousands(motes));
    out += fact("alive at the end", report::with_thousands(x.motes_alive()));
  }
  if (messages.offered > 0) {
    out += fact("messages", report::with_thousands(messages.offered));
    out += fact("arrived", share(messages.delivery()));
  }
  if (!x.peers.empty())
    out += fact("PEIS peers", report::with_thousands(x.peers.size()));
  if (!x.expectations.empty()) {
    std::size_t met = 0;
    for (const auto& each : x.expectations)
      met += each.outcome == report::expectation_report::verdict::met ? 1 : 0;
    out += fact("expectations met",
                std::to_string(met) + " of " + std::to_string(x.expectations.size()));
  }
  return out + "</dl>\n";
}

} // namespace

std::string head_of(const run_page& x) {
  const auto& run = x.report;
  const bool good = run.complete && run.violations.empty();
  auto text = rubicon::to_text(run.simulated) + " of " + run.mode + " time in " +
              report::real_time(run.wall_s) + " · seed " + std::to_string(run.seed) + " · " +
              report::counted(run.events, "event") +
              (run.trace_hash.empty() ? "" : " · trace " + run.trace_hash) +
              (x.digest.empty() ? "" : " · file " + x.digest) +
              (run.ended_by.empty() ? "" : " · ended by the flat battery of " + run.ended_by) +
              (run.interrupted ? " · interrupted early" : "");
  auto out = "<header>\n" + element("h1", run.ecology) + '\n' +
             element("span", (good ? "✓ " : "✗ ") + verdict(run),
                     good ? "class='verdict'" : "class='verdict no'") +
             '\n' + element("p", text, "class='soft'") + '\n';
  if (!x.command.empty())
    out += element("pre", x.command) + '\n';
  return out + facts_of(run) + "</header>\n";
}

std::string html_of(const run_page& x) {
  return document(x.report.ecology + ", seed " + std::to_string(x.report.seed),
                  head_of(x) + first_problem_of(x) + violations_of(x) + expectations_of(x) +
                      map_of(x) + matrix_of(x) + time_line_of(x) + losses_of(x) + motes_of(x) +
                      energy_of(x) + groups_of(x) + tuples_of(x) + proxies_of(x) + peers_of(x));
}

} // namespace rubicon::page
