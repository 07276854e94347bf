// What became of messages and records, and of what the file expects.
#include <algorithm>
#include <vector>

#include "report/figures.hpp"
#include "report/report_parts.hpp"

namespace rubicon::report {

namespace {

constexpr std::size_t worst_shown = 5;
constexpr std::size_t losses_shown = 5;

struct delivery_entry {
  const island_report* island;
  const mote_report* mote;
  double delivery;
};

std::vector<delivery_entry> worst_first(const run_report& x) {
  std::vector<delivery_entry> entries;
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes)
      if (const auto delivery = mote.messages.delivery())
        entries.push_back({&island, &mote, *delivery});
  std::stable_sort(entries.begin(), entries.end(),
                   [](const auto& a, const auto& b) { return a.delivery < b.delivery; });
  return entries;
}

std::string parent_of(const delivery_entry& x) {
  const auto parent = x.mote->parent;
  if (parent == mote_id{})
    return "–";
  const auto& motes = x.island->motes;
  const auto found =
      std::ranges::find(motes, parent, [](const mote_report& each) { return each.address.mote; });
  return found == motes.end() ? "sink" : found->name;
}

cause_counts losses(const message_report& x) {
  auto all = x.lost;
  add_to(all, x.refused);
  return all;
}

std::string share_text(const std::optional<double>& x) {
  return x ? percent(*x, 1) : "–";
}

} // namespace

void add_deliveries(report_page& page, const run_report& x) {
  const auto entries = worst_first(x);
  if (entries.empty())
    return;
  page.heading("Delivery", "of messages: how many arrived, and by which route");
  const bool many = entries.size() > motes_listed_max;
  table rows({{many && !page.is_full() ? "worst" : "mote"},
              {"messages", align::right},
              {"arrived", align::right},
              {"parent"},
              {"hops", align::right},
              {"dBm", align::right},
              {"lost"}});
  const auto shown = many ? page.shown(entries.size(), worst_shown) : entries.size();
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& mote = *entries[i].mote;
    rows.add({page.mote(entries[i].island->name, mote.name), with_thousands(mote.messages.offered),
              share_text(entries[i].delivery), parent_of(entries[i]),
              mote.parent == mote_id{} ? "–" : std::to_string(mote.hops),
              mote.signal_dbm ? std::to_string(*mote.signal_dbm) : "–",
              causes(losses(mote.messages))});
  }
  page.add_rest(rows, entries.size(), shown);
  page.add(rows);
}

void add_losses(report_page& page, const run_report& x) {
  if (x.losses.empty())
    return;
  page.heading("Losses", "where most messages were lost, and why");
  table rows({{"lost", align::right}, {"what"}, {"where"}, {"cause"}});
  const auto shown = page.shown(x.losses.size(), losses_shown);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& each = x.losses[i];
    rows.add(
        {with_thousands(each.count), each.what, each.place.empty() ? "–" : each.place, each.cause});
  }
  page.add_rest(rows, x.losses.size(), shown);
  page.add(rows);
}

void add_streams(report_page& page, const run_report& x) {
  if (x.streams.empty())
    return;
  page.heading("Streams", "records between programs, and how many arrived");
  table rows({{"stream", align::right},
              {"from"},
              {"to"},
              {"produced", align::right},
              {"read", align::right},
              {"arrived", align::right},
              {"missing", align::right},
              {"openings", align::right}});
  const auto shown = page.shown(x.streams.size(), rows_max);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& each = x.streams[i];
    rows.add({std::to_string(each.stream), each.from.empty() ? "–" : each.from, each.to,
              with_thousands(each.produced), with_thousands(each.read), share_text(each.delivery()),
              with_thousands(each.missing), with_thousands(each.openings)});
  }
  page.add_rest(rows, x.streams.size(), shown);
  page.add(rows);
}

void add_expectations(report_page& page, const run_report& x) {
  using verdict = expectation_report::verdict;
  if (x.expectations.empty())
    return;
  page.heading("Expectations", "what the file expects, and what was measured");
  table rows({{""}, {"expected"}, {"measured"}});
  for (const auto& each : x.expectations) {
    const auto how = each.outcome == verdict::met     ? look::good
                     : each.outcome == verdict::unmet ? look::bad
                                                      : look::faint;
    rows.add({{each.outcome == verdict::met     ? "✓"
               : each.outcome == verdict::unmet ? "✗"
                                                : "?",
               how},
              each.text,
              each.measured});
  }
  page.add(rows);
  constexpr std::string_view link = " && ";
  for (const auto& each : x.expectations) {
    if (each.command.empty())
      continue;
    page.line("  " + each.text + ", at " + run_time(each.at) + ", is explained by");
    const auto cut = std::min(each.command.find(link), each.command.size());
    page.line("    " + each.command.substr(0, cut) + (cut < each.command.size() ? " &&" : ""),
              look::faint);
    if (cut < each.command.size())
      page.line("    " + each.command.substr(cut + link.size()), look::faint);
  }
}

} // namespace rubicon::report
