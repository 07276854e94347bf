// What `run --record` has written, read and put together.
#pragma once

#include <string>
#include <variant>

#include "explain/traces.hpp"

namespace rubicon::cli {

/// @returns the traces, or what is wrong: `run.rec:12: the line is no JSON`
[[nodiscard]] std::variant<explain::traces, std::string> read_record(const std::string& path);

} // namespace rubicon::cli
