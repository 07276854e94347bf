#include "bridge/mqtt/payloads.hpp"

#include <nlohmann/json.hpp>

#include "bridge/table/payload.hpp"

namespace rubicon::bridge {

std::string availability_payload(bool online) {
  return online ? R"({"state":"online"})" : R"({"state":"offline"})";
}

std::optional<std::string> tuple_text(const topic_rule& rule, std::string_view payload) {
  if (rule.member.empty())
    return text_of(rule.type, payload);
  const auto parsed = bounded_json(payload);
  if (!parsed.is_object() || !parsed.contains(rule.member))
    return std::nullopt;
  const auto word = word_in(parsed.at(rule.member));
  return word ? text_of(rule.type, *word) : std::nullopt;
}

} // namespace rubicon::bridge
