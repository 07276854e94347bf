// Log lines of actors: ecology time, level, who, then key=value pairs, so that equal runs write
// equal logs (style: one line an event).
#pragma once

#include <cstddef>
#include <string_view>
#include <utility>

#include <spdlog/spdlog.h>

#include "actors/timer.hpp"
#include "core/printable.hpp"
#include "scheduler/process.hpp"

namespace rubicon {

inline constexpr std::size_t log_octets_max = 8192; ///< of a line: a value may be very long

/// Logs `12.004160 W mote/kitchen/climate-7 event=refused ...` if the level is on, as one line that
/// is printable(), whatever it quotes.
template <class Self, class... Args>
void log_as(Self* self, std::string_view who, spdlog::level::level_enum level,
            spdlog::format_string_t<Args...> format, Args&&... args) {
  auto* const logger = spdlog::default_logger_raw();
  if (!logger->should_log(level))
    return;
  static constexpr std::string_view letters = "TDIWECO";
  auto line = printable(fmt::format("{} {} {} {}", to_text(now(self)),
                                    letters[static_cast<std::size_t>(level)], who,
                                    fmt::format(format, std::forward<Args>(args)...)),
                        log_octets_max);
  self->where()->say([logger, level, text = std::move(line)] { logger->log(level, "{}", text); });
}

/// The actor itself.
template <class Self, class... Args>
void log(Self* self, spdlog::level::level_enum level, spdlog::format_string_t<Args...> format,
         Args&&... args) {
  log_as(self, self->path(), level, format, std::forward<Args>(args)...);
}

} // namespace rubicon
