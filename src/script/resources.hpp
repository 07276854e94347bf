// What a script has besides its layer, and how much of each (docs/lua.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "apps/application.hpp"
#include "core/time.hpp"

namespace rubicon::script {

inline constexpr std::size_t timers_max = 16;
inline constexpr std::size_t figures_max = 16;
inline constexpr std::size_t notices_max = 16; ///< of one event
inline constexpr std::size_t text_max = 256;   ///< octets of a notice or a figure's name
inline constexpr duration timer_min = 1ms;

/// Timers, figures and notices of one script. Errors are texts, nullptr if there is none.
class resources {
public:
  struct expiry {
    int function = 0;
    bool is_last = false; ///< the timer is gone
  };

  void begin_event() { notices_ = 0; }

  /// Of the present event there may be one more notice.
  [[nodiscard]] const char* add_notice();

  [[nodiscard]] const char* set_figure(std::string_view name, double value);
  [[nodiscard]] const std::vector<apps::figure>& figures() const { return figures_; }

  /// @param function a reference in Lua's registry
  /// @returns its number, or nothing: there are timers_max
  [[nodiscard]] std::optional<std::uint32_t> add_timer(instant now, duration after, bool repeats,
                                                       int function);
  /// @returns the reference, to be released, or nothing: there is no such timer
  [[nodiscard]] std::optional<int> remove_timer(std::uint32_t number);

  [[nodiscard]] std::optional<instant> deadline() const; ///< of the first timer
  /// Numbers of those that expire, in order.
  [[nodiscard]] std::vector<std::uint32_t> due(instant now) const;
  /// One of them; nothing: it has been removed since. What comes late expires once.
  [[nodiscard]] std::optional<expiry> expire(std::uint32_t number, instant now);

private:
  struct timer {
    std::uint32_t number = 0;
    instant due;
    duration period{}; ///< 0: it expires once
    int function = 0;
  };

  std::vector<timer> timers_;
  std::uint32_t timers_so_far_ = 0;
  std::vector<apps::figure> figures_;
  std::size_t notices_ = 0; ///< of this event
};

} // namespace rubicon::script
