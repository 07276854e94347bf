// Log lines of actors: ecology time, level, who, then key=value pairs, so that equal runs write
// equal logs (style: one line an event).
#pragma once

#include <string_view>
#include <utility>

#include <spdlog/common.h>

#include "actors/base/timer.hpp"
#include "core/time.hpp"
#include "scheduler/process.hpp"

namespace rubicon {

/// Whether lines of this level are written.
[[nodiscard]] bool is_logged(spdlog::level::level_enum level);

/// Writes `12.004160 W mote/kitchen/climate-7 event=refused ...` as one line that is printable(),
/// whatever it quotes. Compiled once: what formats values is large.
void write_line(scheduler::process& where, instant now, std::string_view who,
                spdlog::level::level_enum level, fmt::string_view format, fmt::format_args args);

/// Writes such a line if the level is on.
template <class Self, class... Args>
void log_as(Self* self, std::string_view who, spdlog::level::level_enum level,
            spdlog::format_string_t<Args...> format, Args&&... args) {
  if (is_logged(level))
    write_line(*self->where(), now(self), who, level, format, fmt::make_format_args(args...));
}

/// The actor itself.
template <class Self, class... Args>
void log(Self* self, spdlog::level::level_enum level, spdlog::format_string_t<Args...> format,
         Args&&... args) {
  log_as(self, self->path(), level, format, std::forward<Args>(args)...);
}

} // namespace rubicon
