#include "cli/network/top_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <nlohmann/json.hpp>

#include "cli/network/network_text.hpp"
#include "core/text/printable.hpp"
#include "core/tuples/device_keys.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t value_octets_max = 40; ///< shown of one value
constexpr std::size_t values_max = 32;       ///< of one proxy
constexpr std::size_t roomy = 100;           ///< columns

using tuples_by_key = std::map<std::string_view, const peis::tuple*>; ///< of one owner, folded

std::string first_word(std::string_view x) {
  return std::string(x.substr(0, x.find(' ')));
}

/// The text of a tuple; empty if there is none.
std::string_view text_of(const tuples_by_key& all, std::string_view key) {
  const auto found = all.find(key);
  return found == all.end() ? std::string_view() : found->second->text();
}

std::optional<top_gateway> gateway_of(peer_id id, const tuples_by_key& all) {
  const auto list = parse_device_list(text_of(all, devices_key));
  if (!all.contains(devices_key) || !list)
    return std::nullopt;
  top_gateway x;
  x.id = id;
  x.line = first_word(text_of(all, device_line_key));
  x.role = first_word(text_of(all, device_role_key));
  for (const auto mote : *list)
    x.motes.push_back(mote.value);
  for (auto next = all.lower_bound("devices."); next != all.end(); ++next) {
    if (!next->first.starts_with("devices."))
      break;
    const auto key = parse_device_key(next->first);
    if (!key || key->what != device_tuple::status)
      continue;
    const auto status = parse_device_status(next->second->text());
    if (!status)
      continue;
    x.stale += status->presence == device_presence::stale ? 1 : 0;
    x.left += status->presence == device_presence::left ? 1 : 0;
  }
  return x;
}

/// Parts of keys that say something about a proxy itself (docs/gateway.md).
bool is_about_itself(std::string_view part) {
  static constexpr std::array<std::string_view, 7> known{
      "class", "description", "id", "interface", "island", "position", "status"};
  return std::ranges::find(known, part) != known.end() || part.starts_with("mi-");
}

/// Tuples one part below the prefix, with their units.
std::vector<std::pair<std::string, std::string>> values_of(const tuples_by_key& all,
                                                           const std::string& prefix) {
  std::vector<std::pair<std::string, std::string>> values;
  const auto front = prefix + '.';
  for (auto next = all.lower_bound(front); next != all.end(); ++next) {
    if (!next->first.starts_with(front) || values.size() == values_max)
      break;
    const auto part = next->first.substr(front.size());
    if (part.empty() || part.find('.') != std::string_view::npos || is_about_itself(part))
      continue;
    const auto unit = text_of(all, std::string(next->first) + ".unit");
    auto value = value_text(*next->second);
    if (!unit.empty())
      value += ' ' + std::string(unit);
    values.emplace_back(part, std::move(value));
  }
  return values;
}

/// A proxy says what it is: `PREFIX.status` alone may be anybody's.
std::vector<top_proxy> proxies_of(peer_id owner, const tuples_by_key& all) {
  constexpr std::string_view ending = ".status";
  std::vector<top_proxy> found;
  for (const auto& [key, tuple] : all) {
    if (!key.ends_with(ending))
      continue;
    const std::string prefix(key.substr(0, key.size() - ending.size()));
    if (!all.contains(prefix + ".class") || !all.contains(prefix + ".id"))
      continue;
    top_proxy x;
    x.owner = owner;
    x.prefix = prefix;
    x.mote = text_of(all, prefix + ".id");
    x.status = tuple->text();
    if (const auto cause = text_of(all, std::string(key) + ".cause");
        !cause.empty() && x.status != "active")
      x.status += ": " + std::string(cause);
    x.values = values_of(all, prefix);
    found.push_back(std::move(x));
  }
  return found;
}

/// Twice as lively, or half: who is nearly as lively as another stands beside him in the order of
/// their names, and stays there.
int activity(double changes_per_s) {
  constexpr int none = -100;
  return changes_per_s > 0 ? static_cast<int>(std::lround(std::log2(changes_per_s))) : none;
}

template <class List, class Name>
void sort_by_activity(List& all, Name name_of) {
  std::ranges::sort(all, [&](const auto& a, const auto& b) {
    return std::tuple(-activity(a.changes_per_s), name_of(a)) <
           std::tuple(-activity(b.changes_per_s), name_of(b));
  });
}

std::string rate(double x) {
  return x > 0 ? report::fixed(x, 1) : "";
}

std::string number(const std::optional<unsigned>& x) {
  return x ? std::to_string(*x) : "";
}

std::string motes_text(const std::vector<std::uint32_t>& all) {
  std::string text;
  for (const auto mote : all)
    text += (text.empty() ? "" : " ") + std::to_string(mote);
  return text;
}

/// `3 of 5 stale` and the like, of what is not as it should be.
std::string trouble_of(const top_gateway& x) {
  std::string text;
  if (x.stale > 0)
    text = std::to_string(x.stale) + " stale";
  if (x.left > 0)
    text += (text.empty() ? "" : ", ") + std::to_string(x.left) + " left";
  return text;
}

std::string values_text(const top_proxy& x) {
  std::string text;
  for (const auto& [name, value] : x.values)
    text += (text.empty() ? "" : ", ") + printable(name) + ' ' + printable(value, value_octets_max);
  return text;
}

/// Cuts the largest until all fit: what one does not need is the others'.
void share_rows(std::array<std::size_t, 3>& shown, std::size_t rows) {
  for (auto& each : shown)
    each = std::min(each, rows);
  while (shown[0] + shown[1] + shown[2] > rows)
    --*std::ranges::max_element(shown);
}

/// Without its process, and its computer if that is called the same: `kitchen-pc@basement`
std::string short_name(const std::string& x) {
  const auto name = x.substr(0, x.find('!'));
  const auto at = std::min(name.find('@'), name.size());
  const bool is_twice = name.substr(std::min(at + 1, name.size())) == name.substr(0, at);
  return name.empty() ? "?" : printable(is_twice ? name.substr(0, at) : name);
}

report::table peers_table(const top_picture& x, std::size_t shown) {
  report::table rows({{"id", report::align::right},
                      {"component"},
                      {"metric", report::align::right},
                      {"links", report::align::right},
                      {"tuples", report::align::right},
                      {"changes/s", report::align::right}});
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& each = x.peers[i];
    rows.add(
        {to_string(each.id), short_name(each.name),
         each.metric ? report::cell(number(each.metric)) : report::cell("lost", report::look::bad),
         number(each.links), report::with_thousands(each.tuples), rate(each.changes_per_s)});
  }
  return rows;
}

report::table gateways_table(const top_picture& x, std::size_t shown) {
  report::table rows({{"id", report::align::right},
                      {"gateway"},
                      {"line"},
                      {"role"},
                      {"motes", report::align::right},
                      {""},
                      {"listed"},
                      {"changes/s", report::align::right}});
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& each = x.gateways[i];
    rows.add({to_string(each.id),
              short_name(each.name),
              {printable(each.line), each.line == "up" ? report::look::plain : report::look::bad},
              printable(each.role),
              report::with_thousands(each.motes.size()),
              trouble_of(each),
              motes_text(each.motes),
              rate(each.changes_per_s)});
  }
  return rows;
}

/// Where there is little room, names and values matter more than whose they are.
report::table proxies_table(const top_picture& x, std::size_t shown, std::size_t width) {
  const bool has_room = width >= roomy;
  report::table rows({{"proxy"},
                      {"mote"},
                      {"owner", report::align::right},
                      {"status"},
                      {"changes/s", report::align::right},
                      {"values"}});
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& each = x.proxies[i];
    rows.add({printable(each.prefix),
              has_room ? printable(each.mote) : "",
              has_room ? to_string(each.owner) : "",
              {printable(each.status),
               each.status == "active" ? report::look::plain : report::look::bad},
              rate(each.changes_per_s),
              values_text(each)});
  }
  return rows;
}

std::string headline(const top_picture& x, std::size_t width, bool colour) {
  const auto text =
      printable(x.time + "  " + x.network + "  " + report::counted(x.peers.size(), "peer") + "  " +
                report::counted(x.tuples, "tuple") + "  " + report::fixed(x.changes_per_s, 1) +
                " changes/s  via " + x.via);
  return report::painted(report::cut(text, width), report::look::strong, colour) + '\n';
}

std::string page_of(const top_picture& x, const std::array<std::size_t, 3>& shown,
                    std::size_t width, bool colour) {
  auto text = headline(x, width, colour);
  const auto add = [&](const char* title, report::table rows, std::size_t taken, std::size_t all) {
    if (all == 0)
      return;
    if (taken < all)
      rows.add_note("… and " + report::with_thousands(all - taken) + " more");
    text += '\n' + report::painted(title, report::look::strong, colour) + '\n' +
            rows.render(width, colour);
  };
  add("Peers", peers_table(x, shown[0]), shown[0], x.peers.size());
  add("Gateways", gateways_table(x, shown[1]), shown[1], x.gateways.size());
  add("Proxies", proxies_table(x, shown[2], width), shown[2], x.proxies.size());
  return text;
}

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

} // namespace

/// From counts to rates, row by row of one picture.
class top_observer::rates {
public:
  rates(top_observer& of, duration gone)
      : of_(of), before_(std::exchange(of.rates_, {})), gone_s_(seconds(gone)),
        weight_(1 - std::exp(-gone_s_ / seconds(remembered))) {}

  /// Of the changes of keys that begin so.
  double of(peer_id owner, const std::string& front) {
    return averaged({owner, front}, count(owner, front));
  }
  /// Of all.
  double of_all() {
    std::uint64_t all = 0;
    for (const auto& [key, changes] : of_.changes_)
      all += changes;
    return averaged({any_peer, {}}, all);
  }

private:
  [[nodiscard]] std::uint64_t count(peer_id owner, const std::string& front) const {
    std::uint64_t all = 0;
    for (auto next = of_.changes_.lower_bound({owner, front}); next != of_.changes_.end(); ++next) {
      if (next->first.first != owner || !next->first.second.starts_with(front))
        break;
      all += next->second;
    }
    return all;
  }

  double averaged(const name& row, std::uint64_t changes) {
    const auto now = gone_s_ > 0 ? static_cast<double>(changes) / gone_s_ : 0;
    const auto known = before_.find(row);
    auto x = known == before_.end() ? now : known->second + weight_ * (now - known->second);
    constexpr double least = 0.05; // is shown as 0.1
    if (x < least)
      x = 0;
    return of_.rates_[row] = x;
  }

  top_observer& of_;
  std::map<name, double> before_;
  double gone_s_;
  double weight_; ///< of what is new
};

void top_observer::on_change(const peis::tuple& x) {
  if (is_of_kernel(x))
    return;
  const name changed(x.owner, x.name.folded());
  if (changes_.size() >= keys_max && !changes_.contains(changed))
    ++changes_[{x.owner, {}}]; // of the owner at least
  else
    ++changes_[changed];
}

top_picture top_observer::look(const std::map<peer_id, top_host>& hosts,
                               const std::vector<peis::tuple_pointer>& tuples, duration gone) {
  top_picture x;
  rates per_s(*this, gone);
  std::map<peer_id, tuples_by_key> by_owner;
  for (const auto& [host, known] : hosts)
    by_owner[host];
  for (const auto& each : tuples)
    if (!is_of_kernel(*each))
      by_owner[each->owner].emplace(each->name.folded(), each.get());
  for (const auto& [owner, own] : by_owner) {
    top_peer peer;
    peer.id = owner;
    if (const auto known = hosts.find(owner); known != hosts.end()) {
      peer.name = known->second.name;
      peer.metric = known->second.metric;
      peer.links = known->second.links;
    }
    peer.tuples = own.size();
    peer.changes_per_s = per_s.of(owner, "");
    x.tuples += own.size();
    if (auto gateway = gateway_of(owner, own)) {
      gateway->name = peer.name;
      gateway->changes_per_s = per_s.of(owner, "devices");
      x.gateways.push_back(*std::move(gateway));
    }
    for (auto& proxy : proxies_of(owner, own)) {
      proxy.changes_per_s = per_s.of(owner, proxy.prefix + '.');
      x.proxies.push_back(std::move(proxy));
    }
    x.peers.push_back(std::move(peer));
  }
  x.changes_per_s = per_s.of_all();
  changes_.clear();
  sort_by_activity(x.peers, [](const auto& y) { return y.id; });
  sort_by_activity(x.gateways, [](const auto& y) { return y.id; });
  sort_by_activity(x.proxies, [](const auto& y) { return std::tuple(y.prefix, y.owner); });
  return x;
}

std::string top_text(const top_picture& x, std::size_t width, std::optional<std::size_t> height,
                     bool colour) {
  std::array shown{x.peers.size(), x.gateways.size(), x.proxies.size()};
  if (!height)
    return page_of(x, shown, width, colour);
  auto rows = *height;
  share_rows(shown, rows);
  auto text = page_of(x, shown, width, colour);
  // Headings need lines, and so do notes on rows and columns that are left out.
  for (auto lines = line_count(text); lines > *height && rows > 0; lines = line_count(text)) {
    rows -= std::min(rows, lines - *height);
    share_rows(shown, rows);
    text = page_of(x, shown, width, colour);
  }
  return text;
}

std::string top_json(const top_picture& x) {
  using nlohmann::ordered_json;
  ordered_json out{{"network", x.network},
                   {"via", x.via},
                   {"tuples", x.tuples},
                   {"changes_per_s", x.changes_per_s},
                   {"peers", ordered_json::array()},
                   {"gateways", ordered_json::array()},
                   {"proxies", ordered_json::array()}};
  const auto or_null = [](const std::optional<unsigned>& y) {
    return y ? ordered_json(*y) : ordered_json();
  };
  for (const auto& each : x.peers)
    out["peers"].push_back({{"id", each.id.value},
                            {"name", each.name},
                            {"metric", or_null(each.metric)},
                            {"links", or_null(each.links)},
                            {"tuples", each.tuples},
                            {"changes_per_s", each.changes_per_s}});
  for (const auto& each : x.gateways)
    out["gateways"].push_back({{"id", each.id.value},
                               {"name", each.name},
                               {"line", each.line},
                               {"role", each.role},
                               {"motes", each.motes},
                               {"stale", each.stale},
                               {"left", each.left},
                               {"changes_per_s", each.changes_per_s}});
  for (const auto& each : x.proxies) {
    ordered_json row{{"owner", each.owner.value},
                     {"proxy", each.prefix},
                     {"mote", each.mote},
                     {"status", each.status},
                     {"values", ordered_json::object()},
                     {"changes_per_s", each.changes_per_s}};
    for (const auto& [name, value] : each.values)
      row["values"][name] = value;
    out["proxies"].push_back(std::move(row));
  }
  return line_of(out);
}

} // namespace rubicon::cli
