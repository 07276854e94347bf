// Log lines about refused connections, at a limited rate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/time.hpp"

namespace rubicon::control {

class refusal_log {
public:
  static constexpr duration period = 1min;
  static constexpr std::size_t lines_max = 10; ///< of a period
  static constexpr std::size_t known_max = 64; ///< different ones that are remembered

  /// @returns the line to write, if there is to be one: the same one once in a period
  [[nodiscard]] std::optional<std::string> note(const std::string& who, const std::string& why,
                                                instant now);

  /// How many were left out, when it is time to say so: by a call at deadline() or later.
  [[nodiscard]] std::optional<std::string> on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  std::map<std::string, instant> reported_;
  instant begun_;
  std::size_t lines_ = 0;
  std::uint64_t left_out_ = 0;
};

} // namespace rubicon::control
