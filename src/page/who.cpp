// Whom names of events, tuples and lanes are about, with what people call them.
#include <algorithm>

#include "page/parts.hpp"

namespace rubicon::page {

namespace {

using label_kind = config::label_table::kind;

/// The label of what the first part or the first two parts of a name, up to `end`, are.
std::string label_of(const run_page& x, const std::string& name, std::size_t end, bool is_mote) {
  auto path = name.substr(0, end);
  std::ranges::replace(path, '.', '/');
  if (is_mote)
    return x.ecology.labels.of(label_kind::mote, path);
  auto label = x.ecology.labels.of(label_kind::island, path);
  return label.empty() ? x.ecology.labels.of(label_kind::peer, path) : label;
}

} // namespace

std::string labelled(const run_page& x, const std::string& name) {
  constexpr std::string_view ends = "/. ";
  const auto first = std::min(name.find_first_of(ends), name.size());
  const auto second = std::min(name.find_first_of(ends, first + 1), name.size());
  const bool has_two = first < name.size() && name[first] != ' ' && first + 1 < second;
  for (const bool is_mote : {true, false}) {
    if (is_mote && !has_two)
      continue;
    const auto end = is_mote ? second : first;
    const auto label = label_of(x, name, end, is_mote);
    if (label.empty())
      continue;
    // Within a key a label would look like a part of it.
    return name.find('.') < name.size()
               ? name + " (" + label + ')'
               : name.substr(0, end) + " (" + label + ')' + name.substr(end);
  }
  return name;
}

} // namespace rubicon::page
