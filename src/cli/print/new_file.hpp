// Files that commands write for their user.
#pragma once

#include <string>
#include <string_view>

namespace rubicon::cli {

/// Writes a file, and one that exists only if it `replaces` it.
/// @returns why it is not written; empty: it is
[[nodiscard]] std::string write_new_file(const std::string& path, std::string_view text,
                                         bool replaces);

} // namespace rubicon::cli
