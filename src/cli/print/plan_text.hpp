// What would run where, and which ports it would take.
#pragma once

#include <string>

#include "config/plan/ecology.hpp"

namespace rubicon::cli {

[[nodiscard]] std::string plan_text(const config::ecology_description& all);

} // namespace rubicon::cli
