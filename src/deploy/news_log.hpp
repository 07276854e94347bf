// The output of a host's part: the newest lines, numbered from 1.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace rubicon::deploy {

class news_log {
public:
  static constexpr std::size_t lines_max = 4096;
  static constexpr std::size_t line_octets_max = 4096;

  /// The oldest is dropped when there are too many; one that is too long is cut.
  void add(std::string line);

  struct page {
    std::vector<std::string> lines;
    std::uint64_t last = 0;     ///< number of the last one
    std::uint64_t left_out = 0; ///< that were dropped before they were requested
  };

  /// The lines after that number.
  [[nodiscard]] page after(std::uint64_t number) const;

private:
  std::deque<std::string> lines_;
  std::uint64_t last_ = 0;
};

} // namespace rubicon::deploy
