#include "bridge/mqtt/expiry_list.hpp"

#include <algorithm>

namespace rubicon::bridge {

bool expiry_list::add(const std::string& name, instant due) {
  if (names_.contains(name))
    return true;
  if (names_.size() >= names_max)
    return false;
  earliest_ = names_.empty() ? due : std::min(earliest_, due);
  names_.emplace(name, due);
  return true;
}

std::vector<std::string> expiry_list::take(instant now) {
  std::vector<std::string> out;
  if (names_.empty() || now < earliest_)
    return out;
  std::optional<instant> next;
  std::erase_if(names_, [&](const auto& each) {
    if (each.second > now) {
      next = earliest(next, each.second);
      return false;
    }
    out.push_back(each.first);
    return true;
  });
  earliest_ = next.value_or(now);
  return out;
}

std::optional<instant> expiry_list::deadline() const {
  return names_.empty() ? std::nullopt : std::optional(earliest_);
}

} // namespace rubicon::bridge
