#include "config/run/reload.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "apps/app_keys.hpp"
#include "config/plan/change.hpp"
#include "config/toml/schema.hpp"
#include "config/toml/units.hpp"
#include "core/describe/changes.hpp"
#include "proxy/classes/class_keys.hpp"

namespace rubicon::config {

namespace {

/// Keys from the root to a value; elements of arrays are left out.
using key_path = std::vector<std::string_view>;

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

/// What a file may say at a key of a table, as the table's own value at its choice has it; nullptr
/// if nothing is known of the key.
const key_description* described_key(const table_description* of, const node& table,
                                     std::string_view key) {
  if (of == nullptr)
    return nullptr;
  if (const auto* found = of->find(key))
    return found;
  const auto* choice = of->choice.empty() ? nullptr : table.find(of->choice);
  const auto* word = choice == nullptr ? nullptr : choice->as<std::string>();
  const auto* variant = word == nullptr ? nullptr : of->variant(*word);
  if (const auto* found = variant == nullptr ? nullptr : variant->find(key))
    return found;
  const auto others = std::ranges::find(of->keys, part::other_tables, &key_description::part);
  return others == of->keys.end() ? nullptr : &*others;
}

/// Finds what differs and cannot follow.
class comparison {
public:
  explicit comparison(complaints& out) : out_(out) {}

  /// @param of what the file may say there
  void compare_tables(const node& before, const node& now, const table_description* of) {
    for (const auto& x : *now.as<node_table>()) {
      const auto* key = described_key(of, now, x.key);
      path_.push_back(x.key);
      if (key == nullptr || !key->is_changeable) {
        const auto* old = before.find(x.key);
        if (old != nullptr || x.value.as<node_table>() != nullptr)
          compare(old != nullptr ? *old : no_keys, x.value, key);
        else
          refuse(x.value.at, "is new");
      }
      path_.pop_back();
    }
    for (const auto& x : *before.as<node_table>()) {
      if (now.find(x.key) != nullptr)
        continue;
      const auto* key = described_key(of, before, x.key);
      path_.push_back(x.key);
      if (x.value.as<node_table>() != nullptr)
        compare_tables(x.value, node{now.at, node_table{}}, table_of(key));
      else if (key == nullptr || !key->is_changeable || !key->is_removable)
        refuse(now.at, "is gone");
      path_.pop_back();
    }
  }

private:
  static const table_description* table_of(const key_description* x) {
    return x == nullptr ? nullptr : x->table.get();
  }

  void compare(const node& before, const node& now, const key_description* key) {
    const auto* elements = now.as<node_array>();
    if (now.as<node_table>() != nullptr && before.as<node_table>() != nullptr)
      compare_inner(before, now, key);
    else if (elements != nullptr && before.as<node_array>() != nullptr)
      compare_elements(*before.as<node_array>(), *elements, now.at, key);
    else if (!equal(before, now))
      refuse(now.at, "differs");
  }

  /// A table, or tables whose names the file's author has chosen.
  void compare_inner(const node& before, const node& now, const key_description* key) {
    if (key == nullptr || key->part != part::named_tables)
      return compare_tables(before, now, table_of(key));
    table_description named;
    named.keys.push_back({.part = part::other_tables, .table = key->table});
    compare_tables(before, now, &named);
  }

  void compare_elements(const node_array& before, const node_array& now, mark at,
                        const key_description* key) {
    for (std::size_t i = 0; i < std::min(before.size(), now.size()); ++i)
      compare(before[i], now[i], key);
    if (now.size() > before.size())
      refuse(now[before.size()].at, "has more");
    else if (now.size() < before.size())
      refuse(at, "has fewer");
  }

  void refuse(mark at, const char* how) {
    std::string keys;
    for (const auto key : path_)
      keys += (keys.empty() ? "" : ".") + std::string(key);
    const auto why = why_fixed(path_.size() > 1 && path_[0] == "ecology" ? path_.back() : path_[0]);
    out_.add(at, '`' + keys + "` " + how + ", and cannot change while an ecology runs" +
                     (why.empty() ? std::string() : ": it " + std::string(why)));
  }

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

/// The program of the same kind and number among those of before; nullptr if there is none.
template <class App, class Number>
const App* program_before(const mote_description& mote, const App& now, Number App::*number) {
  for (const auto& each : mote.apps)
    if (const auto* app = std::get_if<App>(&each); app != nullptr && app->*number == now.*number)
      return app;
  return nullptr;
}

void compare_programs(const mote_description& before, const mote_description& now, mote_address at,
                      std::vector<change>& out) {
  const auto add = [&out](program_change x) {
    if (!x.settings.empty())
      out.emplace_back(std::move(x));
  };
  for (const auto& app : now.apps) {
    if (const auto* sampler = std::get_if<sampler_app>(&app)) {
      if (const auto* old = program_before(before, *sampler, &sampler_app::channel))
        add({.mote = at,
             .sampler = sampler->channel,
             .settings = keys::changes_between(*old, *sampler)});
    } else if (const auto* messenger = std::get_if<messenger_app>(&app)) {
      if (const auto* old = program_before(before, *messenger, &messenger_app::am_type))
        add({.mote = at,
             .messenger = messenger->am_type,
             .settings = keys::changes_between(*old, *messenger)});
    }
  }
}

void compare_programs(const ecology_description& before, const ecology_description& now,
                      std::vector<change>& out) {
  for (const auto& island : now.islands)
    for (const auto& mote : island.motes)
      if (const auto* old = find(before, {island.id, mote.id}))
        compare_programs(*old, mote, {island.id, mote.id}, out);
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

void compare_classes(const ecology_description& before, const ecology_description& now,
                     std::vector<change>& out) {
  const auto add = [&out](proxy::class_change x) {
    if (!x.settings.empty() || !x.field_settings.empty())
      out.emplace_back(std::move(x));
  };
  for (const auto& each : now.proxies) {
    const auto old = std::ranges::find(before.proxies, each.name, &proxy::proxy_class::name);
    if (old == before.proxies.end() || old->types.empty())
      continue;
    add({.class_name = each.name, .settings = keys::changes_between(old->settings, each.settings)});
    for (const auto& field : each.fields) {
      const auto was = std::ranges::find(old->fields, field.name, &proxy::field::name);
      if (was != old->fields.end())
        add({.class_name = each.name,
             .field = field.name,
             .field_settings = keys::changes_between(*was, field)});
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
  auto parsed = resolve(toml, name_, instead_.settings, instead_.seed);
  auto loaded = load_with_files(toml, name_, instead_, known_);
  if (auto* root = std::get_if<node>(&parsed); root != nullptr && loaded.ecology) {
    first_ = newest_ = *std::move(root);
    described_ = *std::move(loaded.ecology);
  }
}

reloaded followed_file::read(std::string_view toml, duration now) {
  reloaded out;
  auto parsed = resolve(toml, name_, instead_.settings, instead_.seed);
  auto loaded = load_with_files(toml, name_, instead_, known_);
  if (!loaded.problems.empty()) {
    out.refused = std::move(loaded.problems);
    return out;
  }
  auto& root = std::get<node>(parsed);
  complaints refused;
  const auto file = describe_file();
  comparison(refused).compare_tables(first_, root, &file);
  compare_programs(described_, *loaded.ecology, out.changes);
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
