// Lines that a log repeats: a program that fails all the time must not fill a terminal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace rubicon::cli {

/// Counts lines that are equal but for their first word, the time. Of equal ones some are shown.
class repeated_lines {
public:
  enum class verdict : std::uint8_t {
    shown,
    last, ///< shown, with a note that equal ones follow no more
    left_out,
  };

  static constexpr std::size_t shown_max = 3;  ///< of equal ones
  static constexpr std::size_t known_max = 64; ///< different ones; all others are shown

  [[nodiscard]] verdict next(std::string_view line) {
    const auto text = line.substr(std::min(line.find(' '), line.size()));
    auto found = counts_.find(text);
    if (found == counts_.end()) {
      if (counts_.size() < known_max)
        counts_.emplace(text, 1);
      return verdict::shown;
    }
    if (found->second >= shown_max)
      return verdict::left_out;
    return ++found->second == shown_max ? verdict::last : verdict::shown;
  }

private:
  std::map<std::string, std::size_t, std::less<>> counts_;
};

} // namespace rubicon::cli
