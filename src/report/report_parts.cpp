#include "report/report_parts.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "report/figures.hpp"

namespace rubicon::report {

namespace {

/// Flows added up. A broadcast arrives at any number of motes, so it has no part in the share.
class flow_sum {
public:
  void add(const flow_report& x) {
    sent_ += x.sent;
    goodput_bps_ += x.goodput_bps;
    transmissions_ += x.tx_per_packet * static_cast<double>(x.sent);
    delay_ms_ += x.delay_mean_ms * static_cast<double>(x.delivered);
    delivered_ += x.delivered;
    add_to(lost_, x.lost);
    lost_["open"] += x.to.mote == broadcast_mote ? 0 : x.open;
    if (x.to.mote != broadcast_mote) {
      unicast_sent_ += x.sent;
      unicast_delivered_ += x.delivered;
    }
  }

  [[nodiscard]] std::vector<cell> row(cell name) const {
    const auto sent = static_cast<double>(sent_);
    return {std::move(name),
            "",
            with_thousands(sent_),
            share_of(unicast_delivered_, unicast_sent_),
            fixed(goodput_bps_, 0),
            delivered_ == 0 ? "–" : fixed(delay_ms_ / static_cast<double>(delivered_), 1),
            "",
            sent_ == 0 ? "–" : fixed(transmissions_ / sent, 2),
            causes(lost_)};
  }

private:
  std::uint64_t sent_ = 0;
  std::uint64_t delivered_ = 0;
  std::uint64_t unicast_sent_ = 0;
  std::uint64_t unicast_delivered_ = 0;
  double goodput_bps_ = 0;
  double transmissions_ = 0;
  double delay_ms_ = 0;
  cause_counts lost_;
};

void add_flow_row(table& rows, const flow_report& x) {
  const bool is_broadcast = x.to.mote == broadcast_mote;
  auto lost = x.lost;
  if (!is_broadcast)
    lost["open"] += x.open;
  rows.add({x.from_name, x.to_name, with_thousands(x.sent),
            is_broadcast ? with_thousands(x.delivered) : share_of(x.delivered, x.sent),
            fixed(x.goodput_bps, 0), x.delivered == 0 ? "–" : fixed(x.delay_mean_ms, 1),
            x.delivered == 0 ? "–" : fixed(x.delay_p95_ms, 1),
            x.sent == 0 ? "–" : fixed(x.tx_per_packet, 2), causes(lost)});
}

std::string amount(double x) {
  const bool is_whole =
      x >= 0 && x < 1e15 && x == static_cast<double>(static_cast<std::uint64_t>(x));
  return is_whole ? with_thousands(static_cast<std::uint64_t>(x)) : fixed(x, 3);
}

} // namespace

std::string causes(const cause_counts& x) {
  std::vector<std::pair<std::string, std::uint64_t>> sorted(x.begin(), x.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (const auto& [cause, count] : sorted)
    if (count > 0)
      text += (text.empty() ? "" : ", ") + cause + ' ' + with_thousands(count);
  return text;
}

bool is_missed(std::string_view cause) {
  return cause != "filtered" && cause != "duplicate" && cause != "off";
}

cause_counts really_lost(const radio_report& x) {
  auto lost = x.lost;
  std::erase_if(lost, [](const auto& each) { return !is_missed(each.first); });
  return lost;
}

double left_of(const mote_report& x) {
  return x.energy.battery_mah > 0 ? 1 - x.energy.used_mah / x.energy.battery_mah : 1;
}

std::string projected_life(const mote_report& x) {
  const auto& use = x.energy;
  const auto powered = use.radio_off + use.radio_listen + use.radio_receive + use.radio_transmit;
  if (!x.alive)
    return x.left_cause.empty() ? "✗" : "✗ " + x.left_cause;
  if (!(use.used_mah > 0) || powered <= 0s)
    return "–";
  return life_time(seconds(powered) / 3600 * use.battery_mah / use.used_mah);
}

std::string share_of(std::uint64_t part, std::uint64_t whole) {
  return percent(static_cast<double>(part), static_cast<double>(whole));
}

void add_flows(report_page& page, const run_report& x) {
  if (x.flows.empty())
    return;
  page.heading("Flows", "traffic that measures the medium access");
  table rows({{"from"},
              {"to"},
              {"sent", align::right},
              {"arrived", align::right},
              {"bit/s", align::right},
              {"delay ms", align::right},
              {"95%", align::right},
              {"tx each", align::right},
              {"lost"}});
  const auto shown = page.shown(x.flows.size(), rows_max);
  flow_sum rest;
  flow_sum all;
  for (std::size_t i = 0; i < x.flows.size(); ++i) {
    all.add(x.flows[i]);
    if (i < shown)
      add_flow_row(rows, x.flows[i]);
    else
      rest.add(x.flows[i]);
  }
  if (shown < x.flows.size())
    rows.add(rest.row({with_thousands(x.flows.size() - shown) + " more", look::faint}));
  if (x.flows.size() > 1)
    rows.add(all.row({"all", look::strong}));
  page.add(rows);
}

void add_programs(report_page& page, const run_report& x) {
  if (x.programs.empty())
    return;
  page.heading("Programs", "figures that programs report");
  table rows({{"node"}, {"program"}, {"figures"}});
  const auto shown = page.shown(x.programs.size(), rows_max);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& program = x.programs[i];
    std::string text;
    for (const auto& [name, value] : program.figures)
      text += (text.empty() ? "" : ", ") + name + ' ' + amount(value);
    rows.add({program.who, program.kind, text});
  }
  if (shown < x.programs.size())
    rows.add({{with_thousands(x.programs.size() - shown) + " more", look::faint}, "", ""});
  page.add(rows);
}

} // namespace rubicon::report
