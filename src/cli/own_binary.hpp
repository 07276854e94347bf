// This program, to be started again.
#pragma once

namespace rubicon::cli {

/// Its path, also after the file has been replaced by a newer one.
inline constexpr const char* own_binary = "/proc/self/exe";

} // namespace rubicon::cli
