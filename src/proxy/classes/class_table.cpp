#include "proxy/classes/class_table.hpp"

#include <algorithm>
#include <iterator>

#include "proxy/classes/tuple_key.hpp"

namespace rubicon::proxy {

const proxy_class* class_table::find(const signature& percept) const {
  if (percept.channel != wsn_channel)
    return find_by_id(percept);
  const proxy_class* narrowest = nullptr;
  std::uint32_t least = 0;
  for (const auto& candidate : classes_)
    for (const auto& range : candidate.types) {
      if (!holds(range, percept.type))
        continue;
      if (narrowest == nullptr || width(range) < least) {
        narrowest = &candidate;
        least = width(range);
      }
    }
  return narrowest;
}

const proxy_class* class_table::find_by_id(const signature& percept) const {
  const proxy_class* longest = nullptr;
  std::size_t length = 0;
  for (const auto& candidate : classes_)
    for (const auto& [channel, prefix] : candidate.ids) {
      const bool fits = channel == percept.channel && prefix.size() <= percept.hardware_id.size() &&
                        same_key(prefix, percept.hardware_id.substr(0, prefix.size()));
      if (!fits || (longest != nullptr && prefix.size() <= length))
        continue;
      longest = &candidate;
      length = prefix.size();
    }
  return longest;
}

const proxy_class* class_table::find(std::string_view name) const {
  const auto found =
      std::find_if(classes_.begin(), classes_.end(), [&](const auto& x) { return x.name == name; });
  return found == classes_.end() ? nullptr : &*found;
}

class_table known_at(const std::vector<proxy_class>& all, instant now) {
  std::vector<proxy_class> known;
  std::ranges::copy_if(all, std::back_inserter(known),
                       [now](const auto& x) { return x.known_from <= now; });
  return class_table(std::move(known));
}

std::optional<instant> next_known(const std::vector<proxy_class>& all, instant now) {
  std::optional<instant> next;
  for (const auto& x : all) {
    if (x.known_from > now)
      next = earliest(next, x.known_from);
  }
  return next;
}

} // namespace rubicon::proxy
