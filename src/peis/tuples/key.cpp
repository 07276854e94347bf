#include "peis/tuples/key.hpp"

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

bool ends_part(std::string_view text, std::size_t at) {
  return at == text.size() || text[at] == '.';
}

/// Where the next part stands that is only `*`.
std::size_t find_wildcard(std::string_view text) {
  for (auto at = text.find('*'); at != std::string_view::npos; at = text.find('*', at + 1)) {
    if ((at == 0 || text[at - 1] == '.') && ends_part(text, at + 1))
      return at;
  }
  return std::string_view::npos;
}

/// Has any part a `*` beside other characters?
bool has_stray_star(std::string_view text) {
  for (auto at = text.find('*'); at != std::string_view::npos; at = text.find('*', at + 1)) {
    if ((at > 0 && text[at - 1] != '.') || !ends_part(text, at + 1))
      return true;
  }
  return false;
}

} // namespace

key::key(std::string_view text) {
  if (text.empty())
    return;
  const auto x = std::make_shared<parsed>();
  x->text = text;
  if (std::ranges::any_of(text, [](char c) { return lower(c) != c; })) {
    std::string folded(text);
    std::ranges::transform(folded, folded.begin(), lower);
    x->folded = std::make_unique<const std::string>(std::move(folded));
  }
  x->parts = static_cast<std::uint8_t>(key_parts_of(text));
  if (const auto at = find_wildcard(text); at != std::string_view::npos)
    x->wild_at = static_cast<std::uint8_t>(at);
  content_ = x;
}

const key::parsed& key::content() const {
  static const parsed empty;
  return content_ ? *content_ : empty;
}

result<key> key::parse(std::string_view text) {
  if (text.size() > key_characters_max)
    return errc::too_long;
  if (key_parts_of(text) > key_parts_max || text.find('\0') != std::string_view::npos ||
      has_stray_star(text))
    return errc::bad_value;
  return key(text);
}

result<key> key::from_wire(std::string_view text) {
  if (text.size() > key_characters_max)
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
  if (!is_pattern())
    return *this == other;
  std::string_view mine = folded();
  std::string_view theirs = other.folded();
  if (parts() != other.parts() || !theirs.starts_with(literal_prefix()))
    return false;
  for (std::size_t i = 0; i < parts(); ++i) {
    const auto part = next_part(mine);
    if (const auto counterpart = next_part(theirs); part != "*" && part != counterpart)
      return false;
  }
  return true;
}

bool is_reserved(const key& name) {
  return name.folded() == "kernel" || name.folded().starts_with("kernel.");
}

bool equal_without_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

} // namespace rubicon::peis
