// Reads the golden vectors of tests/golden.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/bytes.hpp"

namespace rubicon::test {

/// One case of a `key: value` file.
using vector_case = std::map<std::string, std::string, std::less<>>;

/// Cases of a file in tests/golden with one `key: value` a line, blank lines between cases and `#`
/// comments. Throws std::runtime_error when the file cannot be read.
[[nodiscard]] std::vector<vector_case> read_cases(std::string_view file);

/// Octets of a hex file in tests/golden in which `#` starts a comment. Throws as above.
[[nodiscard]] bytes read_hex_file(std::string_view file);

} // namespace rubicon::test
