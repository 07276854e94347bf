// A sample of a run as text, a column for each field: what the record of a run keeps of it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "report/history.hpp"

namespace rubicon::view {

/// Of more motes their neighbours are left out.
inline constexpr std::size_t motes_with_neighbours_max = 500;
/// Of more peers all.
inline constexpr std::size_t peers_listed_max = 500;

[[nodiscard]] std::string encode(const report::run_sample& x);

/// @returns nothing of what is no sample
[[nodiscard]] std::optional<report::run_sample> decode_sample(std::string_view text);

} // namespace rubicon::view
