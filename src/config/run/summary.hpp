// What a file describes, on one screen.
#pragma once

#include <string>

#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// What `rubicon check` prints: islands with their motes by type, peers with links and apps, hosts,
/// proxies with the types they claim, faults with their times. At most 100 columns wide as long as
/// names are short; ends with a newline.
[[nodiscard]] std::string summary(const ecology_description& x);

} // namespace rubicon::config
