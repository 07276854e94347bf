// Text of others on its way to a terminal or into a log.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rubicon {

/// Octets of the UTF-8 character at the front of `x`, 0 if there is none (RFC 3629 section 4).
/// @pre `x` is not empty
[[nodiscard]] std::size_t character_size(std::string_view x);

/// `x` as one line that shows everything and does nothing: names and values may come from anybody
/// on the network. Newlines become `\n`, other control characters `\t`, `\r` or `\x1b`, octets that
/// are not UTF-8 `\xff`, and characters that move a terminal's cursor, end a line or turn the
/// direction of text (C1 controls, U+2028, U+202E, ...) `\u202e`. Backslashes stay, so that a text
/// made printable once may be made so again; it is for eyes, not for reading back.
/// @param octets_max of the result, some more for the last character; what is cut off shows as `…`
[[nodiscard]] std::string printable(std::string_view x, std::size_t octets_max = std::string::npos);

/// JSON as it may be shown: what JSON lets stand in a text though it disturbs a terminal (DEL, C1
/// controls, and the like) is written as `\u009b`, which means the same.
/// @param json well-formed, in UTF-8
[[nodiscard]] std::string printable_json(std::string json);

} // namespace rubicon
