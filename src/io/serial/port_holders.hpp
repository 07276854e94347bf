// Which other programs have a terminal open.
#pragma once

#include <string>

namespace rubicon::io {

/// One of those that this user may see, without this process: `sf (process 1234)`; empty: none.
/// Programs that take no lock, as TinyOS's, cannot be found otherwise.
[[nodiscard]] std::string holder_of_terminal(const std::string& path);

} // namespace rubicon::io
