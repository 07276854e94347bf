#include "report/run_counters.hpp"

#include <algorithm>

namespace rubicon::report {

namespace {

/// A record that is younger, against the newest that was read, is in flight and not missing.
constexpr duration in_flight_max = 30s;

constexpr std::uint32_t first_unnumbered = 1'000'000;

std::uint64_t above(std::uint64_t a, std::uint64_t b) {
  return a > b ? a - b : 0;
}

double& figure_of(program_report& x, const std::string& name) {
  const auto found = std::ranges::find(x.figures, name, &std::pair<std::string, double>::first);
  return found != x.figures.end() ? found->second : x.figures.emplace_back(name, 0).second;
}

} // namespace

void run_counters::add(mote_address who, bool is_pc, const message_report& x,
                       const arrival_counts& arrivals) {
  (is_pc ? pcs_ : messages_)[who] += x;
  for (const auto& [source, count] : arrivals)
    arrivals_[source] += count;
}

void run_counters::add(const program_report& x, std::uint32_t number,
                       const std::vector<std::string>& measured,
                       const std::vector<stream_part>& streams) {
  if (number == 0)
    number = first_unnumbered + unnumbered_++;
  auto& counters = programs_[{x.who, number, x.kind}];
  counters.sum.who = x.who;
  counters.sum.kind = x.kind;
  for (const auto& [name, value] : x.figures) {
    auto& figure = figure_of(counters.sum, name);
    const bool counts = std::ranges::find(measured, name) == measured.end();
    figure = counts ? figure + value : value;
  }
  counters.read_ends.clear();
  for (const auto& part : streams) {
    const std::pair key(part.reader_name, part.stream);
    auto& stream = streams_[key];
    stream.sum.stream = part.stream;
    stream.sum.to = part.reader_name;
    const auto side = part.writes ? 0 : 1;
    stream.has_ends[side] = true;
    stream.open[side] = part.open;
    stream.steady[side] = part.steady;
    if (part.writes) {
      stream.sum.from = part.writer_name;
      stream.sum.produced += part.records;
      stream.sum.written += above(part.records, part.unwritten);
      stream.sum.opens_failed += part.opens_failed;
      stream.every = part.every;
      stream.written_ms = part.last_ms ? part.last_ms : stream.written_ms;
    } else {
      counters.read_ends.push_back(key);
      stream.sum.read += part.records;
      stream.sum.openings += part.openings;
      stream.sum.pause = std::max(stream.sum.pause, part.pause);
      if (stream.read_ms && part.first_ms) // between two lives
        stream.sum.pause = std::max<duration>(
            stream.sum.pause, static_cast<std::int32_t>(*part.first_ms - *stream.read_ms) * 1ms);
      stream.read_ms = part.last_ms ? part.last_ms : stream.read_ms;
    }
  }
}

void run_counters::add(const proxy_report& x, bool ended) {
  const auto found = proxies_.find(x.name);
  if (found == proxies_.end()) {
    proxies_.emplace(x.name, x);
    return;
  }
  auto sum = found->second.actuations;
  sum += x.actuations;
  if (!ended || found->second.status == "ended")
    found->second = x; // a life that has ended may be told of after the next one
  found->second.actuations = std::move(sum);
}

std::uint64_t run_counters::vectors_missed(const std::string& node, std::uint32_t number) const {
  for (auto x = programs_.lower_bound({node, number, {}});
       x != programs_.end() && std::get<0>(x->first) == node && std::get<1>(x->first) == number;
       ++x) {
    for (const auto& [name, value] : x->second.sum.figures)
      if (name == "vectors missed")
        return static_cast<std::uint64_t>(value);
  }
  return 0;
}

/// Records come in order: those newer than the newest that was read are in flight, if they can be.
stream_report run_counters::settled(const stream_counters& x) {
  auto sum = x.sum;
  const auto unread = above(sum.produced, sum.read);
  if (x.written_ms && x.read_ms && x.every > 0s) {
    const auto ahead = static_cast<std::int32_t>(*x.written_ms - *x.read_ms) * 1ms;
    if (ahead > 0ms && ahead <= in_flight_max)
      sum.open = std::min(unread, static_cast<std::uint64_t>((ahead + x.every / 2) / x.every));
  }
  sum.missing = unread - sum.open;
  return sum;
}

std::vector<half_open_stream> run_counters::half_open() const {
  std::vector<half_open_stream> found;
  for (const auto& [key, x] : streams_) {
    if (!x.has_ends[0] || !x.has_ends[1] || x.open[0] == x.open[1])
      continue;
    const auto steady = std::min(x.steady[0], x.steady[1]);
    found.push_back({x.sum.stream, x.open[0] ? x.sum.from : x.sum.to,
                     x.open[0] ? x.sum.to : x.sum.from, steady});
  }
  return found;
}

void run_counters::settle_streams(run_report& x) const {
  for (const auto& [key, stream] : streams_)
    x.streams.push_back(settled(stream));
  for (const auto& [key, counters] : programs_) {
    auto& program = x.programs.emplace_back(counters.sum);
    if (program.kind != "stream_reader" || counters.read_ends.size() != 1)
      continue;
    const auto stream = settled(streams_.at(counters.read_ends.front()));
    const auto delivery = stream.delivery();
    if (stream.from.empty() || !delivery)
      continue; // nobody of this run writes it: the reader's own clock must do
    figure_of(program, "records missing") = static_cast<double>(stream.missing);
    figure_of(program, "delivery %") = 100 * *delivery;
  }
}

void run_counters::settle_messages(run_report& x) const {
  const auto told = [this](const mote_address& who, message_report sum) {
    const auto arrived = arrivals_.find(who);
    sum.unreliable_arrived = arrived == arrivals_.end() ? 0 : arrived->second;
    sum.lost["in_transit"] = above(sum.unreliable_sent, sum.unreliable_arrived);
    return sum;
  };
  for (const auto& [who, sum] : messages_) {
    const auto island = std::ranges::find(x.islands, who.island, &island_report::id);
    if (island == x.islands.end())
      continue;
    const auto all = told(who, sum);
    island->messages += all;
    const auto mote = std::ranges::find(island->motes, who, &mote_report::address);
    if (mote != island->motes.end())
      mote->messages = all;
  }
  for (const auto& [who, sum] : pcs_)
    x.pc_messages += told(who, sum);
}

void run_counters::settle(run_report& x) const {
  settle_streams(x);
  settle_messages(x);
  for (const auto& [name, proxy] : proxies_)
    if (proxy.status != "ended" || proxy.actuations.requested > 0)
      x.proxies.push_back(proxy);
  for (auto& island : x.islands) {
    auto& network = island.network;
    network.lost["channel_lost"] = above(network.channel_packets, network.channel_packets_arrived);
  }
}

} // namespace rubicon::report
