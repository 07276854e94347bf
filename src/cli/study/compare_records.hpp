// Where two records of one seed part.
#pragma once

#include <cstdint>
#include <istream>
#include <string>

namespace rubicon::cli {

/// What is found by reading both line by line.
struct record_difference {
  bool differs = false;
  std::uint64_t equal = 0; ///< records before the first that differs
  std::string text;        ///< lines for a person
  std::string problem;     ///< one is no record: why; the rest is unset
};

/// @param a_name, b_name what they are called
[[nodiscard]] record_difference compare_records(std::istream& a, const std::string& a_name,
                                                std::istream& b, const std::string& b_name);

} // namespace rubicon::cli
