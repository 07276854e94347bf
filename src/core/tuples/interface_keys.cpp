#include "core/tuples/interface_keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rubicon {

namespace {

constexpr std::size_t name_length_max = 32;
constexpr std::string_view root = "interface";

constexpr std::array<std::pair<interface_tuple, std::string_view>, 5> words{
    {{interface_tuple::channel, "channel"},
     {interface_tuple::position, "position"},
     {interface_tuple::objects, "objects"},
     {interface_tuple::rssi, "rssi"},
     {interface_tuple::memory, "memory"}}};

bool is_of_object(interface_tuple x) {
  return x == interface_tuple::rssi || x == interface_tuple::memory;
}

std::string_view word_of(interface_tuple x) {
  return std::ranges::find(words, x, [](const auto& y) { return y.first; })->second;
}

bool is_name(std::string_view x) {
  return !x.empty() && x.size() <= name_length_max && std::ranges::all_of(x, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

/// Hundredths, rounded half away from zero.
std::string two_decimals(double x) {
  const auto hundredths = std::llround(x * 100);
  auto digits = std::to_string(std::llabs(hundredths));
  if (digits.size() < 3)
    digits.insert(0, 3 - digits.size(), '0');
  digits.insert(digits.size() - 2, 1, '.');
  return hundredths < 0 ? '-' + digits : digits;
}

} // namespace

std::string to_string(const interface_key& x) {
  auto key = std::string(root) + '.' + x.name + '.';
  if (is_of_object(x.what))
    key += "objects." + x.object + '.';
  return key += word_of(x.what);
}

result<interface_key> parse_interface_key(std::string_view key) {
  std::vector<std::string> parts(1);
  for (const auto c : key) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  const bool has_object = parts.size() == 5;
  if ((parts.size() != 3 && !has_object) || parts[0] != root || !is_name(parts[1]))
    return errc::bad_value;
  if (has_object && (parts[2] != word_of(interface_tuple::objects) || !is_name(parts[3])))
    return errc::bad_value;
  const auto found = std::ranges::find(words, parts.back(), [](const auto& x) { return x.second; });
  if (found == words.end() || is_of_object(found->first) != has_object)
    return errc::bad_value;
  return interface_key{found->first, parts[1], has_object ? parts[3] : std::string()};
}

std::string object_list_text(std::vector<std::string> ids) {
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::string text = "{";
  for (const auto& id : ids) {
    if (text.size() > 1)
      text += ',';
    text += id;
  }
  return text + '}';
}

result<std::vector<std::string>> parse_object_list(std::string_view text) {
  if (text.size() < 2 || text.front() != '{' || text.back() != '}')
    return errc::bad_value;
  text = text.substr(1, text.size() - 2);
  std::vector<std::string> ids;
  while (!text.empty()) {
    const auto comma = text.find(',');
    const auto id = text.substr(0, comma);
    const bool is_last = comma == std::string_view::npos;
    if (!is_name(id) || (!ids.empty() && id <= ids.back()) || comma + 1 == text.size())
      return errc::bad_value;
    ids.emplace_back(id);
    text.remove_prefix(is_last ? text.size() : comma + 1);
  }
  return ids;
}

std::string position_text(const position& x) {
  return two_decimals(x.x_m) + ' ' + two_decimals(x.y_m) + ' ' + two_decimals(x.z_m);
}

} // namespace rubicon
