// Gives memory that this process has freed, but that the allocator keeps, back to the system.
#pragma once

#include <chrono>
#include <cstddef>

#include "core/time.hpp"

namespace rubicon::io {

/// Resident memory of this process in octets; 0 if the system does not report it.
[[nodiscard]] std::size_t resident_memory();

/// After a flood most of what it took lies about free between what lives on, and stays resident for
/// ever if nobody asks for it. To be called often: looks every few seconds only.
class spare_memory {
public:
  using time_point = std::chrono::steady_clock::time_point;

  /// Less than this is never worth the search.
  static constexpr std::size_t least = std::size_t{16} << 20U;
  static constexpr duration period = 5s;
  /// What a search has left lies between what lives. The next one comes when half of `least` has
  /// been freed since, or after so long.
  static constexpr duration pause = 60s;

  /// @returns the octets given back
  std::size_t give_back(time_point now);

private:
  time_point next_look_{};
  time_point next_search_{};
  std::size_t left_ = 0; ///< spare octets that the last search could not give back
};

} // namespace rubicon::io
