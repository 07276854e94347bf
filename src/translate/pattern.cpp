#include "translate/pattern.hpp"

#include <algorithm>

#include "core/tuples/tuple_key.hpp"

namespace rubicon::translate {

namespace {

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

/// Cuts off the first part of `rest`.
std::string_view next_part(std::string_view& rest) {
  const auto dot = rest.find('.');
  const auto part = rest.substr(0, dot);
  rest.remove_prefix(dot == std::string_view::npos ? rest.size() : dot + 1);
  return part;
}

/// `{3}` at the beginning of `x`; 0 if there is none. There are at most 7 parts, so one digit.
std::size_t placeholder_at(std::string_view x) {
  const bool is_one = x.size() >= 3 && x[0] == '{' && x[2] == '}' && x[1] >= '1' && x[1] <= '9';
  return is_one ? static_cast<std::size_t>(x[1] - '0') : 0;
}

} // namespace

std::string folded_key(std::string_view key) {
  std::string out(key);
  std::ranges::transform(out, out.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  });
  return out;
}

std::optional<std::vector<std::string>> match(std::string_view pattern, std::string_view key) {
  if (std::ranges::count(pattern, '.') != std::ranges::count(key, '.'))
    return std::nullopt;
  std::vector<std::string> stars;
  while (!pattern.empty() || !key.empty()) {
    const auto wanted = next_part(pattern);
    const auto part = next_part(key);
    if (wanted == "*")
      stars.emplace_back(part);
    else if (folded_key(wanted) != folded_key(part))
      return std::nullopt;
  }
  return stars;
}

std::size_t stars_in(std::string_view pattern) {
  std::size_t stars = 0;
  while (!pattern.empty())
    stars += next_part(pattern) == "*" ? 1 : 0;
  return stars;
}

bool is_target(std::string_view to, std::size_t stars) {
  if (!fits_tuple_key(to))
    return false;
  bool part_is_empty = true;
  while (!to.empty()) {
    if (to.front() == '.') {
      if (part_is_empty)
        return false;
      part_is_empty = true;
      to.remove_prefix(1);
      continue;
    }
    const auto number = placeholder_at(to);
    if (number > stars || (number == 0 && !is_key_character(to.front())))
      return false;
    to.remove_prefix(number > 0 ? 3 : 1);
    part_is_empty = false;
  }
  return !part_is_empty;
}

std::string filled(std::string_view to, const std::vector<std::string>& parts) {
  std::string out;
  while (!to.empty()) {
    const auto number = placeholder_at(to);
    if (number > 0)
      out += parts.at(number - 1);
    else
      out += to.front();
    to.remove_prefix(number > 0 ? 3 : 1);
  }
  return out;
}

} // namespace rubicon::translate
