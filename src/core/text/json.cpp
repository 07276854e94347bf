#include "core/text/json.hpp"

#include <nlohmann/json.hpp>

namespace rubicon {

namespace {

constexpr int on_one_line = -1;
constexpr int indented = 2;

template <class Json>
std::string text_of(const Json& x, int indent, bool ascii = false) {
  return x.dump(indent, ' ', ascii, Json::error_handler_t::replace);
}

} // namespace

nlohmann::json parse_json(std::string_view text) {
  return nlohmann::json::parse(text);
}

nlohmann::ordered_json parse_ordered_json(std::string_view text) {
  return nlohmann::ordered_json::parse(text);
}

nlohmann::json try_parse_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
}

nlohmann::ordered_json try_parse_ordered_json(std::string_view text) {
  return nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
}

std::string json_line(const nlohmann::json& x) {
  return text_of(x, on_one_line);
}

std::string json_line(const nlohmann::ordered_json& x) {
  return text_of(x, on_one_line);
}

std::string json_lines(const nlohmann::json& x) {
  return text_of(x, indented);
}

std::string json_lines(const nlohmann::ordered_json& x) {
  return text_of(x, indented);
}

std::string ascii_json_line(const nlohmann::ordered_json& x) {
  return text_of(x, on_one_line, true);
}

} // namespace rubicon
