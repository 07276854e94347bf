// What is no mistake in a file, and yet cannot work: readers of tuples that nobody has, fields that
// no program sends, things of one place on different hosts.
#pragma once

#include <string>
#include <vector>

#include "config/ecology.hpp"

namespace rubicon::config {

/// One sentence each, at most `doubts_max`. Nothing is said about tuples when peers of other
/// processes may come, which have whatever they have.
[[nodiscard]] std::vector<std::string> doubts(const ecology_description& x);

inline constexpr std::size_t doubts_max = 50;

} // namespace rubicon::config
