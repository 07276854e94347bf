// Which packets of which origins have come.
#pragma once

#include <cstdint>
#include <map>

#include "core/address.hpp"

namespace rubicon::network {

/// For each origin its newest packet and which of the 31 before it have come (as RFC 4303 3.4.3,
/// with numbers that wrap). What is older begins a window anew: the origin has been started again,
/// with another number. A root's, which has a PC's memory: it may keep a window for each id.
class sequence_windows {
public:
  /// Remembers it. @returns false if it has come before
  [[nodiscard]] bool take(mote_id origin, std::uint16_t sequence) {
    auto& x = windows_[origin];
    const auto ahead = static_cast<std::int16_t>(sequence - x.newest);
    if (ahead > 0 || ahead <= -width || x.seen == 0) {
      x.seen = ahead > 0 && ahead < width ? x.seen << ahead | 1U : 1U;
      x.newest = sequence;
      return true;
    }
    const auto bit = 1U << -ahead;
    const bool is_new = (x.seen & bit) == 0;
    x.seen |= bit;
    return is_new;
  }

private:
  static constexpr int width = 32;

  struct window {
    std::uint16_t newest = 0;
    std::uint32_t seen = 0; ///< bit i: newest - i
  };

  std::map<mote_id, window> windows_;
};

} // namespace rubicon::network
