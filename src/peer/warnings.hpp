// Warnings of a peer to the person who runs the program.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "core/time.hpp"

namespace rubicon::peer {

/// Those that can recur are given at most once in `gap` for each kind.
class warnings {
public:
  enum class kind : std::uint8_t { rare_steps, slow_callback, failed_attempt, taken_id };

  static constexpr duration gap = 10s;

  /// @param to may be empty
  explicit warnings(std::function<void(const std::string&)> to) : to_(std::move(to)) {}

  void give(const std::string& text) const;
  void give(kind which, const std::string& text, instant now);

private:
  static constexpr std::size_t kinds = 4;

  std::function<void(const std::string&)> to_;
  std::array<std::optional<instant>, kinds> last_;
};

} // namespace rubicon::peer
