#include "report/report.hpp"

#include <algorithm>

namespace rubicon::report {

namespace {

template <class Predicate>
std::uint64_t count_motes(const run_report& x, Predicate predicate) {
  std::uint64_t count = 0;
  for (const auto& island : x.islands)
    count += static_cast<std::uint64_t>(
        std::count_if(island.motes.begin(), island.motes.end(), predicate));
  return count;
}

template <class Part>
Part sum_over_islands(const run_report& x, Part island_report::*part) {
  Part sum;
  for (const auto& island : x.islands)
    sum += island.*part;
  return sum;
}

} // namespace

island_report::island_report() = default;
island_report::~island_report() = default;
island_report::island_report(const island_report&) = default;
island_report& island_report::operator=(const island_report&) = default;
island_report::island_report(island_report&&) noexcept = default;
island_report& island_report::operator=(island_report&&) noexcept = default;

peer_report::peer_report() = default;
peer_report::~peer_report() = default;
peer_report::peer_report(const peer_report&) = default;
peer_report& peer_report::operator=(const peer_report&) = default;
peer_report::peer_report(peer_report&&) noexcept = default;
peer_report& peer_report::operator=(peer_report&&) noexcept = default;

run_report::run_report() = default;
run_report::~run_report() = default;
run_report::run_report(const run_report&) = default;
run_report& run_report::operator=(const run_report&) = default;
run_report::run_report(run_report&&) noexcept = default;
run_report& run_report::operator=(run_report&&) noexcept = default;

std::uint64_t total(const cause_counts& x) {
  std::uint64_t sum = 0;
  for (const auto& [cause, count] : x)
    sum += count;
  return sum;
}

std::uint64_t smepp_report::events_missing() const {
  const auto known = events_received + events_open + total(events_lost);
  return events_raised > known ? events_raised - known : 0;
}

std::optional<double> message_report::delivery() const {
  if (offered <= in_transit)
    return std::nullopt;
  return static_cast<double>(arrived) / static_cast<double>(offered - in_transit);
}

double latency_s(const actuation_report& x, double q) {
  return std::min(x.latency.quantile_ms(q) / 1e3, seconds(x.slowest));
}

std::optional<double> stream_report::delivery() const {
  if (produced <= open)
    return std::nullopt;
  return static_cast<double>(read) / static_cast<double>(produced - open);
}

std::optional<double> clock_report::share_precise() const {
  if (judged == 0)
    return std::nullopt;
  return static_cast<double>(below_1ms) / static_cast<double>(judged);
}

std::uint64_t run_report::motes_configured() const {
  return count_motes(*this, [](const mote_report& x) { return x.joins; });
}

std::uint64_t run_report::motes_measuring() const {
  return count_motes(*this, [](const mote_report& x) { return !x.joins; });
}

std::uint64_t run_report::motes_joined() const {
  return count_motes(*this, [](const mote_report& x) { return x.joins && x.joined; });
}

std::uint64_t run_report::motes_left() const {
  return count_motes(
      *this, [](const mote_report& x) { return x.joins && x.joined && !x.left_cause.empty(); });
}

std::uint64_t run_report::motes_alive() const {
  return count_motes(*this, [](const mote_report& x) { return x.alive; });
}

radio_report run_report::radio() const {
  return sum_over_islands(*this, &island_report::radio);
}

serial_report run_report::serial() const {
  return sum_over_islands(*this, &island_report::serial);
}

message_report run_report::messages() const {
  auto sum = sum_over_islands(*this, &island_report::messages);
  sum += pc_messages;
  return sum;
}

peis_report run_report::peis() const {
  peis_report sum;
  for (const auto& peer : peers)
    sum += peer.peis;
  sum.peers = peers.size();
  sum.tuples = 0;
  for (const auto& peer : peers)
    sum.tuples += peer.tuples;
  return sum;
}

double run_report::used_mah() const {
  double sum = 0;
  for (const auto& island : islands)
    for (const auto& mote : island.motes)
      sum += mote.energy.used_mah;
  return sum;
}

} // namespace rubicon::report
