// Figures at the end of a run, as tables.
#include <algorithm>
#include <array>
#include <iterator>
#include <utility>
#include <vector>

#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/expect/expectations.hpp"
#include "report/figures.hpp"
#include "report/print/repeated_violations.hpp"
#include "report/report_parts.hpp"

namespace rubicon::page {

namespace {

using report::cause_counts;
using report::counted;
using report::with_thousands;
using kind = config::label_table::kind;

constexpr std::size_t rows_open_max = 40; ///< the others are folded
constexpr std::size_t violations_shown = 200;
constexpr std::size_t peers_shown = 200;

struct layer {
  std::string title;
  cause_counts lost;
  std::string_view sampled = {}; ///< as samples call it
};

std::vector<layer> layers_of(const report::run_report& x) {
  cause_counts network;
  auto channels = x.tunnels.lost;
  for (const auto& island : x.islands) {
    add_to(network, island.network.lost);
    add_to(channels, island.network.channel_packets.lost);
  }
  auto messages = x.messages().lost;
  add_to(messages, x.messages().refused);
  cause_counts flows;
  for (const auto& each : x.flows)
    add_to(flows, each.lost);
  return {{"Messages", messages, "messages"},
          {"Packets of streams and synaptic channels", channels, "channels"},
          {"Packets and channels of the network, hop by hop", network, "network"},
          {"Frames that the radio gave up", x.radio().mac_failed, "mac"},
          {"Copies of frames on the radio medium", really_lost(x.radio()), "radio"},
          {"Flows", flows},
          {"Serial lines", x.serial().lost, "serial"},
          {"PEIS packages", x.peis().lost, "peis"}};
}

/// The most frequent first.
std::vector<std::pair<std::string, std::uint64_t>> sorted(const cause_counts& x) {
  std::vector<std::pair<std::string, std::uint64_t>> all;
  for (const auto& each : x)
    if (each.second > 0)
      all.push_back(each);
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return all;
}

struct mote_entry {
  const report::island_report* island;
  const report::mote_report* mote;
};

/// Those that deliver least first, then those with the least left.
std::vector<mote_entry> worst_first(const report::run_report& x) {
  std::vector<mote_entry> all;
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes)
      all.push_back({&island, &mote});
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    const auto rank = [](const mote_entry& y) {
      return std::pair(y.mote->messages.delivery().value_or(2), report::left_of(*y.mote));
    };
    return rank(a) < rank(b);
  });
  return all;
}

std::string state_of(const report::mote_report& x) {
  if (!x.alive)
    return x.left_cause.empty() ? "off" : x.left_cause;
  if (x.joins && !x.joined)
    return "never joined";
  return x.left_cause.empty() ? "" : "left: " + x.left_cause;
}

std::string parent_of(const mote_entry& x) {
  if (x.mote->parent == mote_id{})
    return "–";
  const auto found = std::ranges::find(x.island->motes, x.mote->parent,
                                       [](const auto& each) { return each.address.mote; });
  return found == x.island->motes.end() ? "sink" : found->name;
}

std::string mote_row(const run_page& page, const mote_entry& x) {
  const auto& mote = *x.mote;
  auto lost = mote.messages.lost;
  add_to(lost, mote.messages.refused);
  const auto delivery = mote.messages.delivery();
  const bool routed = mote.parent != mote_id{};
  return row({{named(page, kind::mote, x.island->name + '/' + mote.name), false, "name"},
              {state_of(mote), false, mote.alive ? "" : "bad"},
              {with_thousands(mote.messages.offered), true},
              {share(delivery), true, class_of(delivery)},
              {report::causes(lost), false, "long"},
              {parent_of(x)},
              {routed ? std::to_string(mote.hops) : "–", true},
              {mote.signal_dbm ? std::to_string(*mote.signal_dbm) : "–", true},
              {report::percent(report::left_of(mote), 1), true},
              {report::projected_life(mote), true},
              {mote.silence >= 1s ? report::span_text(mote.silence, mote.silence_from) : "–"}});
}

std::string mote_table(const run_page& page, const std::vector<mote_entry>& all, std::size_t from,
                       std::size_t to) {
  auto rows = head_row({{"mote"},
                        {""},
                        {"sent", true},
                        {"arrived", true},
                        {"lost, refused"},
                        {"parent"},
                        {"hops", true},
                        {"dBm", true},
                        {"battery left", true},
                        {"lasts", true},
                        {"longest silence"}});
  for (auto i = from; i < to; ++i)
    rows += mote_row(page, all[i]);
  return wide("<table>" + rows + "</table>");
}

/// The tenth of the run in which most were lost for this cause, `5:00.000 to 6:12.000, 62.0%`;
/// nothing: it is not known.
std::string worst_time(const run_page& x, const report::loss_report& of) {
  constexpr std::size_t parts = 10;
  const auto found = x.seen.lost().find({of.what == "message" ? "messages" : "channels", of.cause});
  const auto& times = x.seen.times();
  if (found == x.seen.lost().end() || found->second.size() != times.size() || times.empty() ||
      found->second.back() <= 0 || x.report.simulated <= 0s)
    return {};
  std::array<double, parts> lost{};
  double before = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto share_of_run = seconds(times[i].time_since_epoch()) / seconds(x.report.simulated);
    const auto part = static_cast<std::size_t>(share_of_run * parts * (1 - 1e-9));
    lost[std::min(part, parts - 1)] += found->second[i] - before;
    before = found->second[i];
  }
  const auto most = std::ranges::max_element(lost);
  const auto begin = x.report.simulated / parts * (most - lost.begin());
  return report::run_time(instant{} + begin) + " to " +
         report::run_time(instant{} + begin + x.report.simulated / parts) + ", " +
         report::percent(*most, before);
}

/// Where messages and packets of streams were lost last.
std::string places_of(const run_page& x) {
  const auto& all = x.report.losses;
  if (all.empty())
    return {};
  auto rows = head_row({{"lost", true}, {"what"}, {"where"}, {"cause"}, {"most of this cause"}});
  const auto shown = std::min(all.size(), rows_open_max);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& each = all[i];
    rows += row({{with_thousands(each.count), true},
                 {each.what},
                 {each.place},
                 {each.cause},
                 {worst_time(x, each)}});
  }
  if (shown < all.size())
    rows += row({{""}, {"and " + counted(all.size() - shown, "other place")}});
  return wide("<table>" + rows + "</table>");
}

} // namespace

std::string losses_of(const run_page& x) {
  std::string out;
  for (const auto& layer : layers_of(x.report)) {
    const auto causes = sorted(layer.lost);
    if (causes.empty())
      continue;
    std::string rows;
    const auto most = static_cast<double>(causes.front().second);
    for (const auto& [cause, count] : causes) {
      const auto part = 100 * static_cast<double>(count) / most;
      rows += "<tr>" + element("td", cause, "class='name'") +
              element("td", with_thousands(count), "class='number'") +
              "<td class='bars'><span class='bar' style='width:" + px(part) +
              "%'></span></td></tr>\n";
    }
    out += "<figure>" + element("h3", layer.title) + "<table>" + rows + "</table>" +
           losses_over_time(x, layer.sampled) + "</figure>\n";
  }
  return section("losses", "Losses by cause",
                 out.empty() ? out : "<div class='grid'>" + out + "</div>\n" + places_of(x));
}

std::string motes_of(const run_page& x) {
  const auto all = worst_first(x.report);
  if (all.empty())
    return {};
  const auto open = std::min(all.size(), rows_open_max);
  auto out = mote_table(x, all, 0, open);
  if (open < all.size())
    out += "<details>" +
           element("summary", "… and " + report::counted(all.size() - open, "more mote")) +
           mote_table(x, all, open, all.size()) + "</details>\n";
  return section("motes", "Motes", out);
}

std::string expectations_of(const run_page& x) {
  using verdict = report::expectation_report::verdict;
  if (x.report.expectations.empty())
    return {};
  auto rows = head_row({{""}, {"expected"}, {"measured"}});
  std::string commands;
  for (const auto& each : x.report.expectations) {
    const bool met = each.outcome == verdict::met;
    const bool unmet = each.outcome == verdict::unmet;
    rows += row({{met     ? "✓"
                  : unmet ? "✗"
                          : "?",
                  false,
                  met     ? "met"
                  : unmet ? "unmet"
                          : "soft"},
                 {each.text, false, "long"},
                 {each.measured, false, "long"}});
    if (!each.command.empty())
      commands +=
          element("p", each.text + ", at " + report::run_time(each.at) + ", is explained by") +
          element("pre", each.command) + '\n';
  }
  return section("expectations", "Expectations", wide("<table>" + rows + "</table>") + commands);
}

std::string violations_of(const run_page& x) {
  std::vector<report::violation> others;
  std::ranges::copy_if(x.report.violations, std::back_inserter(others), [](const auto& each) {
    return !each.invariant.starts_with(report::expected); // those have a section of their own
  });
  const auto all = report::repeated(others);
  if (all.empty())
    return {};
  auto rows = head_row({{"time", true}, {"invariant"}, {"observed"}});
  const auto shown = std::min(all.size(), violations_shown);
  for (std::size_t i = 0; i < shown; ++i)
    rows += row({{report::run_time(all[i].first.at), true},
                 {all[i].first.invariant, false, "long bad"},
                 {report::detail_of(all[i]), false, "long"}});
  auto out = wide("<table>" + rows + "</table>");
  if (shown < all.size())
    out += element("p", "… and " + with_thousands(all.size() - shown) + " more", "class='soft'");
  return section("violations", "Violations", out);
}

std::string proxies_of(const run_page& x) {
  if (x.report.proxies.empty())
    return {};
  const auto& all = x.report.proxies;
  const auto table = [&x, &all](std::size_t from, std::size_t to) {
    auto rows = head_row({{"proxy"}, {"status"}, {"values"}, {"actuations"}});
    for (auto i = from; i < to; ++i) {
      const auto& each = all[i];
      std::string values;
      for (const auto& [name, value] : each.values)
        values += (values.empty() ? "" : ", ") + name + ' ' + value;
      const auto label = x.ecology.labels.of(kind::proxy, each.proxy_class);
      const auto& acts = each.actuations;
      rows += row(
          {{label.empty() ? each.name : each.name + " (" + label + ')', false, "name"},
           {each.status, false, each.status == "active" ? "" : "bad"},
           {values, false, "long"},
           {acts.requested == 0 ? ""
                                : with_thousands(acts.acknowledged) + " of " +
                                      with_thousands(acts.requested) + " acknowledged" +
                                      (acts.sent > 0 ? ", " + with_thousands(acts.sent) + " sent"
                                                     : std::string())}});
    }
    return wide("<table>" + rows + "</table>");
  };
  const auto open = std::min(all.size(), rows_open_max);
  auto out = table(0, open);
  if (open < all.size())
    out += "<details>" +
           element("summary", "… and " + with_thousands(all.size() - open) + " more") +
           table(open, all.size()) + "</details>\n";
  return section("proxies", "Proxies", out);
}

std::string groups_of(const run_page& x) {
  std::vector<const report::island_report*> all;
  for (const auto& island : x.report.islands)
    if (island.smepp.programs > 0)
      all.push_back(&island);
  if (all.empty())
    return {};
  const auto table = [&x, &all](std::size_t from, std::size_t to) {
    auto rows = head_row({{"island"},
                          {"members", true},
                          {"joins failed", true},
                          {"frames", true},
                          {"octets", true},
                          {"events", true},
                          {"received", true},
                          {"open", true},
                          {"missing", true},
                          {"events lost"},
                          {"frames refused"}});
    for (auto i = from; i < to; ++i) {
      const auto& part = all[i]->smepp;
      const bool all_in = part.members == part.programs;
      rows += row({{named(x, kind::island, all[i]->name), false, "name"},
                   {with_thousands(part.members) + " of " + with_thousands(part.programs), true,
                    all_in ? "" : "bad"},
                   {with_thousands(part.joins_failed), true},
                   {with_thousands(part.frames), true},
                   {with_thousands(part.octets), true},
                   {with_thousands(part.events_raised), true},
                   {with_thousands(part.events_received), true},
                   {with_thousands(part.events_open), true},
                   {with_thousands(part.events_missing()), true},
                   {report::causes(part.events_lost), false, "long"},
                   {report::causes(part.refused), false, "long"}});
    }
    return wide("<table>" + rows + "</table>");
  };
  const auto open = std::min(all.size(), rows_open_max);
  auto out = table(0, open);
  if (open < all.size())
    out += "<details>" +
           element("summary", "… and " + report::counted(all.size() - open, "more island")) +
           table(open, all.size()) + "</details>\n";
  return section("groups", "Groups", out);
}

std::string peers_of(const run_page& x) {
  if (x.report.peers.empty())
    return {};
  auto rows = head_row({{"peer"},
                        {"id", true},
                        {"links", true},
                        {"hosts known", true},
                        {"tuples", true},
                        {"packages", true},
                        {"lost"},
                        {"refused by limits"}});
  const auto shown = std::min(x.report.peers.size(), peers_shown);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& peer = x.report.peers[i];
    rows += row({{named(x, kind::peer, peer.name) + (peer.alive ? "" : " (ended)"), false,
                  peer.alive ? "name" : "name bad"},
                 {to_string(peer.id), true},
                 {with_thousands(peer.links), true},
                 {with_thousands(peer.hosts_known), true},
                 {with_thousands(peer.tuples), true},
                 {with_thousands(peer.peis.packages), true},
                 {report::causes(peer.peis.lost), false, "long"},
                 {report::causes(peer.limits), false, "long"}});
  }
  auto out = wide("<table>" + rows + "</table>");
  if (shown < x.report.peers.size())
    out += element("p", "… and " + with_thousands(x.report.peers.size() - shown) + " more",
                   "class='soft'");
  return section("peers", "PEIS peers", out);
}

} // namespace rubicon::page
