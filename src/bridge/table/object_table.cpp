#include "bridge/table/object_table.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "core/text/name.hpp"
#include "core/tuples/tuple_key.hpp"

namespace rubicon::bridge {

namespace {

constexpr std::string_view outcome_suffix = ".outcome";

/// Whether a prefix is of these parts, of which `*` is any.
bool matches(std::string_view pattern, std::string_view prefix) {
  while (true) {
    const auto dot = pattern.find('.');
    const auto other = prefix.find('.');
    const auto part = pattern.substr(0, dot);
    if (part != "*" && folded(part) != folded(prefix.substr(0, other)))
      return false;
    if (dot == std::string_view::npos || other == std::string_view::npos)
      return dot == other;
    pattern.remove_prefix(dot + 1);
    prefix.remove_prefix(other + 1);
  }
}

bool is_plain(std::string_view name) {
  return !name.empty() &&
         std::ranges::all_of(name, [](char c) { return c == '.' || is_name_character(c); });
}

} // namespace

object_table::object_table(std::vector<class_model> classes, std::size_t objects_max)
    : classes_(std::move(classes)), objects_max_(objects_max) {}

std::vector<std::string> object_table::watched() const {
  std::set<std::string> keys;
  for (const auto& each : classes_)
    for (const auto& suffix : suffixes_of(each))
      keys.insert(each.pattern + '.' + suffix);
  return {keys.begin(), keys.end()};
}

std::optional<object_table::place> object_table::place_of(std::string_view key) const {
  if (!is_plain(key) || !fits_tuple_key(key))
    return std::nullopt;
  const bool is_outcome = key.ends_with(outcome_suffix);
  const auto end = is_outcome ? key.size() - outcome_suffix.size() : key.size();
  const auto dot = key.substr(0, end).rfind('.');
  if (dot == std::string_view::npos)
    return std::nullopt;
  const auto name = key.substr(0, dot);
  if (std::ranges::none_of(classes_, [&](const auto& each) { return matches(each.pattern, name); }))
    return std::nullopt;
  return place{std::string(name), std::string(key.substr(dot + 1))};
}

std::optional<std::size_t> object_table::class_of(std::string_view name,
                                                  std::string_view prefix) const {
  for (std::size_t i = 0; i < classes_.size(); ++i)
    if (classes_[i].name == name && matches(classes_[i].pattern, prefix))
      return i;
  return std::nullopt;
}

std::vector<change> object_table::on_tuple(const components::news& x) {
  const auto at = place_of(x.key);
  if (!at) {
    ++counters_.bad_names;
    return {};
  }
  if (x.deleted)
    return on_deleted(*at, x);
  if (x.text.size() > value_max) {
    ++counters_.bad_values;
    return {};
  }
  const auto name = folded(at->name);
  auto found = entries_.find(name);
  if (found == entries_.end()) {
    if (entries_.size() >= objects_max_) {
      ++counters_.table_full;
      return {};
    }
    found = entries_.try_emplace(name).first;
    found->second.what.owner = x.owner;
    found->second.what.name = at->name;
  }
  ++counters_.values;
  if (at->suffix == "class")
    return on_class(found->second, x);
  if (found->second.what.owner != x.owner) {
    if (found->second.known)
      return {};
    found->second.what = {x.owner, at->name, 0, {}, {}, {}, {}};
  }
  return on_value(found->second, at->suffix, x);
}

std::vector<change> object_table::on_class(entry& at, const components::news& x) {
  const auto model = class_of(x.text, at.what.name);
  const bool same = at.known && at.what.owner == x.owner && model && *model == at.what.model;
  if (same)
    return {};
  std::vector<change> out;
  if (at.what.owner != x.owner)
    at.what = {x.owner, at.what.name, 0, {}, {}, {}, {}};
  if (std::exchange(at.known, model.has_value()) && !model) {
    ++counters_.disappeared;
    out.push_back({change_kind::disappeared, at.what.name, {}});
  }
  if (!model)
    return out;
  at.what.model = *model;
  ++counters_.appeared;
  out.push_back({change_kind::appeared, at.what.name, {}});
  return out;
}

std::vector<change> object_table::on_deleted(const place& at, const components::news& x) {
  const auto found = entries_.find(folded(at.name));
  if (found == entries_.end() || found->second.what.owner != x.owner)
    return {};
  auto& what = found->second.what;
  if (at.suffix == "class") {
    change gone{change_kind::disappeared, what.name, {}};
    const bool known = found->second.known;
    entries_.erase(found);
    if (!known)
      return {};
    ++counters_.disappeared;
    return {std::move(gone)};
  }
  change out{change_kind::value, what.name, {}};
  if (at.suffix == "status") {
    what.status.clear();
    out.what = change_kind::availability;
  } else if (at.suffix.ends_with(outcome_suffix))
    what.outcomes.erase(at.suffix.substr(0, at.suffix.size() - outcome_suffix.size()));
  else
    what.values.erase(at.suffix);
  if (found->second.known)
    return {std::move(out)};
  if (what.status.empty() && what.values.empty() && what.outcomes.empty())
    entries_.erase(found);
  return {};
}

std::vector<change> object_table::on_value(entry& at, const std::string& suffix,
                                           const components::news& x) {
  auto& what = at.what;
  change out{change_kind::value, what.name, {}};
  if (suffix == "status") {
    what.status = x.text;
    out.what = change_kind::availability;
  } else if (suffix.ends_with(outcome_suffix)) {
    out.what = change_kind::outcome;
    out.input = suffix.substr(0, suffix.size() - outcome_suffix.size());
    const auto blank = x.text.rfind(' ');
    const auto word = blank == std::string_view::npos ? x.text : x.text.substr(blank + 1);
    what.outcomes[out.input] = word;
    if (blank != std::string_view::npos && (word == "acknowledged" || word == "sent"))
      what.inputs[out.input] = x.text.substr(0, blank);
  } else
    what.values[suffix] = x.text;
  if (!at.known)
    return {};
  return {std::move(out)};
}

const object* object_table::find(std::string_view name) const {
  const auto found = entries_.find(folded(name));
  return found == entries_.end() || !found->second.known ? nullptr : &found->second.what;
}

std::vector<const object*> object_table::all() const {
  std::vector<const object*> out;
  for (const auto& [name, each] : entries_)
    if (each.known)
      out.push_back(&each.what);
  return out;
}

} // namespace rubicon::bridge
