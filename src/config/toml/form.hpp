// What a value may be, for people and as JSON Schema. JSON is text here: the library that reads it
// is slow to compile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rubicon::config {

/// JSON, as text; empty: none.
using json_text = std::string;

/// What a kind takes.
struct form {
  std::string wanted; ///< for people, in Markdown: `time from 1 s to 1 d`
  json_text schema;   ///< a JSON Schema
};

/// A text as JSON. @pre it has no control characters
[[nodiscard]] json_text json_string(std::string_view x);

/// Whole numbers without a point.
[[nodiscard]] json_text json_number(double x);

/// An object with these members.
[[nodiscard]] json_text
json_object(std::initializer_list<std::pair<std::string_view, json_text>> members);

/// An object with one member more. @pre it has members
[[nodiscard]] json_text with_member(json_text object, std::string_view name,
                                    const json_text& value);

[[nodiscard]] json_text json_array(const std::vector<json_text>& elements);

/// The schema of values that one of two holds for.
[[nodiscard]] json_text either_schema(const json_text& a, const json_text& b);

/// The schema of values of a type of JSON.
[[nodiscard]] json_text type_schema(std::string_view type);

/// The schema of whole numbers.
[[nodiscard]] json_text integer_schema(std::int64_t min,
                                       std::optional<std::int64_t> max = std::nullopt);

/// The schema of texts that a regular expression holds for.
[[nodiscard]] json_text pattern_schema(const std::string& x);

[[nodiscard]] form string_form(std::string wanted);
[[nodiscard]] form types_form(std::string wanted, const std::vector<std::string>& types);
[[nodiscard]] form whole_form(std::int64_t min, std::optional<std::int64_t> max);
[[nodiscard]] form word_form(const std::vector<std::string>& words);
[[nodiscard]] form list_form(const form& of, std::size_t min, std::size_t max);
[[nodiscard]] form pairs_form(const form& of);

} // namespace rubicon::config
