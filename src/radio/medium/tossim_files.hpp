// Reads TOSSIM's topology and noise files as they are (tinyos.md 7.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "radio/medium/noise.hpp"

namespace rubicon::radio {

/// `gain FROM TO DB` lines and `noise NODE FLOOR DEVIATION` lines of a topology. The deviation is
/// read and not used: a floor is constant here.
struct gain_table {
  struct gain {
    std::uint16_t from = 0;
    std::uint16_t to = 0;
    float db = 0; ///< received dBm at 0 dBm sent

    friend bool operator==(const gain&, const gain&) = default;
  };
  struct floor {
    std::uint16_t node = 0;
    float dbm = 0;

    friend bool operator==(const floor&, const floor&) = default;
  };

  std::vector<gain> gains;   ///< ascending by from, then to; no pair twice
  std::vector<floor> floors; ///< ascending by node; none twice

  friend bool operator==(const gain_table&, const gain_table&) = default;
};

/// What is wrong with a file, and where; line 0: with the file as a whole.
struct file_problem {
  std::size_t line = 0;
  std::string message; ///< `gain needs two nodes and a number of dB, not "x"`
};

inline constexpr std::size_t tossim_file_octets_max = 256U << 20U;

/// Lines `gain FROM TO DB`, also without the word, and `noise NODE FLOOR DEVIATION`, the words in
/// any letter case. Fields are separated by blanks, tabs, commas or semicolons; empty lines and
/// what is behind #, % or // are left out, lines may end with CR LF, and a byte order mark is. The
/// first mistake ends the reading: unknown word, missing or surplus field, not a finite number,
/// node above 65534, gain or floor outside -250..50 dBm, a link or node given twice, a link from a
/// node to itself, no gain at all, more than tossim_file_octets_max. A quoted text in a message is
/// cut to 40 octets, control characters and octets outside ASCII shown as `?`.
[[nodiscard]] std::variant<gain_table, file_problem> read_topology(std::string_view text);

/// One number a line, -128..127 dBm; fractions are rounded down. Lines are left out and mistakes
/// reported as in a topology. Fewer than noise_trace::readings_min readings or more than
/// readings_max are refused.
[[nodiscard]] std::variant<std::shared_ptr<const noise_trace>, file_problem>
read_noise_trace(std::string_view text);

} // namespace rubicon::radio
