#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "report/event_log.hpp"
#include "report/expect/expectations.hpp"
#include "report/figures.hpp"
#include "report/print/repeated_violations.hpp"
#include "report/print/report_page.hpp"
#include "report/print/report_text.hpp"
#include "report/report.hpp"
#include "report/report_parts.hpp"

namespace rubicon::report {

namespace {

constexpr std::size_t log_lines_max = 40;
constexpr std::size_t alike_min = 4; ///< equal neighbours in the event log that become one line
constexpr std::size_t least_left_shown = 5;
constexpr std::size_t failures_shown = 10;
constexpr std::size_t failures_kept = 100; ///< by a report
constexpr std::size_t violations_shown = 40;

void add_title(report_page& page, const run_report& x, const std::string& varied) {
  page.line(x.ecology, look::strong);
  page.flow({rubicon::to_text(x.simulated) + " of " + x.mode + " time in " + real_time(x.wall_s) +
                 " (" + speed_factor(x.simulated, x.wall_s) + " real time)",
             "seed " + std::to_string(x.seed) + (varied.empty() ? "" : " (" + varied + ')'),
             counted(x.events, "event"), x.trace_hash.empty() ? "" : "trace " + x.trace_hash,
             x.ended_by.empty() ? "" : "ended by the flat battery of " + x.ended_by,
             x.interrupted ? "interrupted early" : "",
             x.reason.empty() ? "" : "not complete: " + x.reason});
}

/// Lines that say the same become one: `fan and 2 others`, or `fan` so many times.
logged_event joined_line(std::vector<logged_event>::const_iterator first,
                         std::vector<logged_event>::const_iterator last) {
  std::set<std::string> others;
  for (auto x = first; x != last; ++x)
    others.insert(x->who);
  others.erase(first->who);
  const auto count = static_cast<std::size_t>(last - first);
  logged_event line = *first;
  if (!others.empty())
    line.who += " and " + counted(others.size(), "other");
  if (others.size() + 1 < count)
    line.what += ", " + counted(count, "time");
  line.what += ", the last at " + run_time(std::prev(last)->at);
  return line;
}

/// Neighbouring lines that say the same of several become one.
std::vector<logged_event> brief_log(const std::vector<logged_event>& log) {
  std::vector<logged_event> brief;
  for (auto first = log.begin(); first != log.end();) {
    const auto last = std::find_if(
        first, log.end(), [&](const logged_event& line) { return line.what != first->what; });
    const auto count = static_cast<std::size_t>(last - first);
    if (count < alike_min) {
      brief.insert(brief.end(), first, last);
    } else {
      brief.push_back(joined_line(first, last));
    }
    first = last;
  }
  return brief;
}

void add_event_log(report_page& page, const run_report& x) {
  if (x.event_log.empty())
    return;
  page.heading("Event log", "what happened, and when");
  table rows({{"time", align::right}, {"who"}, {"what"}});
  auto log = page.is_full() ? x.event_log : brief_log(x.event_log);
  const auto thinned = page.is_full() ? 0 : thin(log, log_lines_max);
  for (const auto& line : log)
    rows.add({{run_time(line.at), look::faint}, page.anybody(line.who), line.what});
  if (thinned > 0)
    rows.add_note("… " + counted(thinned, "line") +
                  " omitted where most events happened; --full shows all");
  if (x.event_log_left_out > 0)
    rows.add_note("… and " + with_thousands(x.event_log_left_out) +
                  " more are not in the report; --csv writes all");
  page.add(rows);
}

/// A mote and the island it lives in.
struct energy_entry {
  const island_report* island;
  const mote_report* mote;
};

std::vector<energy_entry> least_left_first(const run_report& x) {
  std::vector<energy_entry> entries;
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes)
      entries.push_back({&island, &mote});
  std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
    const auto rank = [](const auto& y) {
      return std::pair(left_of(*y.mote), -y.mote->energy.used_mah);
    };
    return rank(a) < rank(b);
  });
  return entries;
}

/// Digits after the point that suit the largest of the figures.
int decimals_for(double largest_mah) {
  return largest_mah < 10 ? 3 : largest_mah < 100 ? 2 : 1;
}

void add_energy_row(const report_page& page, table& rows, const energy_entry& entry, int decimals) {
  const auto& mote = *entry.mote;
  const auto& x = mote.energy;
  const auto radio_on = x.radio_listen + x.radio_receive + x.radio_transmit;
  const auto radio_all = seconds(radio_on + x.radio_off);
  rows.add({page.mote(entry.island->name, mote.name),
            fixed(x.used_mah, decimals),
            percent(left_of(mote), 1),
            {projected_life(mote), mote.alive ? look::plain : look::bad},
            percent(seconds(radio_on), radio_all),
            percent(seconds(x.radio_transmit), radio_all),
            percent(seconds(x.mcu_active), seconds(x.mcu_active + x.mcu_sleep))});
}

void add_energy(report_page& page, const run_report& x) {
  const auto entries = least_left_first(x);
  if (entries.empty())
    return;
  page.heading("Energy", "charge used, and how long batteries last");
  std::vector<double> used;
  for (const auto& entry : entries)
    used.push_back(entry.mote->energy.used_mah);
  std::ranges::sort(used, std::greater());
  const auto decimals = decimals_for(used.front());
  const auto many = entries.size() > motes_listed_max;
  if (many)
    page.flow({"all motes " + fixed(x.used_mah(), decimals) + " mAh",
               "least " + fixed(used.back(), decimals),
               "median " + fixed(used[used.size() / 2], decimals),
               "most " + fixed(used.front(), decimals)});
  table rows({{many && !page.is_full() ? "least left" : "mote"},
              {"mAh", align::right},
              {"left", align::right},
              {"lasts", align::right},
              {"radio", align::right},
              {"sending", align::right},
              {"CPU", align::right}});
  const auto shown = many ? page.shown(entries.size(), least_left_shown) : entries.size();
  for (std::size_t i = 0; i < shown; ++i)
    add_energy_row(page, rows, entries[i], decimals);
  page.add_rest(rows, entries.size(), shown);
  page.add(rows);
}

/// `22.3 C` as number and unit; a text without a number is all number.
std::pair<std::string, std::string> number_and_unit(const std::string& value) {
  const auto blank = value.find(' ');
  const bool starts_as_number = value.find_first_of("0123456789") <= 1;
  if (!starts_as_number || blank == std::string::npos)
    return {value, ""};
  return {value.substr(0, blank), value.substr(blank + 1)};
}

void add_proxies(report_page& page, const run_report& x) {
  if (x.proxies.empty())
    return;
  page.heading("Proxy values", "what motes last reported, with units");
  table rows({{"proxy"}, {"name"}, {"value", align::point}, {"unit"}, {"status"}});
  std::size_t row_count = 0;
  std::size_t rows_shown = 0;
  for (const auto& proxy : x.proxies) {
    cell name = page.proxy(proxy);
    cell status{proxy.status, proxy.status == "active" ? look::good : look::bad};
    auto values = proxy.values;
    if (values.empty())
      values.emplace_back("–", "");
    for (const auto& [key, value] : values) {
      ++row_count;
      if (page.shown(row_count, rows_max) < row_count)
        continue;
      ++rows_shown;
      const auto [number, unit] = number_and_unit(value);
      rows.add({std::exchange(name, {}), key, number, unit, std::exchange(status, {})});
    }
  }
  page.add_rest(rows, row_count, rows_shown);
  page.add(rows);
}

/// `12`, or `0, 5 sent` of motes that acknowledge nothing.
std::string acknowledged_text(const actuation_report& x) {
  return with_thousands(x.acknowledged) +
         (x.sent > 0 ? ", " + with_thousands(x.sent) + " sent" : std::string());
}

void add_actuations(report_page& page, const run_report& x) {
  actuation_report all;
  for (const auto& proxy : x.proxies)
    all += proxy.actuations;
  if (all.requested == 0)
    return;
  page.heading("Actuations", "which motes acknowledged, and how soon");
  table rows({{"proxy"},
              {"requested", align::right},
              {"acknowledged", align::right},
              {"median", align::right},
              {"99 %", align::right},
              {"slowest", align::right},
              {"failed"}});
  std::size_t row_count = 0;
  std::size_t rows_shown = 0;
  for (const auto& proxy : x.proxies) {
    const auto& actuations = proxy.actuations;
    if (actuations.requested == 0)
      continue;
    ++row_count;
    if (page.shown(row_count, rows_max) < row_count)
      continue;
    ++rows_shown;
    rows.add({page.proxy(proxy),
              with_thousands(actuations.requested),
              acknowledged_text(actuations),
              real_time(latency_s(actuations, 0.5)),
              real_time(latency_s(actuations, 0.99)),
              real_time(seconds(actuations.slowest)),
              {causes(actuations.failed), look::bad}});
  }
  page.add_rest(rows, row_count, rows_shown);
  if (row_count > 1)
    rows.add({{"all", look::strong},
              with_thousands(all.requested),
              acknowledged_text(all),
              real_time(latency_s(all, 0.5)),
              real_time(latency_s(all, 0.99)),
              real_time(seconds(all.slowest)),
              {causes(all.failed), look::bad}});

  page.add(rows);
}

void add_peers(report_page& page, const run_report& x) {
  if (x.peers.empty())
    return;
  page.heading("PEIS network", "links and tuples of each peer");
  table rows({{"peer"},
              {"id", align::right},
              {"links", align::right},
              {"hosts known", align::right},
              {"tuples", align::right},
              {"packages", align::right},
              {"lost"}});
  const auto shown = page.shown(x.peers.size(), rows_max);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& peer = x.peers[i];
    const auto name = page.named(config::label_table::kind::peer, peer.name);
    rows.add({peer.alive ? name : name + " (ended)", to_string(peer.id), with_thousands(peer.links),
              with_thousands(peer.hosts_known), with_thousands(peer.tuples),
              with_thousands(peer.peis.packages), causes(peer.peis.lost)});
  }
  page.add_rest(rows, x.peers.size(), shown);
  page.add(rows);
  table limits({{"peer"}, {"refused or delayed by its limits"}});
  for (std::size_t i = 0; i < shown; ++i) {
    if (!x.peers[i].limits.empty())
      limits.add({x.peers[i].name, causes(x.peers[i].limits)});
  }
  page.add(limits);
}

/// Each text once, with how often it is there, in the order of the first.
std::vector<std::pair<std::string, std::size_t>> equal_ones(const std::vector<std::string>& all) {
  std::vector<std::pair<std::string, std::size_t>> out;
  for (const auto& each : all) {
    const auto found = std::ranges::find(out, each, [](const auto& x) { return x.first; });
    if (found == out.end())
      out.emplace_back(each, 1);
    else
      ++found->second;
  }
  return out;
}

/// The command that explains an expectation stands beside what was measured.
void leave_out_command(const run_report& x, violation& of) {
  for (const auto& each : x.expectations)
    if (const auto full = violation_of(each);
        !each.command.empty() && of.invariant == full.invariant && of.detail == full.detail)
      of.detail = each.measured;
}

void add_verdict(report_page& page, const run_report& x) {
  page.heading("Verdict", "whether the run was sound");
  page.flow({counted(x.actors.spawned, "actor"), with_thousands(x.actors.restarted) + " restarted",
             octet_size(x.serial().octets) + " over serial lines",
             with_thousands(x.radio().transmissions) + " radio transmissions"});
  table failures({{"failed actor"}});
  const auto different = equal_ones(x.actors.failures);
  const std::string of_all = x.actors.failures.size() < failures_kept
                                 ? " times"
                                 : " of the first " + std::to_string(failures_kept) + " failures";
  const auto shown_failures = page.shown(different.size(), failures_shown);
  for (std::size_t i = 0; i < shown_failures; ++i) {
    const auto& [failure, times] = different[i];
    failures.add({times == 1 ? failure : failure + "; " + with_thousands(times) + of_all});
  }
  page.add_rest(failures, different.size(), shown_failures);
  page.add(failures);
  if (x.violations.empty()) {
    page.line(x.interrupted ? "  ✓ no violations until it was interrupted" : "  ✓ no violations",
              look::good);
    return;
  }
  page.line("  ✗ " + counted(x.violations.size(), "violation"), look::bad);
  table rows({{"time", align::right}, {"invariant"}, {"detail"}});
  auto all = repeated(x.violations);
  for (auto& each : all)
    leave_out_command(x, each.first);
  const auto shown = page.shown(all.size(), violations_shown);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& violation = all[i].first;
    rows.add({{run_time(violation.at), look::faint},
              {violation.invariant, look::bad},
              detail_of(all[i])});
  }
  page.add_rest(rows, all.size(), shown);
  page.add(rows);
}

} // namespace

std::string to_text(const run_report& x, std::size_t width, bool colour) {
  return to_text(x, {width, colour});
}

std::string to_text(const run_report& x, const text_options& options) {
  report_page page(options);
  add_title(page, x, to_text(options.varied));
  if (options.brief) {
    add_expectations(page, x);
    add_verdict(page, x);
    return page.finish();
  }
  add_event_log(page, x);
  add_islands(page, x);
  add_network(page, x);
  add_groups(page, x);
  add_flows(page, x);
  add_deliveries(page, x);
  add_losses(page, x);
  add_streams(page, x);
  add_programs(page, x);
  add_energy(page, x);
  add_proxies(page, x);
  add_actuations(page, x);
  add_peers(page, x);
  add_expectations(page, x);
  add_verdict(page, x);
  return page.finish();
}

} // namespace rubicon::report
