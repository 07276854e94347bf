#include "cli/manual/key_text.hpp"

#include <algorithm>
#include <vector>

#include "cli/manual/key_place.hpp"
#include "cli/manual/value_kind.hpp"
#include "config/summary_parts.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t explained_max = 5; // more are one line each
constexpr std::size_t paths_max = 6;     // of one key

/// One key that may stand in several places.
struct key_group {
  key_place first;
  std::vector<std::string> paths;
  std::vector<std::string> titles; ///< of its tables
};

bool is_same(const key_place& a, const key_place& b) {
  const auto* const one = a.key->table.get();
  const auto* const other = b.key->table.get();
  const bool has_same_keys =
      one == nullptr || other == nullptr ? one == other : one->title == other->title;
  return has_same_keys && range_text(*a.key) == range_text(*b.key) && a.key->name == b.key->name &&
         a.key->meaning == b.key->meaning && a.key->wanted == b.key->wanted &&
         a.key->standard == b.key->standard && a.key->unset == b.key->unset &&
         config::change_of(*a.key) == config::change_of(*b.key);
}

void add(std::vector<std::string>& to, const std::string& what) {
  if (std::ranges::find(to, what) == to.end())
    to.push_back(what);
}

std::vector<key_group> grouped(const std::vector<key_place>& all) {
  std::vector<key_group> out;
  for (const auto& each : all) {
    const auto same = std::ranges::find_if(
        out, [&each](const key_group& group) { return is_same(group.first, each); });
    auto& group = same == out.end() ? out.emplace_back(key_group{each, {}, {}}) : *same;
    add(group.paths, each.path());
    add(group.titles, plain_text(each.title));
  }
  return out;
}

/// The headers and the line that set the key, and what its tables must say for it.
std::string example_of(const key_place& x) {
  std::string out;
  std::string path;
  for (std::size_t i = 0; i + 1 < x.steps.size(); ++i) {
    const auto& step = x.steps[i];
    path += (path.empty() ? "" : ".") + step.name;
    const bool is_last = i + 2 == x.steps.size();
    if (step.part == config::part::tables)
      out += "    [[" + path + "]]\n";
    else if (step.part != config::part::named_tables && (is_last || !step.choice.empty()))
      out += "    [" + path + "]\n";
    if (!step.choice.empty())
      out += "    " + step.choice + '\n';
  }
  const auto name = x.steps.back().name;
  path += (path.empty() ? "" : ".") + name;
  switch (x.key->part) {
  case config::part::value:
    return out + "    " + name + " = " + sample_of(*x.key) + '\n';
  case config::part::tables:
    return out + "    [[" + path + "]]\n";
  case config::part::table:
  case config::part::other_tables:
    return out + "    [" + path + "]\n";
  case config::part::named_tables:
    return out + "    [" + path + ".NAME]\n";
  }
  return out;
}

/// The keys that a table may have, each once.
std::vector<const config::key_description*> keys_of(const config::table_description& table) {
  std::vector<const config::key_description*> out;
  const auto take = [&out](const config::table_description& x) {
    for (const auto& key : x.keys)
      if (std::ranges::find(out, key.name, &config::key_description::name) == out.end())
        out.push_back(&key);
  };
  take(table);
  std::ranges::for_each(table.variants, take);
  return out;
}

/// Each with what it means, in a line of its own.
std::string list_of(const std::vector<const config::key_description*>& all) {
  std::size_t width = 0;
  for (const auto* each : all)
    width = std::max(width, each->name.size());
  std::string out = "  keys:\n";
  for (const auto* each : all) {
    const auto text = plain_text(each->meaning);
    const auto standard = each->is_required ? " (required)" : "";
    out += "    " + each->name +
           (text.empty() && !each->is_required ? std::string()
                                               : std::string(width - each->name.size(), ' ')) +
           (text.empty() ? "" : "  " + text) + standard + '\n';
  }
  return out;
}

/// What a table must have; of one that needs nothing its first key.
std::string lines_of(const config::table_description& table) {
  std::string out;
  for (const bool is_required : {true, false})
    for (const auto& each : table.keys)
      if (each.part == config::part::value && each.is_required == is_required &&
          (is_required || out.empty()))
        out += "    " + each.name + " = " + sample_of(each) + '\n';
  return out;
}

std::string line(const std::string& name, const std::string& text) {
  return text.empty() ? text : "  " + name + std::string(10 - name.size(), ' ') + text + '\n';
}

std::string text_of(const key_group& x) {
  const auto& key = *x.first.key;
  std::string out = x.first.path() + '\n';
  out += key.meaning.empty() ? "" : "  " + plain_text(key.meaning) + '\n';
  out += '\n' + line("value:", range_text(key));
  const auto* const kind = kind_of(key);
  if (kind != nullptr)
    out += line("unit:", std::string(kind->units));
  const auto standard = default_text(key);
  if (standard.starts_with("default: "))
    out += line("default:", standard.substr(9));
  else
    out += line("default:", standard.empty() ? "none" : "none: it is required");
  out += line("change:", plain_text(config::change_of(key)));
  out += line("table:", config::joined(x.titles, ", "));
  for (std::size_t i = 0; i < std::min(x.paths.size(), paths_max); ++i)
    out += line(i == 0 ? "place:" : "", x.paths[i]);
  if (x.paths.size() > paths_max)
    out += line("", "and " + std::to_string(x.paths.size() - paths_max) + " more");
  if (!key.table)
    return out + "  example:\n" + example_of(x.first);
  return out + list_of(keys_of(*key.table)) + "  example:\n" + example_of(x.first) +
         lines_of(*key.table);
}

std::string not_found(const std::vector<key_place>& all, std::string_view wanted) {
  std::string out = "there is no key `" + std::string(wanted) + '`';
  const auto near = nearest_keys(all, wanted);
  for (const auto& each : near)
    out += (&each == &near.front() ? ": did you mean `" : ", `") + each + '`';
  return out + (near.empty() ? ": docs/configuration.md and `man rubicon.toml` list all" : "?");
}

} // namespace

key_explanation explain_key(const config::table_description& file, std::string_view wanted) {
  const auto all = all_places(file);
  const auto groups = grouped(places_of(all, wanted));
  if (groups.empty())
    return {false, not_found(all, wanted)};
  std::string out;
  if (groups.size() <= explained_max) {
    for (const auto& each : groups)
      out += (out.empty() ? "" : "\n") + text_of(each);
    return {true, out};
  }
  for (const auto& each : groups)
    out += each.first.path() + "  (" + plain_text(each.first.title) + ")\n    " +
           plain_text(each.first.key->meaning) + '\n';
  return {true, out + "\nThese are " + std::to_string(groups.size()) +
                    " keys: give more of the path of one.\n"};
}

} // namespace rubicon::cli
