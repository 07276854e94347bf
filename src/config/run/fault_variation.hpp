// Runs of a swarm that leave out kinds of faults, each by chance ([ecology] vary_faults).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/toml/document.hpp"

namespace rubicon::config {

inline constexpr std::string_view vary_faults_key = "vary_faults";

/// Whether the run with that seed has no faults of a kind, `crash`: in half of the seeds.
[[nodiscard]] bool leaves_out(std::uint64_t seed, std::string_view kind);

/// @param root of a file
[[nodiscard]] bool varies_faults(const node& root);

/// Kinds of the faults that a file has and varies, each once, ascending.
[[nodiscard]] std::vector<std::string> varied_kinds(const node& root);

} // namespace rubicon::config
