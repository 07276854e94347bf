#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "config/toml/settings.hpp"
#include "core/text/name.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::config {

namespace {

constexpr std::string_view opening = "${";
constexpr std::size_t texts_octets_max = file_octets_max; ///< that parameters make, all together

/// Walks through a file, and remembers which parameters it names.
class replacement {
public:
  replacement(const node_table& known, complaints& problems) : known_(known), problems_(problems) {}

  void put(node& x) {
    if (auto* members = std::get_if<node_table>(&x.content)) {
      for (auto& each : *members)
        put(each.value);
    } else if (auto* elements = std::get_if<node_array>(&x.content)) {
      for (auto& each : *elements)
        put(each);
    } else if (const auto* text = x.as<std::string>();
               text != nullptr && text->find(opening) != std::string::npos) {
      replace(x);
    }
  }

  void doubt_unused() {
    for (const auto& each : known_)
      if (!used_.contains(each.key))
        problems_.warn(each.at, "no value names the parameter `" + each.key + '`');
  }

private:
  void replace(node& x) {
    const auto text = std::get<std::string>(x.content);
    if (text.starts_with(opening) && text.find('}') == text.size() - 1) {
      if (const auto* value = find(x, text.substr(2, text.size() - 3)))
        x.content = value->content;
      return;
    }
    auto replaced = with_values(x, text);
    if (!replaced)
      return;
    octets_ += replaced->size();
    if (octets_ <= texts_octets_max)
      x.content = *std::move(replaced);
    else if (!std::exchange(is_too_large_, true))
      problems_.add(x.at, "with its parameters the file has more than " +
                              std::to_string(texts_octets_max) + " octets of text");
  }

  std::optional<std::string> with_values(const node& x, std::string_view rest) {
    std::string out;
    for (auto at = rest.find(opening); at != std::string_view::npos; at = rest.find(opening)) {
      if (at > 0 && rest[at - 1] == '$') {
        out += std::string(rest.substr(0, at - 1)) + std::string(opening);
        rest.remove_prefix(at + opening.size());
        continue;
      }
      const auto end = rest.find('}', at);
      if (end == std::string_view::npos) {
        problems_.add(x.at, "`${` has no `}`; a plain one is `$${`");
        return std::nullopt;
      }
      const auto* value = find(x, std::string(rest.substr(at + 2, end - at - 2)));
      if (value == nullptr)
        return std::nullopt;
      const auto* text = value->as<std::string>();
      out += std::string(rest.substr(0, at)) + (text == nullptr ? describe(*value) : *text);
      rest.remove_prefix(end + 1);
    }
    return out + std::string(rest);
  }

  const node* find(const node& x, const std::string& name) {
    const auto found = std::ranges::find(known_, name, &member::key);
    if (found != known_.end()) {
      used_.insert(name);
      return &found->value;
    }
    std::vector<std::string> names;
    for (const auto& each : known_)
      names.push_back(each.key);
    problems_.add(x.at,
                  "there is no parameter `" + name + "` in [parameters]" + suggestion(name, names));
    return nullptr;
  }

  const node_table& known_;
  complaints& problems_;
  std::set<std::string> used_;
  std::size_t octets_ = 0;
  bool is_too_large_ = false;
};

/// @returns whether all can be values of parameters
bool check(const node_table& parameters, complaints& problems) {
  const auto before = problems.size();
  for (const auto& each : parameters) {
    const auto& x = each.value;
    const auto* text = x.as<std::string>();
    if (!is_name(each.key))
      problems.add(each.at, "a parameter's name has letters, digits, - and _, at most 32");
    else if (text != nullptr && text->find(opening) != std::string::npos)
      problems.add(x.at, "a parameter cannot name another");
    else if (text == nullptr && x.as<std::int64_t>() == nullptr && x.as<double>() == nullptr &&
             x.as<bool>() == nullptr)
      problems.add(x.at, '`' + each.key + "` must be a text, a number, true or false, not " +
                             describe(x));
  }
  return problems.size() == before;
}

} // namespace

void put_parameters(node& root, complaints& problems) {
  const auto* found = root.find(parameters_key);
  if (found == nullptr)
    return;
  const auto* parameters = found->as<node_table>();
  if (parameters == nullptr) {
    problems.add(found->at, "`parameters` must be a table, not " + describe(*found));
    return;
  }
  const auto known = *parameters; // it is taken out below
  if (!check(known, problems))
    return;
  replacement all(known, problems);
  auto& members = std::get<node_table>(root.content);
  std::erase_if(members, [](const member& x) { return x.key == parameters_key; });
  all.put(root);
  all.doubt_unused();
}

} // namespace rubicon::config
