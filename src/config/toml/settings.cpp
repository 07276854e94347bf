#include "config/toml/settings.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "config/toml/text_check.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::config {

namespace {

using path_parts = std::vector<std::string>;

void put(node& x, mark at) {
  x.at = at;
  if (auto* members = std::get_if<node_table>(&x.content)) {
    for (auto& each : *members) {
      each.at = at;
      put(each.value, at);
    }
  } else if (auto* elements = std::get_if<node_array>(&x.content)) {
    for (auto& each : *elements)
      put(each, at);
  }
}

/// TOML, or else a text: the shell has taken the quotes of most texts.
node parsed_value(const std::string& text, mark at) {
  node out{at, text};
  auto parsed = parse("x = " + text, {});
  if (auto* root = std::get_if<node>(&parsed)) {
    auto& members = std::get<node_table>(root->content);
    if (members.size() == 1 && members.front().value.as<date_or_time>() == nullptr)
      out = std::move(members.front().value);
  }
  put(out, at);
  return out;
}

/// The parts of a path; nothing if one is empty, or there are too many.
std::optional<path_parts> split(std::string_view text) {
  path_parts out(1);
  bool quoted = false;
  for (const char x : text) {
    if (x == '"')
      quoted = !quoted;
    else if (x == '.' && !quoted)
      out.emplace_back();
    else
      out.back() += x;
  }
  const bool is_sound = !quoted && out.size() <= key_dots_max &&
                        std::ranges::none_of(out, [](const auto& x) { return x.empty(); });
  return is_sound ? std::optional(std::move(out)) : std::nullopt;
}

/// Where the path ends: the first `=` that no quotes enclose.
std::size_t end_of_path(std::string_view setting) {
  bool quoted = false;
  for (std::size_t i = 0; i < setting.size(); ++i) {
    if (setting[i] == '"')
      quoted = !quoted;
    else if (setting[i] == '=' && !quoted)
      return i;
  }
  return std::string_view::npos;
}

const std::string* name_of(const node& x) {
  const auto* name = x.find("name");
  return name == nullptr ? nullptr : name->as<std::string>();
}

/// Walks along one path, and sets its value where the path leads.
class walk {
public:
  walk(const path_parts& path, const node& value, complaints& problems)
      : path_(path), value_(value), problems_(problems) {}

  /// @param depth parts of the path that lead to `x`
  void go(node& x, std::size_t depth) {
    if (auto* members = std::get_if<node_table>(&x.content))
      into(*members, depth);
    else if (auto* elements = std::get_if<node_array>(&x.content))
      into(*elements, depth);
    else
      complain('`' + before(depth) + "` is " + describe(x) + ", and has no keys");
  }

private:
  void into(node_table& members, std::size_t depth) {
    const auto& part = path_[depth];
    if (part == "*") {
      const bool is_last = depth + 1 == path_.size();
      if (members.empty())
        complain("there is nothing in `" + before(depth) + '`');
      for (auto& each : members)
        if (is_last || each.value.as<node_table>() || each.value.as<node_array>())
          enter(each.value, depth + 1);
      return;
    }
    auto found = std::ranges::find(members, part, &member::key);
    if (found == members.end()) // if nobody knows the key, its reader says so
      found = members.insert(members.end(), {part, value_.at, node{value_.at, node_table{}}});
    enter(found->value, depth + 1);
  }

  void into(node_array& elements, std::size_t depth) {
    const auto& part = path_[depth];
    bool any = false;
    for (auto& each : elements) {
      const auto* name = name_of(each);
      if (part != "*" && (name == nullptr || *name != part))
        continue;
      any = true;
      enter(each, depth + 1);
    }
    if (any)
      return;
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    if (error == std::errc{} && end == part.data() + part.size() && number >= 1 &&
        number <= elements.size())
      enter(elements[number - 1], depth + 1);
    else
      nobody(elements, depth);
  }

  /// Which may have a range instead of its value.
  [[nodiscard]] bool is_parameter() const {
    return path_.size() == 2 && path_.front() == parameters_key;
  }

  void enter(node& x, std::size_t depth) {
    if (depth < path_.size())
      go(x, depth);
    else if (x.as<node_table>() != nullptr && value_.as<node_table>() == nullptr &&
             !std::get<node_table>(x.content).empty() && !is_parameter())
      complain('`' + before(depth) + "` is a table: set one of its keys");
    else
      x = value_;
  }

  void nobody(const node_array& elements, std::size_t depth) {
    std::vector<std::string> names;
    for (const auto& each : elements)
      if (const auto* name = name_of(each))
        names.push_back(*name);
    complain("`" + before(depth) + "` has no `" + path_[depth] + '`' +
             (names.empty() ? ": there are " + std::to_string(elements.size()) + ", without names"
                            : suggestion(path_[depth], names)));
  }

  [[nodiscard]] std::string before(std::size_t depth) const {
    std::string out;
    for (std::size_t i = 0; i < depth; ++i)
      out += (i == 0 ? "" : ".") + path_[i];
    return out;
  }

  void complain(std::string message) { problems_.add(value_.at, std::move(message)); }

  const path_parts& path_;
  const node& value_;
  complaints& problems_;
};

/// Puts the table before a name that stands alone; no plain value of ours stands outside of a
/// table.
void find_parameter(const node& root, path_parts& path) {
  const auto* parameters = root.find(parameters_key);
  if (path.size() == 1 && parameters != nullptr &&
      (parameters->find(path.front()) != nullptr || root.find(path.front()) == nullptr))
    path.insert(path.begin(), std::string(parameters_key));
}

/// Why a path leads to no parameter; empty if it does, or leads elsewhere.
std::string unknown_parameter(const node& root, const path_parts& path) {
  if (path.size() != 2 || path.front() != parameters_key || path.back() == "*")
    return {};
  std::vector<std::string> names;
  if (const auto* parameters = root.find(parameters_key);
      parameters != nullptr && parameters->as<node_table>() != nullptr)
    for (const auto& each : *parameters->as<node_table>())
      names.push_back(each.key);
  if (std::ranges::find(names, path.back()) != names.end())
    return {};
  return "there is no parameter `" + path.back() + "` in [parameters]" +
         suggestion(path.back(), names);
}

} // namespace

void apply(const settings& all, node& root, complaints& problems) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto at = mark_of_setting(i);
    const auto end = end_of_path(all[i]);
    auto path = split(std::string_view(all[i]).substr(0, end));
    if (end == std::string::npos || !path) {
      problems.add(at, "must be the path of a key and its value, as in island.kitchen.id=3");
      continue;
    }
    const auto value = parsed_value(all[i].substr(end + 1), at);
    if (value.as<node_table>() == nullptr)
      find_parameter(root, *path);
    if (const auto why = unknown_parameter(root, *path); !why.empty()) {
      problems.add(at, why);
      continue;
    }
    walk(*path, value, problems).go(root, 0);
  }
}

std::vector<problem> with_settings(std::vector<problem> problems, const settings& all) {
  for (auto& each : problems) {
    const auto setting = setting_of({each.line, each.column});
    if (setting && *setting < all.size())
      each = {"--set " + all[*setting], 0, 0, std::move(each.message)};
  }
  return problems;
}

} // namespace rubicon::config
