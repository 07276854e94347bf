#include "bridge/table/class_model.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/decimal.hpp"

namespace rubicon::bridge {

namespace {

/// `{island}.lamp-{id}` as `*.*`.
std::string pattern_of(std::string_view prefix) {
  std::string out;
  while (true) {
    const auto dot = prefix.find('.');
    const auto part = prefix.substr(0, dot);
    out += part.find('{') == std::string_view::npos ? std::string(part) : "*";
    if (dot == std::string_view::npos)
      return out;
    out += '.';
    prefix.remove_prefix(dot + 1);
  }
}

template <class Pairs>
std::vector<std::string> second_of(const Pairs& pairs) {
  std::vector<std::string> out;
  for (const auto& [count, word] : pairs)
    if (std::ranges::find(out, word) == out.end())
      out.push_back(word);
  return out;
}

input_model input_model_of(const proxy::input& x) {
  input_model out{x.name, x.unit, {}};
  for (const auto& [word, octets] : x.words)
    out.words.push_back(word);
  if (x.numbers)
    out.numbers = number_range{x.numbers->min, x.numbers->max, std::abs(x.numbers->scale)};
  return out;
}

} // namespace

class_model model_of(const proxy::proxy_class& x) {
  class_model out{x.name, pattern_of(x.prefix), {}, {}};
  for (const auto& each : x.fields)
    out.fields.push_back({each.name, each.unit, second_of(each.words), each.decimals});
  for (const auto& each : x.inputs)
    out.inputs.push_back(input_model_of(each));
  return out;
}

const input_model* input_of(const class_model& x, std::string_view name) {
  const auto wanted = folded(name);
  const auto found = std::ranges::find_if(
      x.inputs, [&wanted](const auto& each) { return folded(each.name) == wanted; });
  return found == x.inputs.end() ? nullptr : &*found;
}

std::optional<std::string> accepted(const input_model& x, std::string_view text) {
  const auto wanted = folded(text);
  for (const auto& word : x.words)
    if (folded(word) == wanted)
      return word;
  const auto number = number_in(text);
  if (x.numbers && number && *number >= x.numbers->min && *number <= x.numbers->max)
    return shortest_decimal(*number);
  return std::nullopt;
}

std::vector<std::string> suffixes_of(const class_model& x) {
  std::vector<std::string> out{"class", "status"};
  for (const auto& each : x.fields)
    out.push_back(each.name);
  for (const auto& each : x.inputs)
    out.push_back(each.name + ".outcome");
  return out;
}

std::string folded(std::string_view x) {
  std::string out(x);
  for (auto& c : out)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return out;
}

} // namespace rubicon::bridge
