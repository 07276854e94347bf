#include "core/text/name.hpp"

#include <algorithm>

namespace rubicon {

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

bool is_name(std::string_view x) {
  return !x.empty() && x.size() <= name_length_max && std::ranges::all_of(x, is_name_character);
}

} // namespace rubicon
