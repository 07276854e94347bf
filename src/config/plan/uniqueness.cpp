#include "config/plan/uniqueness.hpp"

namespace rubicon::config {

std::string folded(std::string_view name) {
  std::string out(name);
  for (auto& c : out)
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

bool name_uniqueness::add(std::string_view name, std::string_view kind, mark at,
                          complaints& problems) {
  return names_.add(folded(name), std::string(kind) + " `" + std::string(name) + '`', at, problems);
}

} // namespace rubicon::config
