// What others send to a bridge, as the text of a tuple.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace rubicon::bridge {

/// What a value is, and so the text of the tuple made of it.
enum class payload_type : std::uint8_t { text, number, flag };

/// Longest text of a tuple that a bridge sets, in octets.
inline constexpr std::size_t payload_text_max = 256;

/// Deepest nesting of JSON that a bridge reads.
inline constexpr std::size_t json_depth_max = 32;

/// Text as JSON, `discarded` if it is not JSON or nested deeper than json_depth_max.
[[nodiscard]] nlohmann::json bounded_json(std::string_view text);

/// A text, number or truth value of JSON; nothing if it is neither.
[[nodiscard]] std::optional<std::string> word_in(const nlohmann::json& x);

/// As the text of a tuple: numbers in their shortest form, flags as `on` and `off`.
/// @returns nothing if the payload is not of that type
[[nodiscard]] std::optional<std::string> text_of(payload_type type, std::string_view payload);

} // namespace rubicon::bridge
