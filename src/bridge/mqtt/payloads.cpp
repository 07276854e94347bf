#include "bridge/mqtt/payloads.hpp"

#include <nlohmann/json.hpp>

#include "bridge/table/object_table.hpp"
#include "core/text/decimal.hpp"

namespace rubicon::bridge {

std::string availability_payload(bool online) {
  return online ? R"({"state":"online"})" : R"({"state":"offline"})";
}

std::optional<std::string> word_in(const nlohmann::json& x) {
  if (x.is_string())
    return x.get<std::string>();
  if (x.is_number())
    return shortest_decimal(x.get<double>());
  if (x.is_boolean())
    return x.get<bool>() ? "on" : "off";
  return std::nullopt;
}

std::optional<std::string> tuple_text(const topic_rule& rule, std::string_view payload) {
  std::string text(payload);
  if (!rule.member.empty()) {
    const auto parsed = nlohmann::json::parse(payload, nullptr, false);
    if (!parsed.is_object() || !parsed.contains(rule.member))
      return std::nullopt;
    const auto word = word_in(parsed.at(rule.member));
    if (!word)
      return std::nullopt;
    text = *word;
  }
  switch (rule.type) {
  case payload_type::text:
    return text.size() <= object_table::value_max ? std::optional(text) : std::nullopt;
  case payload_type::number: {
    const auto number = number_in(text);
    return number ? std::optional(shortest_decimal(*number)) : std::nullopt;
  }
  case payload_type::flag: {
    const auto word = folded(text);
    if (word == "on" || word == "true" || word == "1")
      return "on";
    return word == "off" || word == "false" || word == "0" ? std::optional<std::string>("off")
                                                           : std::nullopt;
  }
  }
  return std::nullopt;
}

} // namespace rubicon::bridge
