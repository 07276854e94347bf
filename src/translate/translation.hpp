// The configuration of the app `translate` (SVC-09).
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "translate/expression.hpp"

namespace rubicon::translate {

/// From one tuple to another, and its history.
struct translation {
  std::string from;                ///< key of any owner; a part may be `*`
  std::string to;                  ///< own key; {1} is what the first `*` stands for; empty: none
  std::optional<expression> value; ///< of the number; unset: the text as it is
  int decimals = 2;                ///< of the number, 0..6
  std::string unit;                ///< published beside it, if not empty
  std::size_t history = 0;         ///< newest values in KEY.history, up to history_max
};

inline constexpr std::size_t history_max = 100;

} // namespace rubicon::translate
