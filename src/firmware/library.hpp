// A shared library that is to be the firmware of a mote: its file, judged without running any of it
// (docs/firmware.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "core/bytes.hpp"

namespace rubicon::firmware {

inline constexpr std::size_t library_octets_max = std::size_t{16} << 20;

/// The object that a firmware exports.
inline constexpr const char* exported_name = "rubicon_mote_firmware";

/// What the exported object says before any function of it is called.
struct library_facts {
  std::uint32_t version = 0;
  std::uint32_t flags = 0;

  [[nodiscard]] bool runs_in_wall_time() const { return (flags & 1U) != 0; }

  friend bool operator==(const library_facts&, const library_facts&) = default;
};

/// Reads an ELF file of 64 bits.
/// @returns the facts, or what is wrong in words: `exports no rubicon_mote_firmware`
[[nodiscard]] std::variant<library_facts, std::string> inspect(byte_view file);

/// Whether a host of this version can run it. @returns what is wrong; empty: nothing
[[nodiscard]] std::string refusal(const library_facts& x);

struct library {
  std::string name; ///< of its file: `blink.so`
  bytes octets;
  library_facts facts;
};

} // namespace rubicon::firmware
