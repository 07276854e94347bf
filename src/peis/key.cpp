#include "peis/key.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Takes the part before the next dot off `rest`.
std::string_view next_part(std::string_view& rest) {
  const auto dot = rest.find('.');
  const auto part = rest.substr(0, dot);
  rest.remove_prefix(dot == std::string_view::npos ? rest.size() : dot + 1);
  return part;
}

std::size_t count_parts(std::string_view text) {
  return text.empty() ? 0 : 1 + static_cast<std::size_t>(std::count(text.begin(), text.end(), '.'));
}

/// Walks over all parts, those that a trailing dot leaves empty too.
template <class Predicate>
bool any_part(std::string_view text, std::size_t parts, Predicate predicate) {
  for (std::size_t i = 0; i < parts; ++i) {
    if (predicate(next_part(text)))
      return true;
  }
  return false;
}

} // namespace

key::key(std::string_view text) : text_(text), folded_(text), parts_(count_parts(text)) {
  std::transform(folded_.begin(), folded_.end(), folded_.begin(), lower);
  pattern_ =
      parts_ == 0 || any_part(text, parts_, [](std::string_view part) { return part == "*"; });
}

result<key> key::parse(std::string_view text) {
  if (text.size() > key_length_max)
    return errc::too_long;
  const auto parts = count_parts(text);
  const auto illegal = [](std::string_view part) {
    return part.size() > 1 && part.find('*') != std::string_view::npos;
  };
  if (parts > key_parts_max || text.find('\0') != std::string_view::npos ||
      any_part(text, parts, illegal))
    return errc::bad_value;
  return key(text);
}

result<key> key::from_wire(std::string_view text) {
  if (text.size() > key_length_max)
    return errc::too_long;
  return key(first_parts(text, key_parts_max));
}

std::string_view key::first_parts(std::string_view text, std::size_t count) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '.' && --count == 0)
      return text.substr(0, at);
  }
  return text;
}

bool key::matches(const key& other) const {
  if (any())
    return true;
  if (parts_ != other.parts_)
    return false;
  if (!pattern_)
    return folded_ == other.folded_;
  std::string_view mine = folded_;
  std::string_view theirs = other.folded_;
  for (std::size_t i = 0; i < parts_; ++i) {
    const auto part = next_part(mine);
    if (const auto counterpart = next_part(theirs); part != "*" && part != counterpart)
      return false;
  }
  return true;
}

} // namespace rubicon::peis
