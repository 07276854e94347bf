#include "core/describe/changes.hpp"

#include <algorithm>

#include "core/describe/content.hpp"

namespace rubicon::keys {

std::string to_text(const key_value& x) {
  if (const auto* text = std::get_if<std::string>(&x))
    return *text;
  std::string out;
  print_content(out, x);
  return out;
}

std::string to_text(const key_change& x) {
  return x.key + ' ' + to_text(x.value);
}

const key_value* find(const key_changes& all, std::string_view key) {
  const auto found = std::ranges::find(all, key, &key_change::key);
  return found == all.end() ? nullptr : &found->value;
}

} // namespace rubicon::keys
