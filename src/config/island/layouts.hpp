// Where the motes of a group stand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "config/toml/table_reader.hpp"
#include "core/address.hpp"

namespace rubicon::config {

/// Whose random numbers place the motes of a disk.
struct layout_rng {
  std::uint64_t seed = 1;
  std::string path; ///< unlike that of any other group
};

/// layout = "grid", "line", "ring" or "disk" with its keys.
/// @returns `count` places; nothing if there was a mistake
[[nodiscard]] std::vector<position> read_layout(table_reader& in, std::size_t count,
                                                const layout_rng& rng);

} // namespace rubicon::config
