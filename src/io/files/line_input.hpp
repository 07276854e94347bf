// Text that comes in pieces, line by line.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "core/bytes.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// Lines of octets that come in pieces.
class line_splitter {
public:
  static constexpr std::size_t line_octets_max = 4096; ///< a longer line comes in several

  /// Calls f(line), without its end, for each line that is complete now. Empty ones are left out.
  template <class F>
  void take(byte_view octets, F f) {
    for (const auto octet : octets) {
      if (octet != '\n')
        line_ += static_cast<char>(octet);
      if ((octet == '\n' || line_.size() >= line_octets_max) && !line_.empty())
        f(std::exchange(line_, {}));
    }
  }

private:
  std::string line_;
};

/// The lines of this process's standard input, as events of the loop, until it ends.
class line_input {
public:
  using callback = std::function<void(std::string line)>;

  /// @param where must outlive it
  line_input(loop& where, callback on_line);
  ~line_input();
  line_input(const line_input&) = delete;
  line_input& operator=(const line_input&) = delete;

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
