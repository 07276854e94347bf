#include "config/toml/form.hpp"

#include <cmath>
#include <limits>

#include "config/toml/document.hpp"

namespace rubicon::config {

namespace {

json_text json_strings(const std::vector<std::string>& all) {
  std::vector<json_text> elements;
  for (const auto& each : all)
    elements.push_back(json_string(each));
  return json_array(elements);
}

} // namespace

json_text json_string(std::string_view x) {
  json_text out = "\"";
  for (const char c : x) {
    if (c == '"' || c == '\\')
      out += '\\';
    out += c;
  }
  return out + '"';
}

json_text json_number(double x) {
  constexpr double exact_max = 1e15;
  if (std::abs(x) < exact_max && x == std::floor(x))
    return std::to_string(static_cast<std::int64_t>(x));
  return shown(x);
}

json_text json_object(std::initializer_list<std::pair<std::string_view, json_text>> members) {
  json_text out;
  for (const auto& [name, value] : members)
    out += (out.empty() ? "" : ",") + json_string(name) + ':' + value;
  return '{' + out + '}';
}

json_text with_member(json_text object, std::string_view name, const json_text& value) {
  object.pop_back(); // the brace
  return std::move(object) + ',' + json_string(name) + ':' + value + '}';
}

json_text json_array(const std::vector<json_text>& elements) {
  json_text out;
  for (const auto& each : elements)
    out += (out.empty() ? "" : ",") + each;
  return '[' + out + ']';
}

json_text either_schema(const json_text& a, const json_text& b) {
  return json_object({{"anyOf", json_array({a, b})}});
}

json_text type_schema(std::string_view type) {
  return json_object({{"type", json_string(type)}});
}

json_text integer_schema(std::int64_t min, std::optional<std::int64_t> max) {
  auto out = json_object({{"type", json_string("integer")}, {"minimum", std::to_string(min)}});
  return max ? with_member(std::move(out), "maximum", std::to_string(*max)) : out;
}

json_text pattern_schema(const std::string& x) {
  return json_object({{"type", json_string("string")}, {"pattern", json_string('^' + x + '$')}});
}

form string_form(std::string wanted) {
  return {std::move(wanted), type_schema("string")};
}

form types_form(std::string wanted, const std::vector<std::string>& types) {
  return {std::move(wanted), json_object({{"type", json_strings(types)}})};
}

form whole_form(std::int64_t min, std::optional<std::int64_t> max) {
  return {max ? std::to_string(min) + " to " + std::to_string(*max)
              : "number from " + std::to_string(min),
          integer_schema(min, max)};
}

form word_form(const std::vector<std::string>& words) {
  form out{{}, json_object({{"enum", json_strings(words)}})};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto join = i + 1 == words.size() ? " or " : ", ";
    out.wanted += (i == 0 ? "" : join) + ("`\"" + words[i] + "\"`");
  }
  return out;
}

form list_form(const form& of, std::size_t min, std::size_t max) {
  const bool is_bounded = max < std::numeric_limits<std::size_t>::max();
  form out{"array", json_object({{"type", json_string("array")}, {"items", of.schema}})};
  if (min > 0)
    out.schema = with_member(std::move(out.schema), "minItems", std::to_string(min));
  if (is_bounded)
    out.schema = with_member(std::move(out.schema), "maxItems", std::to_string(max));
  if (is_bounded)
    out.wanted +=
        (min == 0 ? " of up to " : " of " + std::to_string(min) + " to ") + std::to_string(max);
  else if (min > 0)
    out.wanted += " of at least " + std::to_string(min);
  out.wanted += ", each a " + of.wanted;
  return out;
}

form pairs_form(const form& of) {
  return {"table, each value a " + of.wanted,
          json_object({{"type", json_string("object")}, {"additionalProperties", of.schema}})};
}

} // namespace rubicon::config
