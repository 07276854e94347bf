#include "peis/space/tuple_audience.hpp"

namespace rubicon::peis {

std::set<std::string> tuple_audience::subscribed(std::string_view first_part) const {
  std::set<std::string> all;
  const auto note = [&](const auto& x) { all.insert(x.wanted.name.folded()); };
  others_.for_first_part(first_part, note);
  local_.for_own_under(first_part, note);
  return all;
}

} // namespace rubicon::peis
