#include "runtime/report.hpp"

#include <algorithm>

namespace rubicon::runtime {

namespace {

void add(cause_counts& sum, const cause_counts& x) {
  for (const auto& [cause, count] : x)
    sum[cause] += count;
}

template <class Predicate>
std::uint64_t count_motes(const report& x, Predicate predicate) {
  std::uint64_t count = 0;
  for (const auto& island : x.islands)
    count += static_cast<std::uint64_t>(
        std::count_if(island.motes.begin(), island.motes.end(), predicate));
  return count;
}

template <class Part>
Part sum_over_islands(const report& x, Part island_report::*part) {
  Part sum;
  for (const auto& island : x.islands)
    sum += island.*part;
  return sum;
}

} // namespace

std::uint64_t total(const cause_counts& x) {
  std::uint64_t sum = 0;
  for (const auto& [cause, count] : x)
    sum += count;
  return sum;
}

radio_report& radio_report::operator+=(const radio_report& x) {
  sent += x.sent;
  delivered += x.delivered;
  add(lost, x.lost);
  requests += x.requests;
  mac_sent += x.mac_sent;
  add(mac_failed, x.mac_failed);
  mac_open += x.mac_open;
  transmissions += x.transmissions;
  return *this;
}

network_report& network_report::operator+=(const network_report& x) {
  beacons += x.beacons;
  packets += x.packets;
  arrived += x.arrived;
  forwarded += x.forwarded;
  repeated += x.repeated;
  channels_asked += x.channels_asked;
  channels_opened += x.channels_opened;
  channels_flooded += x.channels_flooded;
  channels_broken += x.channels_broken;
  channel_packets += x.channel_packets;
  channel_packets_arrived += x.channel_packets_arrived;
  add(lost, x.lost);
  hops_max = std::max(hops_max, x.hops_max);
  synchronised += x.synchronised;
  clock_error_max = std::max(clock_error_max, x.clock_error_max);
  aligned += x.aligned;
  time_error_max = std::max(time_error_max, x.time_error_max);
  state_octets = std::max(state_octets, x.state_octets);
  return *this;
}

serial_report& serial_report::operator+=(const serial_report& x) {
  octets += x.octets;
  octets_up += x.octets_up;
  frames_sent += x.frames_sent;
  frames_received += x.frames_received;
  add(lost, x.lost);
  return *this;
}

peis_report& peis_report::operator+=(const peis_report& x) {
  peers += x.peers;
  packages += x.packages;
  tuples += x.tuples;
  add(lost, x.lost);
  return *this;
}

message_report& message_report::operator+=(const message_report& x) {
  reliable_sent += x.reliable_sent;
  reliable_acked += x.reliable_acked;
  reliable_failed += x.reliable_failed;
  reliable_open += x.reliable_open;
  unreliable_sent += x.unreliable_sent;
  received += x.received;
  duplicates += x.duplicates;
  offered += x.offered;
  add(refused, x.refused);
  unreliable_arrived += x.unreliable_arrived;
  add(lost, x.lost);
  return *this;
}

std::optional<double> message_report::delivery() const {
  if (offered <= reliable_open)
    return std::nullopt;
  const auto arrived = reliable_acked + std::min(unreliable_arrived, unreliable_sent);
  return static_cast<double>(arrived) / static_cast<double>(offered - reliable_open);
}

std::optional<double> stream_report::delivery() const {
  if (produced <= open)
    return std::nullopt;
  return static_cast<double>(read) / static_cast<double>(produced - open);
}

gateway_report& gateway_report::operator+=(const gateway_report& x) {
  led += x.led;
  leading += x.leading;
  leads = x.leads;
  return *this;
}

actuation_report& actuation_report::operator+=(const actuation_report& x) {
  requested += x.requested;
  acknowledged += x.acknowledged;
  slowest = std::max(slowest, x.slowest);
  latency += x.latency;
  add(failed, x.failed);
  return *this;
}

std::uint64_t report::motes_configured() const {
  return count_motes(*this, [](const mote_report& x) { return x.joins; });
}

std::uint64_t report::motes_measuring() const {
  return count_motes(*this, [](const mote_report& x) { return !x.joins; });
}

std::uint64_t report::motes_joined() const {
  return count_motes(*this, [](const mote_report& x) { return x.joins && x.joined; });
}

std::uint64_t report::motes_left() const {
  return count_motes(
      *this, [](const mote_report& x) { return x.joins && x.joined && !x.left_cause.empty(); });
}

std::uint64_t report::motes_alive() const {
  return count_motes(*this, [](const mote_report& x) { return x.alive; });
}

radio_report report::radio() const {
  return sum_over_islands(*this, &island_report::radio);
}

serial_report report::serial() const {
  return sum_over_islands(*this, &island_report::serial);
}

message_report report::messages() const {
  auto sum = sum_over_islands(*this, &island_report::messages);
  sum += pc_messages;
  return sum;
}

peis_report report::peis() const {
  peis_report sum;
  for (const auto& peer : peers)
    sum += peer.peis;
  sum.peers = peers.size();
  sum.tuples = 0;
  for (const auto& peer : peers)
    sum.tuples += peer.tuples;
  return sum;
}

double report::used_mah() const {
  double sum = 0;
  for (const auto& island : islands)
    for (const auto& mote : island.motes)
      sum += mote.used_mah;
  return sum;
}

} // namespace rubicon::runtime
