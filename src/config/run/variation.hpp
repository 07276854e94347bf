// What the seed of a run decides of its file: values of parameters with a range, and the kinds of
// faults that it leaves out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/toml/settings.hpp"

namespace rubicon::config {

struct variation {
  parameter_values drawn;
  std::vector<std::string> left_out; ///< kinds of faults, ascending

  [[nodiscard]] bool empty() const { return drawn.empty() && left_out.empty(); }

  friend bool operator==(const variation&, const variation&) = default;
};

/// @param toml of a file; one with a problem has none
[[nodiscard]] variation variation_of(std::string_view toml, const settings& all,
                                     std::uint64_t seed);

/// `outage=12.3s, without crash`; empty: the seed decides nothing.
[[nodiscard]] std::string to_text(const variation& x);

} // namespace rubicon::config
