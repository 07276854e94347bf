#include "proxy/classes/class_change.hpp"

#include <algorithm>
#include <cassert>

#include "proxy/classes/class_keys.hpp"

namespace rubicon::proxy {

void apply(const class_change& x, proxy_class& to) {
  keys::apply(x.settings, to.settings);
  if (x.field.empty())
    return;
  const auto found = std::ranges::find(to.fields, x.field, &field::name);
  assert(found != to.fields.end());
  keys::apply(x.field_settings, *found);
}

std::string to_text(const class_change& x) {
  std::string text;
  const auto say = [&text](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  for (const auto& each : x.settings)
    say(keys::to_text(each));
  for (const auto& each : x.field_settings)
    say(each.key + " of " + x.field + ' ' + keys::to_text(each.value));
  return text;
}

} // namespace rubicon::proxy
