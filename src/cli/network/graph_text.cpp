#include "cli/network/graph_text.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "cli/network/network_text.hpp"
#include "core/text/printable.hpp"
#include "peis/subscribers/subscription_index.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t value_octets_drawn = 60; ///< shown of one value

bool is_of_kernel(const peis::key& x) {
  return x.folded().starts_with("kernel.");
}

/// `40 kitchen-pc`: an id and the program's part of a name.
std::string who(const ecology_graph& x, peer_id host) {
  if (host == any_peer)
    return "any";
  const auto found = x.names.find(host);
  const auto name = found == x.names.end() ? std::string() : found->second;
  const auto program = name.substr(0, name.find('@'));
  return to_string(host) + (program.empty() ? "" : ' ' + printable(program));
}

std::string key_text(const peis::key& x) {
  return x.any() ? "(all)" : printable(x.text());
}

std::string whole_number(std::uint64_t x) {
  return report::with_thousands(x);
}

/// Takes a number off the front. @returns nothing if there is none
std::optional<std::int32_t> take_number(std::string_view& text) {
  std::int32_t x = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc{})
    return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return x;
}

bool take(std::string_view& text, std::string_view word) {
  if (!text.starts_with(word))
    return false;
  text.remove_prefix(word.size());
  return true;
}

/// `( 30 -1.*.*.temperature )`
std::optional<graph_subscription> read_line(std::string_view line) {
  while (line.starts_with(' '))
    line.remove_prefix(1);
  if (!take(line, "( ") || !line.ends_with(" )"))
    return std::nullopt;
  line.remove_suffix(2);
  const auto host = take_number(line);
  if (!host || *host < 1 || !take(line, " "))
    return std::nullopt;
  const auto owner = take_number(line);
  if (!owner || !take(line, "."))
    return std::nullopt;
  auto wanted = peis::key::from_wire(line);
  if (!wanted)
    return std::nullopt;
  return graph_subscription{peer_id{*host}, peer_id{*owner}, *std::move(wanted), 0};
}

auto order_of(const graph_subscription& x) {
  return std::tuple(x.host, x.owner, std::string_view(x.wanted.folded()));
}

report::table peers_table(const ecology_graph& x) {
  std::map<peer_id, std::pair<std::uint64_t, std::uint64_t>> counts; // tuples, subscriptions
  for (const auto& [host, name] : x.names)
    counts[host];
  for (const auto& each : x.tuples)
    ++counts[each.content->owner].first;
  for (const auto& each : x.subscriptions)
    ++counts[each.host].second;
  report::table rows({{"id", report::align::right},
                      {"component"},
                      {"tuples", report::align::right},
                      {"subscribes to", report::align::right}});
  for (const auto& [host, count] : counts) {
    const auto found = x.names.find(host);
    rows.add({to_string(host),
              found == x.names.end() || found->second.empty() ? "?" : printable(found->second),
              whole_number(count.first), whole_number(count.second)});
  }
  return rows;
}

report::table subscriptions_table(const ecology_graph& x) {
  report::table rows({{"subscriber"}, {"whose"}, {"key"}, {"tuples there", report::align::right}});
  for (const auto& each : x.subscriptions)
    rows.add(
        {who(x, each.host), who(x, each.owner), key_text(each.wanted), whole_number(each.tuples)});
  if (x.left_out > 0)
    rows.add_note("… and " + whole_number(x.left_out) + " more");
  return rows;
}

std::string subscribers_text(const ecology_graph& x, const graph_tuple& y) {
  std::string text;
  for (const auto host : y.subscribers)
    text += (text.empty() ? "" : ", ") + who(x, host);
  return text;
}

report::table tuples_table(const ecology_graph& x) {
  report::table rows({{"owner"}, {"key"}, {"value"}, {"subscribers"}});
  for (const auto& each : x.tuples)
    rows.add({who(x, each.content->owner), printable(each.content->name.text()),
              printable(value_text(*each.content), value_octets_drawn), subscribers_text(x, each)});
  return rows;
}

report::table meta_table(const ecology_graph& x) {
  std::set<std::pair<peer_id, std::string_view>> there;
  for (const auto& each : x.tuples)
    there.emplace(each.content->owner, each.content->name.folded());
  report::table rows({{"owner"}, {"meta tuple"}, {"points at"}, {"key"}, {""}});
  for (const auto& each : x.tuples) {
    if (!each.meta)
      continue;
    const auto owner = who(x, each.content->owner);
    const auto key = printable(each.content->name.text());
    if (!*each.meta)
      rows.add({owner, key, "nowhere"});
    else
      rows.add({owner, key, who(x, (*each.meta)->owner), key_text((*each.meta)->name),
                there.contains({(*each.meta)->owner, (*each.meta)->name.folded()})
                    ? ""
                    : "no such tuple"});
  }
  return rows;
}

/// Between quotes of dot.
std::string dot_text(std::string_view x) {
  std::string text = "\"";
  for (const char each : printable(x)) {
    if (each == '"' || each == '\\')
      text += '\\';
    text += each;
  }
  return text + '"';
}

std::string node_of(peer_id owner, const peis::key& name) {
  return dot_text(to_string(owner) + ' ' + name.folded());
}

std::string node_of(peer_id host) {
  return dot_text("peer " + to_string(host));
}

using tuple_name = std::pair<peer_id, std::string>;

/// What arrows end at.
std::set<tuple_name> drawn_tuples(const ecology_graph& x) {
  std::set<tuple_name> drawn;
  for (const auto& each : x.tuples) {
    if (each.meta || !each.subscribers.empty())
      drawn.emplace(each.content->owner, each.content->name.folded());
    if (each.meta && *each.meta)
      drawn.emplace((*each.meta)->owner, (*each.meta)->name.folded());
  }
  return drawn;
}

std::string cluster_of(const ecology_graph& x, peer_id host, const std::set<tuple_name>& drawn) {
  const auto of_host = [host](const auto& y) { return y.content->owner == host; };
  const auto count = std::ranges::count_if(x.tuples, of_host);
  auto text = "  subgraph " + dot_text("cluster " + to_string(host)) +
              " {\n    label=" + dot_text(who(x, host)) + ";\n    " + node_of(host) +
              " [shape=box, label=" +
              dot_text(report::counted(static_cast<std::uint64_t>(count), "tuple")) + "];\n";
  for (const auto& each : x.tuples)
    if (of_host(each) && drawn.contains({host, each.content->name.folded()}))
      text += "    " + node_of(host, each.content->name) +
              " [label=" + dot_text(each.content->name.text()) + "];\n";
  return text + "  }\n";
}

} // namespace

std::vector<graph_subscription> read_subscribers(std::string_view text) {
  std::vector<graph_subscription> all;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    if (auto line = read_line(text.substr(0, end)))
      all.push_back(*std::move(line));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return all;
}

ecology_graph graph_of(std::map<peer_id, std::string> names,
                       const std::vector<peis::tuple_pointer>& tuples, peer_id self, bool all) {
  ecology_graph x;
  x.names = std::move(names);
  x.names.erase(self);
  for (const auto& each : tuples) {
    if (each->owner == self)
      continue;
    if (each->name.folded() == "kernel.subscribers")
      for (auto& one : read_subscribers(each->text()))
        if (one.host != self && (all || !is_of_kernel(one.wanted)))
          x.subscriptions.push_back(std::move(one));
    if (!all && is_of_kernel(each->name))
      continue;
    graph_tuple found{each, {}, std::nullopt};
    if (const auto meta = peis::read_meta(*each))
      found.meta.emplace(*meta);
    x.tuples.push_back(std::move(found));
  }
  std::ranges::sort(x.subscriptions, {}, order_of);
  const auto is_repeated = [](const auto& a, const auto& b) { return order_of(a) == order_of(b); };
  x.subscriptions.erase(std::unique(x.subscriptions.begin(), x.subscriptions.end(), is_repeated),
                        x.subscriptions.end());
  if (x.subscriptions.size() > graph_subscriptions_max) {
    x.left_out = x.subscriptions.size() - graph_subscriptions_max;
    x.subscriptions.resize(graph_subscriptions_max);
  }
  peis::subscription_index<graph_subscription*> wanted;
  for (auto& each : x.subscriptions)
    wanted.insert(each.wanted, &each);
  for (auto& each : x.tuples)
    wanted.for_matching(each.content->name, [&each](graph_subscription* y) {
      if (y->owner != any_peer && y->owner != each.content->owner)
        return;
      ++y->tuples;
      if (y->host != each.content->owner)
        each.subscribers.insert(y->host);
    });
  std::ranges::sort(x.tuples, {}, [](const graph_tuple& y) {
    return std::pair(y.content->owner, std::string_view(y.content->name.folded()));
  });
  return x;
}

std::string graph_text(const ecology_graph& x, std::size_t width, bool colour) {
  std::string text;
  const auto add = [&](const std::string& title, const report::table& rows) {
    if (rows.empty())
      return;
    text += (text.empty() ? "" : "\n") + report::painted(title, report::look::strong, colour) +
            '\n' + rows.render(width, colour);
  };
  add("Peers", peers_table(x));
  add("Subscriptions", subscriptions_table(x));
  add("Meta tuples", meta_table(x));
  add("Tuples", tuples_table(x));
  return text;
}

std::string to_json(const ecology_graph& x) {
  nlohmann::ordered_json out{{"peers", nlohmann::ordered_json::array()},
                             {"subscriptions", nlohmann::ordered_json::array()},
                             {"subscriptions_left_out", x.left_out},
                             {"tuples", nlohmann::ordered_json::array()}};
  for (const auto& [host, name] : x.names)
    out["peers"].push_back({{"id", host.value}, {"name", name}});
  for (const auto& each : x.subscriptions) {
    nlohmann::ordered_json row{{"host", each.host.value}};
    row["owner"] = each.owner == any_peer ? nlohmann::ordered_json()
                                          : nlohmann::ordered_json(each.owner.value);
    row["key"] = each.wanted.text();
    row["tuples"] = each.tuples;
    out["subscriptions"].push_back(std::move(row));
  }
  for (const auto& each : x.tuples) {
    auto row = cli::to_json(*each.content);
    row["subscribers"] = nlohmann::ordered_json::array();
    for (const auto host : each.subscribers)
      row["subscribers"].push_back(host.value);
    if (each.meta)
      row["points_at"] = *each.meta ? nlohmann::ordered_json{{"owner", (*each.meta)->owner.value},
                                                             {"key", (*each.meta)->name.text()}}
                                    : nlohmann::ordered_json();
    out["tuples"].push_back(std::move(row));
  }
  return line_of(out);
}

std::string to_dot(const ecology_graph& x) {
  const auto drawn = drawn_tuples(x);
  std::set<peer_id> hosts;
  for (const auto& [host, name] : x.names)
    hosts.insert(host);
  for (const auto& [owner, key] : drawn)
    hosts.insert(owner);
  for (const auto& each : x.tuples)
    hosts.insert(each.subscribers.begin(), each.subscribers.end());
  std::string text = "digraph ecology {\n  rankdir=LR;\n  node [shape=ellipse, fontsize=10];\n";
  for (const auto host : hosts)
    text += cluster_of(x, host, drawn);
  for (const auto& each : x.tuples) {
    const auto from = node_of(each.content->owner, each.content->name);
    for (const auto host : each.subscribers)
      text += "  " + from + " -> " + node_of(host) + ";\n";
    if (each.meta && *each.meta)
      text += "  " + from + " -> " + node_of((*each.meta)->owner, (*each.meta)->name) +
              " [style=dashed];\n";
  }
  return text + "}\n";
}

} // namespace rubicon::cli
