#include "proxy/classes/tuple_key.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::proxy {

namespace {

bool stays(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

} // namespace

std::string key_part(std::string_view text) {
  if (text.empty())
    return "_";
  std::string part(text);
  std::replace_if(
      part.begin(), part.end(), [](char c) { return !stays(c); }, '_');
  return part;
}

std::string key_parts(std::string_view text) {
  std::string key;
  for (;;) {
    const auto dot = text.find('.');
    key += key_part(text.substr(0, dot));
    if (dot == std::string_view::npos)
      return key;
    key += '.';
    text.remove_prefix(dot + 1);
  }
}

std::vector<std::pair<std::string, std::string>> names_of(const proxy_identity& who) {
  const auto id = to_string(who.mote.mote);
  return {{"island", who.island_name.empty() ? to_string(who.mote.island) : who.island_name},
          {"id", id},
          {"name", who.mote_name.empty() ? "mote-" + id : who.mote_name}};
}

std::string key_prefix(std::string_view prefix, const proxy_identity& who) {
  const auto names = names_of(who);
  return fill_prefix(prefix, {{"{island}", key_part(names[0].second)},
                              {"{id}", key_part(names[1].second)},
                              {"{name}", key_part(names[2].second)}});
}

std::string fill_prefix(std::string_view prefix,
                        const std::vector<std::pair<std::string_view, std::string>>& names) {
  std::string filled;
  while (!prefix.empty()) {
    const auto found = std::find_if(names.begin(), names.end(),
                                    [&](const auto& x) { return prefix.starts_with(x.first); });
    if (found != names.end()) {
      filled += found->second;
      prefix.remove_prefix(found->first.size());
    } else {
      filled += prefix.front();
      prefix.remove_prefix(1);
    }
  }
  return key_parts(filled);
}

bool same_key(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

} // namespace rubicon::proxy
