#include "cli/manual/key_place.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "core/text/spelling.hpp"

namespace rubicon::cli {

namespace {

using path_names = std::vector<std::string>;

constexpr std::string_view any_name = "NAME"; // as descriptions have it
constexpr std::size_t wanted_max = 200;       // octets of what is looked for
constexpr std::size_t nearest_max = 3;
constexpr std::size_t far_max = 2; // letters that differ

path_names parts_of(std::string_view text) {
  path_names out(1);
  for (const char c : text) {
    if (c == '.')
      out.emplace_back();
    else if (c != '[' && c != ']')
      out.back() += c;
  }
  return out;
}

path_names names_of(const key_place& x) {
  path_names out;
  for (const auto& step : x.steps)
    out.push_back(step.name);
  return out;
}

/// The last parts of its path.
std::string end_of(const key_place& x, std::size_t count) {
  const auto names = names_of(x);
  std::string out;
  for (const auto& name : std::span(names).last(count))
    out += (out.empty() ? "" : ".") + name;
  return out;
}

/// `app = "sampler"` of `[[expect]] kind = "delivery"` and the like.
std::string choice_of(const config::table_description& variant, const std::string& key) {
  const auto at = variant.title.find(key + " = ");
  return at == std::string::npos ? std::string() : variant.title.substr(at);
}

class walker {
public:
  void walk(const config::table_description& table) {
    each(table, table.title);
    for (const auto& variant : table.variants) {
      const auto before = steps_.empty() ? std::string() : steps_.back().choice;
      if (!steps_.empty())
        steps_.back().choice = choice_of(variant, table.choice);
      each(variant, variant.title);
      if (!steps_.empty())
        steps_.back().choice = before;
    }
  }

  std::vector<key_place> found;

private:
  void each(const config::table_description& table, const std::string& title) {
    for (const auto& key : table.keys) {
      steps_.push_back({key.name, key.part});
      found.push_back({steps_, &key, title});
      const bool is_named = key.part == config::part::named_tables;
      if (is_named)
        steps_.push_back({std::string(any_name), config::part::table});
      if (key.table)
        walk(*key.table);
      if (is_named)
        steps_.pop_back();
      steps_.pop_back();
    }
  }

  std::vector<key_step> steps_;
};

/// @param any whether NAME of a path is any part but the last
bool matches(std::span<const std::string> wanted, std::span<const std::string> path, bool any) {
  if (wanted.empty() || path.empty())
    return wanted.empty() && path.empty();
  if (wanted.front() == "*") {
    for (std::size_t n = 1; n <= path.size(); ++n)
      if (matches(wanted.subspan(1), path.subspan(n), any))
        return true;
    return false;
  }
  const bool is_any = any && path.size() > 1 && path.front() == any_name;
  return (is_any || wanted.front() == path.front()) &&
         matches(wanted.subspan(1), path.subspan(1), any);
}

bool ends_with(const path_names& wanted, const path_names& path) {
  for (std::size_t skipped = 0; skipped < path.size(); ++skipped)
    if (matches(wanted, std::span(path).subspan(skipped), false))
      return true;
  return false;
}

} // namespace

std::string key_place::path() const {
  std::string out;
  for (const auto& step : steps)
    out += (out.empty() ? "" : ".") + step.name;
  return out;
}

std::vector<key_place> all_places(const config::table_description& file) {
  walker all;
  all.walk(file);
  return std::move(all.found);
}

std::vector<key_place> places_of(const std::vector<key_place>& all, std::string_view wanted) {
  if (wanted.size() > wanted_max)
    return {};
  const auto parts = parts_of(wanted);
  std::vector<key_place> whole;
  std::vector<key_place> named; // NAME of the path is a name that was given
  std::vector<key_place> ends;
  for (const auto& each : all) {
    const auto names = names_of(each);
    if (matches(parts, names, false))
      whole.push_back(each);
    else if (matches(parts, names, true))
      named.push_back(each);
    else if (ends_with(parts, names))
      ends.push_back(each);
  }
  for (auto* const each : {&whole, &named})
    if (!each->empty())
      return *each;
  return ends;
}

std::vector<std::string> nearest_keys(const std::vector<key_place>& all, std::string_view wanted) {
  if (wanted.size() > wanted_max)
    return {};
  const auto parts = parts_of(wanted);
  const bool is_pattern = std::ranges::find(parts, "*") != parts.end();
  const auto word = is_pattern ? parts.back() : std::string(wanted); // places differ, not the name
  const auto count = is_pattern ? 1 : parts.size();
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const auto& each : all) {
    if (each.steps.size() < count)
      continue;
    const auto distance = edit_distance(word, end_of(each, count));
    if (distance <= far_max)
      near.emplace_back(distance, is_pattern ? each.path() : end_of(each, count));
  }
  std::ranges::sort(near);
  std::vector<std::string> out;
  for (auto& [distance, name] : near)
    if (out.size() < nearest_max && std::ranges::find(out, name) == out.end())
      out.push_back(std::move(name));
  return out;
}

} // namespace rubicon::cli
