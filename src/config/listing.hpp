// `rubicon check --list`: who and what can be named.
#pragma once

#include <string>

#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// Motes and peers with their ids, types and labels, and the keys of tuples with their owners, a
/// line each and a section each. All of them: it is for programs that search, too.
[[nodiscard]] std::string listing(const ecology_description& x);

} // namespace rubicon::config
