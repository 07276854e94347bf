// Text for somebody who may have stopped to read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/time.hpp"

namespace rubicon::io {

/// Writes to a terminal or pipe and never waits for who reads there: what is not taken stays in a
/// buffer, and of what has no room in it nothing is written. Files, and what the system does not
/// let anybody open anew, are written to as always.
class unwaiting_output {
public:
  static constexpr std::size_t buffer_octets_max = 1 << 16;

  /// @param descriptor is not changed, as others may share it
  explicit unwaiting_output(int descriptor);
  ~unwaiting_output();
  unwaiting_output(const unwaiting_output&) = delete;
  unwaiting_output& operator=(const unwaiting_output&) = delete;

  /// All of a text or nothing of it.
  void write(std::string_view text);

  /// How many texts were left out since it was asked before; 0 while there is no room for more.
  [[nodiscard]] std::uint64_t missed();

  /// Waits so long at most until the buffer is empty. @returns whether it is
  bool flush(duration patience);

private:
  void write_some();

  int descriptor_;
  bool is_own_ = false;
  std::string buffer_;
  std::uint64_t missed_ = 0;
};

} // namespace rubicon::io
