// Text as the macros of man(7) take it.
#pragma once

#include <string>
#include <string_view>

namespace rubicon::cli::roff {

/// Characters that would mean something else, or another character.
[[nodiscard]] std::string escaped(std::string_view text);

[[nodiscard]] std::string bold(std::string_view text);
[[nodiscard]] std::string italic(std::string_view text);

/// An argument of a macro.
[[nodiscard]] std::string quoted(std::string_view text);

/// A text that is filled, in lines of up to 78 octets where words allow it.
[[nodiscard]] std::string filled(std::string_view text);

/// Lines that stay as they are.
[[nodiscard]] std::string literal(std::string_view lines);

/// Paragraphs between empty lines: those with indented lines stay as they are. The first one has
/// no macro before it.
[[nodiscard]] std::string paragraphs(std::string_view text);

} // namespace rubicon::cli::roff
