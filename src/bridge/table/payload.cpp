#include "bridge/table/payload.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "bridge/table/class_model.hpp"
#include "core/text/decimal.hpp"
#include "core/text/json.hpp"

namespace rubicon::bridge {

namespace {

/// Of brackets outside of texts, whether they match or not.
std::size_t depth_of(std::string_view text) {
  std::size_t depth = 0;
  std::size_t deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == '{' || c == '['))
      deepest = std::max(deepest, ++depth);
    else if (!quoted && (c == '}' || c == ']') && depth > 0)
      --depth;
  }
  return deepest;
}

} // namespace

nlohmann::json bounded_json(std::string_view text) {
  if (depth_of(text) > json_depth_max)
    return nlohmann::json::value_t::discarded;
  return try_parse_json(text);
}

std::optional<std::string> word_in(const nlohmann::json& x) {
  if (x.is_string())
    return x.get<std::string>();
  if (x.is_number_unsigned())
    return std::to_string(x.get<std::uint64_t>());
  if (x.is_number_integer())
    return std::to_string(x.get<std::int64_t>());
  if (x.is_number())
    return shortest_decimal(x.get<double>());
  if (x.is_boolean())
    return x.get<bool>() ? "on" : "off";
  return std::nullopt;
}

std::optional<std::string> text_of(payload_type type, std::string_view payload) {
  switch (type) {
  case payload_type::text:
    return payload.size() <= payload_text_max ? std::optional<std::string>(payload) : std::nullopt;
  case payload_type::number: {
    const auto number = number_in(payload);
    return number ? std::optional(shortest_decimal(*number)) : std::nullopt;
  }
  case payload_type::flag: {
    const auto word = folded(payload);
    if (word == "on" || word == "true" || word == "1")
      return "on";
    return word == "off" || word == "false" || word == "0" ? std::optional<std::string>("off")
                                                           : std::nullopt;
  }
  }
  return std::nullopt;
}

} // namespace rubicon::bridge
