// Runs whole ecologies in tests.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "actors/run.hpp"
#include "config/ecology.hpp"
#include "runtime/report.hpp"

namespace rubicon::test {

/// The description of an example file of the repository. Throws if the file has problems.
[[nodiscard]] config::ecology_description example(std::string_view file);

/// The description in `toml`. Throws if it has problems.
[[nodiscard]] config::ecology_description ecology_of(std::string_view toml);

[[nodiscard]] runtime::report run(const config::ecology_description& what, std::uint64_t seed = 1);

/// Whether somebody whose name ends with `who` is told to have done something that begins with
/// `what`.
[[nodiscard]] bool tells(const runtime::report& x, std::string_view who, std::string_view what);

/// A line for each violated invariant; empty: there is none.
[[nodiscard]] std::string told_violations(const runtime::report& x);

/// The proxy of that name. Throws if there is none.
[[nodiscard]] const runtime::proxy_report& proxy_of(const runtime::report& x,
                                                    std::string_view name);

/// What a proxy says under that name; empty if nothing.
[[nodiscard]] std::string value(const runtime::proxy_report& x, std::string_view name);

} // namespace rubicon::test
