#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/network/network_text.hpp"
#include "cli/network/session.hpp"
#include "cli/print/console.hpp"
#include "config/summary_parts.hpp"
#include "peis/wire/link_url.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

constexpr duration ping_gap = 200ms;
constexpr duration ask_again_after = 1s;

struct known_host {
  const peis::host_record* record = nullptr; ///< nullptr: it has not described itself
  std::optional<unsigned> metric;            ///< unset: no route to it
};

/// Everybody but ourselves.
std::map<peer_id, known_host> known_hosts(const peer::standalone& peer) {
  std::map<peer_id, known_host> all;
  for (const auto* x : peer.network().hosts.records())
    all[x->id].record = x;
  for (const auto& [host, route] : peer.kernel().network().routes.routes().routes()) {
    if (!route.lost())
      all[host].metric = route.hops;
  }
  all.erase(peer.kernel().id());
  return all;
}

std::vector<std::string> urls_of(const peis::host_record* x) {
  std::vector<std::string> all;
  if (x != nullptr) {
    for (const auto& address : x->addresses)
      all.push_back(to_string(peis::url_of(address)));
  }
  return all;
}

std::string hosts_json(const std::map<peer_id, known_host>& all) {
  std::vector<nlohmann::ordered_json> rows;
  for (const auto& [host, x] : all) {
    nlohmann::ordered_json row;
    row["id"] = host.value;
    if (x.record != nullptr) {
      row["name"] = x.record->full_name;
      row["host"] = x.record->host_name;
      row["addresses"] = urls_of(x.record);
    }
    if (x.metric)
      row["metric"] = *x.metric;
    rows.push_back(std::move(row));
  }
  return lines_of(rows);
}

std::string hosts_table(const std::map<peer_id, known_host>& all) {
  report::table table({{"id", report::align::right},
                       {"component"},
                       {"host"},
                       {"metric", report::align::right},
                       {"addresses"}});
  for (const auto& [host, x] : all) {
    const auto* record = x.record;
    table.add({to_string(host), record ? report::printable(record->full_name) : "?",
               record ? report::printable(record->host_name) : "?",
               x.metric ? std::to_string(*x.metric) : "lost",
               config::joined(urls_of(record), " ")});
  }
  const auto output = console_of(stdout);
  return table.render(output.room(), output.colour);
}

/// The first answers of a peer that has only just received our announcement may find no route
/// back: asks again.
std::optional<std::vector<peer_id>> first_trace(const session& at, peer_id host) {
  const auto end = at.peer().now() + at.with.timeout;
  std::optional<std::vector<peer_id>> route;
  while (!route && at.peer().now() < end)
    route = at.peer().messages().trace(host,
                                       std::min<duration>(ask_again_after, end - at.peer().now()));
  return route;
}

std::string no_answer(const session& at, peer_id host) {
  return (at.peer().network().reachable(host) ? "no answer from peer " : "no route to peer ") +
         to_string(host);
}

} // namespace

exit_status perform(const session& at, const list_hosts&) {
  static_cast<void>(at.self.await_quiet(
      [&] {
        const auto all = known_hosts(at.peer());
        return std::all_of(all.begin(), all.end(),
                           [](const auto& x) { return x.second.record != nullptr; });
      },
      [&] { return at.peer().network().hosts.records().size(); }));
  const auto all = known_hosts(at.peer());
  return answer(at.with.json ? hosts_json(all) : hosts_table(all));
}

exit_status perform(const session& at, const trace_route& x) {
  const auto found = find_peer(at, x.host);
  if (const auto* why = std::get_if<std::string>(&found))
    return fail(*why);
  const auto host = std::get<peer_id>(found);
  const auto route = first_trace(at, host);
  if (!route)
    return fail(no_answer(at, host));
  if (at.with.json) {
    nlohmann::ordered_json out{{"host", host.value}, {"route", nlohmann::ordered_json::array()}};
    for (const auto& each : *route)
      out["route"].push_back(each.value);
    return answer(line_of(out));
  }
  report::table table({{"", report::align::right}, {"id", report::align::right}, {"component"}});
  for (std::size_t i = 0; i < route->size(); ++i)
    table.add(
        {std::to_string(i), to_string((*route)[i]), report::printable(name_of(at, (*route)[i]))});
  const auto output = console_of(stdout);
  return answer(table.render(output.room(), output.colour));
}

exit_status perform(const session& at, const ping_host& x) {
  const auto found = find_peer(at, x.host);
  if (const auto* why = std::get_if<std::string>(&found))
    return fail(*why);
  const auto host = std::get<peer_id>(found);
  if (!first_trace(at, host))
    return fail(no_answer(at, host));
  std::vector<double> all_ms;
  for (std::uint64_t i = 0; i < x.count; ++i) {
    if (i > 0)
      at.peer().run_until([] { return false; }, ping_gap);
    const auto begun = at.peer().now();
    const auto route = at.peer().messages().trace(host, at.with.timeout);
    const auto ms = 1e3 * seconds(at.peer().now() - begun);
    if (route)
      all_ms.push_back(ms);
    std::string text;
    if (at.with.json)
      continue;
    if (route)
      text = "peer " + to_string(host) + ": " + report::fixed(ms, 3) + " ms, " +
             report::counted(route->size() - 1, "hop") + " there and back\n";
    else
      text = "peer " + to_string(host) + ": no answer\n";
    if (!print(stdout, text))
      return exit_status::refused;
  }
  if (at.with.json) {
    const auto written = answer(line_of(
        {{"host", host.value}, {"sent", x.count}, {"answered", all_ms.size()}, {"ms", all_ms}}));
    if (written != exit_status::good)
      return written;
  }
  return all_ms.size() == x.count ? exit_status::good : exit_status::failed;
}

} // namespace rubicon::cli
