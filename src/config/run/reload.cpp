#include "config/run/reload.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "config/run/change_text.hpp"
#include "config/toml/units.hpp"

namespace rubicon::config {

namespace {

/// Keys from the root to a value; elements of arrays are left out.
using key_path = std::vector<std::string_view>;

template <std::size_t size>
bool among(const std::array<std::string_view, size>& all, std::string_view x) {
  return std::ranges::find(all, x) != all.end();
}

/// Whether two values are the same, wherever they stand.
bool equal(const node& a, const node& b) {
  if (a.content.index() != b.content.index())
    return false;
  if (const auto* members = a.as<node_table>())
    return members->size() == b.as<node_table>()->size() &&
           std::ranges::all_of(*members, [&b](const member& x) {
             const auto* other = b.find(x.key);
             return other != nullptr && equal(x.value, *other);
           });
  if (const auto* elements = a.as<node_array>())
    return std::ranges::equal(*elements, *b.as<node_array>(), equal);
  const auto same = [&](const auto* x, const auto* y) { return x != nullptr && *x == *y; };
  return same(a.as<std::string>(), b.as<std::string>()) ||
         same(a.as<std::int64_t>(), b.as<std::int64_t>()) || same(a.as<double>(), b.as<double>()) ||
         same(a.as<bool>(), b.as<bool>());
}

/// Finds what differs and cannot follow.
class comparison {
public:
  explicit comparison(complaints& out) : out_(out) {}

  void compare_tables(const node& before, const node& now) {
    const auto& members = *now.as<node_table>();
    for (const auto& x : members) {
      path_.push_back(x.key);
      if (!follows(now)) {
        const auto* old = before.find(x.key);
        if (old != nullptr || x.value.as<node_table>() != nullptr)
          compare(old != nullptr ? *old : no_keys, x.value);
        else
          refuse(x.value.at, "is new");
      }
      path_.pop_back();
    }
    for (const auto& x : *before.as<node_table>()) {
      if (now.find(x.key) != nullptr)
        continue;
      path_.push_back(x.key);
      if (x.value.as<node_table>() != nullptr)
        compare_tables(x.value, node{now.at, node_table{}});
      else if (!follows(now) || among(never_unset, x.key))
        refuse(now.at, "is gone");
      path_.pop_back();
    }
  }

private:
  void compare(const node& before, const node& now) {
    const auto* elements = now.as<node_array>();
    if (now.as<node_table>() != nullptr && before.as<node_table>() != nullptr)
      compare_tables(before, now);
    else if (elements != nullptr && before.as<node_array>() != nullptr)
      compare_elements(*before.as<node_array>(), *elements, now.at);
    else if (!equal(before, now))
      refuse(now.at, "differs");
  }

  void compare_elements(const node_array& before, const node_array& now, mark at) {
    for (std::size_t i = 0; i < std::min(before.size(), now.size()); ++i)
      compare(before[i], now[i]);
    if (now.size() > before.size())
      refuse(now[before.size()].at, "has more");
    else if (now.size() < before.size())
      refuse(at, "has fewer");
  }

  /// Whether what is there is compared by what it means.
  [[nodiscard]] bool follows(const node& table) const {
    const auto last = path_.back();
    if (path_.size() == 1)
      return last == "fault" || last == "change";
    if (path_.size() == 2 && path_[0] == "radio")
      return last == "link";
    if (path_.size() == 2 && path_[0] == "smepp")
      return last == "network_key" || last == "network_mac";
    if (path_.size() == 3 && path_[0] == "proxy")
      return (path_[1] == "qos" && among(qos, last)) || (path_[1] == "field" && among(field, last));
    const auto* app = table.find("app");
    const auto* kind = app == nullptr ? nullptr : app->as<std::string>();
    return last == "every" && path_[0] != "peer" && kind != nullptr &&
           (*kind == "sampler" || *kind == "messenger");
  }

  void refuse(mark at, const char* how) {
    std::string keys;
    for (const auto key : path_)
      keys += (keys.empty() ? "" : ".") + std::string(key);
    const auto why = why_fixed(path_.size() > 1 && path_[0] == "ecology" ? path_.back() : path_[0]);
    out_.add(at, '`' + keys + "` " + how + ", and cannot change while an ecology runs" +
                     (why.empty() ? std::string() : ": it " + std::string(why)));
  }

  static constexpr std::array<std::string_view, 6> qos{
      "answer_timeout", "retry_for", "period", "stale_after", "inactive_after", "retire_after"};
  static constexpr std::array<std::string_view, 4> field{"unit", "scale", "add", "decimals"};
  static constexpr std::array<std::string_view, 5> never_unset{
      "period", "stale_after", "inactive_after", "retire_after", "unit"};

  complaints& out_;
  key_path path_;
};

// What follows.

const mote_description* find(const ecology_description& x, const mote_address& address) {
  const auto island = std::ranges::find(x.islands, address.island, &island_description::id);
  if (island == x.islands.end())
    return nullptr;
  const auto mote = std::ranges::find(island->motes, address.mote, &mote_description::id);
  return mote == island->motes.end() ? nullptr : &*mote;
}

void compare_rates(const ecology_description& before, const ecology_description& now,
                   std::vector<change>& out) {
  const auto compare = [&out](const mote_description& old, rate_change x) {
    const auto was = period_of(old.apps, x);
    if (was && *was != x.period)
      out.emplace_back(x);
  };
  for (const auto& island : now.islands) {
    for (const auto& mote : island.motes) {
      const auto* old = find(before, {island.id, mote.id});
      for (const auto& app : mote.apps) {
        rate_change x{.mote = {island.id, mote.id}};
        if (const auto* sampler = std::get_if<sampler_app>(&app)) {
          x.sampler = sampler->channel;
          x.period = sampler->every;
        } else if (const auto* messenger = std::get_if<messenger_app>(&app)) {
          x.messenger = messenger->am_type;
          x.period = messenger->every;
        }
        if (old != nullptr && (x.sampler || x.messenger))
          compare(*old, x);
      }
    }
  }
}

/// Links that the file no longer has cannot be made as if it had never had them.
void compare_links(const ecology_description& before, const ecology_description& now, mark at,
                   std::vector<change>& out, complaints& refused) {
  const auto same = [](const radio::link_override& x) {
    return [&x](const radio::link_override& y) { return x.from == y.from && x.to == y.to; };
  };
  for (const auto& x : now.radio.links) {
    const auto old = std::ranges::find_if(before.radio.links, same(x));
    const bool is_new = old == before.radio.links.end();
    if (is_new || old->loss != x.loss || old->gain_db != x.gain_db)
      out.emplace_back(link_change{x.from, x.to, x.loss, x.gain_db});
    if (!is_new && ((old->loss && !x.loss) || (old->gain_db && !x.gain_db)))
      refused.add(at,
                  "`radio.link` has a link without its former loss or gain: give its new value");
  }
  for (const auto& x : before.radio.links)
    if (std::ranges::none_of(now.radio.links, same(x)))
      refused.add(at, "`radio.link` lacks a link that has changed since the run began: give its "
                      "new loss and gain");
}

template <class T>
std::optional<T> news(const T& before, const T& now) {
  return before == now ? std::nullopt : std::optional(now);
}
template <class T>
std::optional<T> news(const std::optional<T>& before, const std::optional<T>& now) {
  return before == now ? std::nullopt : now;
}

void compare_classes(const ecology_description& before, const ecology_description& now,
                     std::vector<change>& out) {
  const auto add = [&out](proxy::class_change x) {
    if (!proxy::to_text(x).empty())
      out.emplace_back(std::move(x));
  };
  for (const auto& each : now.proxies) {
    const auto old = std::ranges::find(before.proxies, each.name, &proxy::proxy_class::name);
    if (old == before.proxies.end() || old->types.empty())
      continue;
    const auto& a = old->settings;
    const auto& b = each.settings;
    proxy::class_change x{.class_name = each.name};
    x.answer_timeout = news(a.answer_timeout, b.answer_timeout);
    x.retry_for = news(a.retry_for, b.retry_for);
    if (b.period > 0s) // else it was given up, which is refused
      x.period = news(a.period, b.period);
    if (b.stale_after > 0s)
      x.stale_after = news(a.stale_after, b.stale_after);
    x.inactive_after = news(a.inactive_after, b.inactive_after);
    x.retire_after = news(a.retire_after, b.retire_after);
    add(std::move(x));
    for (const auto& field : each.fields) {
      const auto was = std::ranges::find(old->fields, field.name, &proxy::field::name);
      if (was == old->fields.end())
        continue;
      proxy::class_change y{.class_name = each.name};
      y.field = field.name;
      y.unit = news(was->unit, field.unit);
      y.scale = news(was->scale, field.scale);
      y.add = news(was->add, field.add);
      y.decimals = news(was->decimals, field.decimals);
      add(std::move(y));
    }
  }
}

void compare_network_keys(const ecology_description& before, const ecology_description& now,
                          std::vector<change>& out) {
  const auto& a = before.smepp;
  const auto& b = now.smepp;
  if (before.seed != now.seed)
    return; // refused, and drawn keys with it
  if (a.network_key != b.network_key || a.network_mac != b.network_mac)
    out.emplace_back(network_keys_change{b.network_key.value_or(smepp::key()), b.network_mac, {}});
}

/// When a table of the plan happens for the first time.
duration time_of(const node& table) {
  for (const auto* key : {"at", "from"})
    if (const auto* found = table.find(key);
        found != nullptr && found->as<std::string>() != nullptr)
      return parse_duration(*found->as<std::string>()).value_or(duration{});
  return {};
}

const node_array& tables_of(const node& root, std::string_view key) {
  static const node_array none;
  const auto* found = root.find(key);
  const auto* tables = found == nullptr ? nullptr : found->as<node_array>();
  return tables == nullptr ? none : *tables;
}

/// Who is to be there was made when the run began.
bool needs_preparation(const fault& x) {
  const auto* crash = std::get_if<crash_fault>(&x);
  return std::holds_alternative<noise_fault>(x) || std::holds_alternative<mote_double_fault>(x) ||
         std::holds_alternative<move_island_fault>(x) || (crash != nullptr && crash->becomes);
}

class plan_comparison {
public:
  plan_comparison(const node& before, const node& now, duration at, reloaded& out,
                  complaints& refused)
      : before_(before), now_(now), at_(at), out_(out), refused_(refused) {}

  /// @param planned of the file as it is now, as sort_plan() has them
  void compare(std::string_view key, std::vector<fault_description> planned) {
    auto old = tables_of(before_, key);
    const auto& tables = tables_of(now_, key);
    std::vector<std::size_t> order(tables.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&tables](auto i) { return time_of(tables[i]); });
    for (std::size_t i = 0; i < order.size() && i < planned.size(); ++i) {
      const auto& table = tables[order[i]];
      const auto known =
          std::ranges::find_if(old, [&table](const node& x) { return equal(x, table); });
      if (known != old.end())
        old.erase(known); // a second one of the same is new
      else
        join(table, key, std::move(planned[i]));
    }
    const auto* all = now_.find(key);
    for (const auto& gone : old)
      if (time_of(gone) > at_)
        refused_.add(all == nullptr ? now_.at : all->at,
                     "a [[" + std::string(key) + "]] at " + to_text(time_of(gone)) +
                         " was removed from the file: planned actions remain planned");
  }

private:
  void join(const node& table, std::string_view key, fault_description x) {
    if (!x.repeated && x.at <= at_)
      refused_.add(table.at, "that [[" + std::string(key) + "]] is too late: it is " +
                                 to_text(at_) + " already");
    else if (needs_preparation(x.what))
      refused_.add(table.at,
                   "it needs something that exists from the start: a radio, or a second type");
    else
      out_.plan.push_back(std::move(x));
  }

  const node& before_;
  const node& now_;
  duration at_;
  reloaded& out_;
  complaints& refused_;
};

} // namespace

followed_file::followed_file(std::string_view toml, std::string name, overrides instead,
                             extensions known)
    : name_(std::move(name)), instead_(std::move(instead)), known_(std::move(known)) {
  auto parsed = resolve(toml, name_, instead_.settings);
  auto loaded = load_with_files(toml, name_, instead_, known_);
  if (auto* root = std::get_if<node>(&parsed); root != nullptr && loaded.ecology) {
    first_ = newest_ = *std::move(root);
    described_ = *std::move(loaded.ecology);
  }
}

reloaded followed_file::read(std::string_view toml, duration now) {
  reloaded out;
  auto parsed = resolve(toml, name_, instead_.settings);
  auto loaded = load_with_files(toml, name_, instead_, known_);
  if (!loaded.problems.empty()) {
    out.refused = std::move(loaded.problems);
    return out;
  }
  auto& root = std::get<node>(parsed);
  complaints refused;
  comparison(refused).compare_tables(first_, root);
  compare_rates(described_, *loaded.ecology, out.changes);
  const auto* radio = root.find("radio");
  compare_links(described_, *loaded.ecology, radio == nullptr ? root.at : radio->at, out.changes,
                refused);
  compare_classes(described_, *loaded.ecology, out.changes);
  compare_network_keys(described_, *loaded.ecology, out.changes);
  std::vector<fault_description> faults;
  std::vector<fault_description> changes;
  for (const auto& x : loaded.ecology->faults)
    (is_change(x) ? changes : faults).push_back(x);
  plan_comparison plan(newest_, root, now, out, refused);
  plan.compare("fault", std::move(faults));
  plan.compare("change", std::move(changes));
  out.refused = with_settings(refused.of_file(name_), instead_.settings);
  newest_ = std::move(root);
  described_ = *std::move(loaded.ecology);
  return out;
}

} // namespace rubicon::config
