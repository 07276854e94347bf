// JSON read and written. Nlohmann's parser and its writer are compiled here alone, not in each file
// that has JSON.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace rubicon {

/// @throws nlohmann::json::parse_error, and nlohmann::json::out_of_range for a number that is too
/// large
[[nodiscard]] nlohmann::json parse_json(std::string_view text);
[[nodiscard]] nlohmann::ordered_json parse_ordered_json(std::string_view text);

/// Text of others: what is no JSON becomes a value that `is_discarded()`.
[[nodiscard]] nlohmann::json try_parse_json(std::string_view text);
[[nodiscard]] nlohmann::ordered_json try_parse_ordered_json(std::string_view text);

/// One line. Octets that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string json_line(const nlohmann::json& x);
[[nodiscard]] std::string json_line(const nlohmann::ordered_json& x);

/// The same, a value a line, indented by 2.
[[nodiscard]] std::string json_lines(const nlohmann::json& x);
[[nodiscard]] std::string json_lines(const nlohmann::ordered_json& x);

/// One line whose characters beyond ASCII are written as `\u20ac`.
[[nodiscard]] std::string ascii_json_line(const nlohmann::ordered_json& x);

} // namespace rubicon
