#include "report/run_counters.hpp"

#include <algorithm>
#include <functional>
#include <string_view>

namespace rubicon::report {

namespace {

/// A record that is younger, against the newest that was read, is in flight and not missing.
constexpr duration in_flight_max = 30s;

constexpr std::uint32_t first_unnumbered = 1'000'000;

std::uint64_t above(std::uint64_t a, std::uint64_t b) {
  return a > b ? a - b : 0;
}

/// `kitchen/climate-7` of `mote/kitchen/climate-7`, `kitchen/sink` of `sink/kitchen`.
std::string place_name(std::string_view path) {
  const auto slash = path.find('/');
  if (slash == std::string_view::npos)
    return std::string(path);
  const auto kind = path.substr(0, slash);
  const auto rest = std::string(path.substr(slash + 1));
  if (kind == "serial_line")
    return rest + "/line";
  return kind == "sink" || kind == "gateway" ? rest + '/' + std::string(kind) : rest;
}

double& figure_of(program_report& x, const std::string& name) {
  const auto found = std::ranges::find(x.figures, name, &std::pair<std::string, double>::first);
  return found != x.figures.end() ? found->second : x.figures.emplace_back(name, 0).second;
}

/// What was closed when a life ended, and was not opened in the next one, was closed all the while.
/// @param began when that life did
void change(stream_counters::end& x, bool open, instant at, std::optional<instant> began) {
  const bool was_never_open = !open && began && at == *began;
  if (!x.is_known || x.open || !was_never_open)
    x.changed_at = at;
  x.is_known = true;
  x.open = open;
}

void add_life(stream_counters::end& x, const stream_part& part) {
  change(x, part.open, part.changed_at, part.started_at);
  x.asked_at = earliest(x.asked_at, part.started_at);
}

} // namespace

cause_counts lost_of(const message_tally& x) {
  cause_counts out;
  for (const auto& [cause, count] : x.lost)
    out[std::string(to_string(cause))] = count;
  return out;
}

std::vector<loss_report> losses_of(const message_ledger& x) {
  std::vector<loss_report> out;
  for (const auto& [where, count] : x.lost_at()) {
    const auto& [kind, cause, place] = where;
    out.push_back(
        {std::string(to_string(kind)), std::string(to_string(cause)), place_name(place), count});
  }
  return out;
}

void run_counters::add(mote_address who, bool is_pc, const message_report& x) {
  (is_pc ? all_.pcs : all_.messages)[who] += x;
}

void run_counters::add(const std::string& peer, const cause_counts& x) {
  if (!x.empty())
    add_to(all_.modules[peer], x);
}

void run_counters::take(const message_ledger& x) {
  all_.accounts.clear();
  all_.losses.clear();
  for (const auto& [who, tally] : x.tallied()) {
    auto& account = all_.accounts[{who.first, std::string(to_string(who.second))}];
    account.sent = tally.sent;
    account.arrived = tally.arrived;
    account.handed_over = tally.handed_over;
    account.handed_lately = tally.handed_lately;
    account.lost = lost_of(tally);
  }
  for (const auto& [who, count] : x.foreign_arrivals())
    all_.accounts[{who.first, std::string(to_string(who.second))}].came_over = count;
  for (const auto& each : losses_of(x))
    all_.losses[{each.what, each.cause, each.place}] += each.count;
}

void run_counters::add(const program_report& x, std::uint32_t number,
                       const std::vector<std::string>& measured,
                       const std::vector<stream_part>& streams) {
  if (number == 0)
    number = first_unnumbered + unnumbered_++;
  auto& counters = all_.programs[{x.who, number, x.kind}];
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
    auto& stream = all_.streams[key];
    stream.sum.stream = part.stream;
    stream.sum.to = part.reader_name;
    auto& end = part.writes ? stream.writer : stream.reader;
    add_life(end, part);
    if (part.writes) {
      stream.sum.from = part.writer_name;
      stream.sum.produced += part.records;
      stream.sum.written += above(part.records, part.unwritten);
      stream.sum.opens_failed += part.opens_failed;
      stream.every = part.every;
    } else {
      counters.read_ends.push_back(key);
      stream.sum.read += part.records;
      stream.sum.openings += part.openings;
      stream.sum.pause = std::max(stream.sum.pause, part.pause);
      if (end.newest_at && part.first_at) // between two lives
        stream.sum.pause = std::max(stream.sum.pause, *part.first_at - *end.newest_at);
    }
    end.first_at = end.first_at ? end.first_at : part.first_at;
    end.newest_at = part.last_at ? part.last_at : end.newest_at;
    end.newest_ms = part.last_ms ? part.last_ms : end.newest_ms;
  }
}

void run_counters::add(const proxy_report& x, bool ended) {
  const auto found = all_.proxies.find(x.name);
  if (found == all_.proxies.end()) {
    all_.proxies.emplace(x.name, x);
    return;
  }
  auto sum = found->second.actuations;
  sum += x.actuations;
  if (!ended || found->second.status == "ended")
    found->second = x; // a life that has ended may be reported after the next one
  found->second.actuations = std::move(sum);
}

namespace {

void add_end(stream_counters::end& sum, stream_counters::end x, duration later) {
  if (!x.is_known)
    return;
  for (auto* at : {&x.asked_at, &x.first_at, &x.newest_at})
    if (*at)
      **at += later;
  change(sum, x.open, x.changed_at + later, x.asked_at);
  sum.asked_at = earliest(sum.asked_at, x.asked_at);
  sum.first_at = earliest(sum.first_at, x.first_at);
  sum.newest_ms = x.newest_ms ? x.newest_ms : sum.newest_ms;
  sum.newest_at = x.newest_at ? x.newest_at : sum.newest_at;
}

void add_stream(stream_counters& sum, const stream_counters& x, duration later) {
  sum.sum.stream = x.sum.stream;
  sum.sum.to = x.sum.to;
  if (!x.sum.from.empty())
    sum.sum.from = x.sum.from;
  sum.sum.produced += x.sum.produced;
  sum.sum.written += x.sum.written;
  sum.sum.opens_failed += x.sum.opens_failed;
  sum.sum.read += x.sum.read;
  sum.sum.openings += x.sum.openings;
  sum.sum.pause = std::max(sum.sum.pause, x.sum.pause);
  sum.every = std::max(sum.every, x.every);
  if (sum.reader.newest_at && x.reader.first_at) // between two lives of their process
    sum.sum.pause = std::max(sum.sum.pause, *x.reader.first_at + later - *sum.reader.newest_at);
  add_end(sum.writer, x.writer, later);
  add_end(sum.reader, x.reader, later);
}

} // namespace

void run_counters::add(const unsettled_counters& x, instant begun) {
  for (const auto& [key, program] : x.programs) {
    auto& sum = all_.programs[key];
    sum.sum.who = program.sum.who;
    sum.sum.kind = program.sum.kind;
    for (const auto& [name, value] : program.sum.figures)
      figure_of(sum.sum, name) += value;
    sum.read_ends = program.read_ends;
  }
  for (const auto& [key, stream] : x.streams)
    add_stream(all_.streams[key], stream, begun.time_since_epoch());
  for (const auto& [name, proxy] : x.proxies)
    add(proxy, proxy.status == "ended");
  for (const auto& [peer, counters] : x.modules)
    add(peer, counters);
  add_to(all_.messages, x.messages);
  add_to(all_.pcs, x.pcs);
  add_to(all_.accounts, x.accounts);
  add_to(all_.losses, x.losses);
}

void run_counters::end_handed_over() {
  const std::string cause(to_string(loss::other_host));
  for (auto& [key, x] : all_.accounts) {
    const auto missing = above(above(x.handed_over, x.came_over), x.handed_lately);
    if (missing == 0)
      continue;
    x.handed_over -= missing;
    x.lost[cause] += missing;
    all_.losses[{key.second, cause, {}}] += missing;
  }
}

void unsettle(run_report& x) {
  x.programs.clear();
  x.streams.clear();
  x.proxies.clear();
  x.modules.clear();
  x.pc_messages = {};
  x.tunnels = {};
  x.losses.clear();
  for (auto& island : x.islands) {
    island.messages = {};
    island.network.channel_packets = {};
    for (auto& mote : island.motes)
      mote.messages = {};
  }
}

std::uint64_t run_counters::vectors_missed(const std::string& node, std::uint32_t number) const {
  for (auto x = all_.programs.lower_bound({node, number, {}});
       x != all_.programs.end() && std::get<0>(x->first) == node && std::get<1>(x->first) == number;
       ++x) {
    for (const auto& [name, value] : x->second.sum.figures)
      if (name == "vectors missed")
        return static_cast<std::uint64_t>(value);
  }
  return 0;
}

/// Records come in order: those newer than the newest that was read are in flight, if they can be;
/// not so where no record has come for longer than one may take.
stream_report run_counters::settled(const stream_counters& x, instant now) {
  auto sum = x.sum;
  const auto asked =
      std::max(x.reader.asked_at.value_or(instant{}), x.writer.asked_at.value_or(instant{}));
  sum.first_after = std::max(0ns, x.reader.first_at.value_or(now) - asked);
  if (x.reader.newest_at) // its last life may have had none, or have ended
    sum.pause = std::max(sum.pause, now - *x.reader.newest_at);
  const auto unread = above(sum.produced, sum.read);
  const bool may_come = x.reader.newest_at && now - *x.reader.newest_at <= in_flight_max + x.every;
  if (may_come && x.writer.newest_ms && x.reader.newest_ms && x.every > 0s) {
    const auto ahead = static_cast<std::int32_t>(*x.writer.newest_ms - *x.reader.newest_ms) * 1ms;
    if (ahead > 0ms && ahead <= in_flight_max)
      sum.open = std::min(unread, static_cast<std::uint64_t>((ahead + x.every / 2) / x.every));
  }
  sum.missing = unread - sum.open;
  return sum;
}

std::vector<half_open_stream> run_counters::half_open(instant now) const {
  std::vector<half_open_stream> found;
  for (const auto& [key, x] : all_.streams) {
    if (!x.writer.is_known || !x.reader.is_known || x.writer.open == x.reader.open)
      continue;
    found.push_back({x.sum.stream, x.writer.open ? x.sum.from : x.sum.to,
                     x.writer.open ? x.sum.to : x.sum.from,
                     now - std::max(x.writer.changed_at, x.reader.changed_at)});
  }
  return found;
}

void run_counters::settle_streams(run_report& x) const {
  const auto end = instant{} + x.simulated;
  for (const auto& [key, stream] : all_.streams)
    x.streams.push_back(settled(stream, end));
  for (const auto& [key, counters] : all_.programs) {
    auto& program = x.programs.emplace_back(counters.sum);
    if (program.kind != "stream_reader" || counters.read_ends.size() != 1)
      continue;
    const auto stream = settled(all_.streams.at(counters.read_ends.front()), end);
    const auto delivery = stream.delivery();
    if (stream.from.empty() || !delivery)
      continue; // nobody of this run writes it: the reader's own clock must do
    figure_of(program, "records missing") = static_cast<double>(stream.missing);
    figure_of(program, "delivery %") = 100 * *delivery;
  }
}

namespace {

/// What was handed over is in transit until the other process says that it has arrived.
carried_report settled(const sender_account& x) {
  carried_report out{x.sent, x.arrived, x.lost, 0};
  out.arrived += std::min(x.handed_over, x.came_over);
  out.in_transit = above(out.sent, out.arrived + total(out.lost));
  return out;
}

} // namespace

carried_report run_counters::carried(const mote_address& who, message_kind kind) const {
  const auto found = all_.accounts.find({who, std::string(to_string(kind))});
  return found == all_.accounts.end() ? carried_report{} : rubicon::report::settled(found->second);
}

void run_counters::settle_messages(run_report& x) const {
  const auto whole = [this](const mote_address& who, message_report sum) {
    auto account = carried(who, message_kind::message);
    sum.arrived = account.arrived;
    sum.lost = std::move(account.lost);
    sum.in_transit = account.in_transit;
    return sum;
  };
  for (const auto& [who, sum] : all_.messages) {
    const auto island = std::ranges::find(x.islands, who.island, &island_report::id);
    if (island == x.islands.end())
      continue;
    const auto all = whole(who, sum);
    island->messages += all;
    const auto mote = std::ranges::find(island->motes, who, &mote_report::address);
    if (mote != island->motes.end())
      mote->messages = all;
  }
  for (const auto& [who, sum] : all_.pcs)
    x.pc_messages += whole(who, sum);
}

/// Of channels and tunnels, and where all has been lost.
void run_counters::settle_packets(run_report& x) const {
  for (const auto& [key, account] : all_.accounts) {
    const auto& [who, kind] = key;
    if (kind == to_string(message_kind::tunnel))
      x.tunnels += rubicon::report::settled(account);
    const auto island = std::ranges::find(x.islands, who.island, &island_report::id);
    if (kind == to_string(message_kind::channel) && island != x.islands.end())
      island->network.channel_packets += rubicon::report::settled(account);
  }
  for (const auto& [where, count] : all_.losses)
    x.losses.push_back({std::get<0>(where), std::get<1>(where), std::get<2>(where), count});
  std::ranges::stable_sort(x.losses, std::greater(), &loss_report::count);
}

void run_counters::settle(run_report& x) const {
  settle_streams(x);
  settle_messages(x);
  settle_packets(x);
  for (const auto& [name, proxy] : all_.proxies)
    if (proxy.status != "ended" || proxy.actuations.requested > 0)
      x.proxies.push_back(proxy);
  for (const auto& [peer, counters] : all_.modules)
    x.modules.push_back({peer, counters});
}

} // namespace rubicon::report
