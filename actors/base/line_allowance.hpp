// How many log lines others may bring about.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "core/time.hpp"

namespace rubicon {

/// Keeps others from filling a log with lines that they bring about: so many in a while, then
/// silence. What is left out is counted and told with the next line.
class line_allowance {
public:
  static constexpr unsigned lines_max = 20;
  static constexpr duration period = 10s;

  /// May a line be written? How many were left out since the last one; unset: no.
  [[nodiscard]] std::optional<std::uint64_t> ask(instant now) {
    if (!since_ || now - *since_ >= period) {
      since_ = now;
      lines_ = 0;
    }
    if (lines_ == lines_max) {
      ++left_out_;
      return std::nullopt;
    }
    ++lines_;
    return std::exchange(left_out_, 0);
  }

private:
  std::optional<instant> since_;
  unsigned lines_ = 0;
  std::uint64_t left_out_ = 0;
};

} // namespace rubicon
