// Writing a file so that whoever reads it finds all of it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rubicon::io {

enum class durability : std::uint8_t {
  of_process, ///< it is there after this process
  of_power,   ///< and after a loss of power, which costs a write to the disk
};

/// Replaces it at once: its readers find the content or what was there before, nothing in between.
/// Only its owner may read it.
/// @returns empty, or why it is not written: `PATH cannot be written: No space left on device`
[[nodiscard]] std::string replace_file(const std::string& path, std::string_view content,
                                       durability how = durability::of_process);

} // namespace rubicon::io
