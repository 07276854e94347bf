#include "actors/base/log.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include "core/text/printable.hpp"

namespace rubicon {

namespace {

constexpr std::size_t log_octets_max = 8192; // of a line: a value may be very long

} // namespace

bool is_logged(spdlog::level::level_enum level) {
  return spdlog::default_logger_raw()->should_log(level);
}

void write_line(scheduler::process& where, instant now, std::string_view who,
                spdlog::level::level_enum level, fmt::string_view format, fmt::format_args args) {
  static constexpr std::string_view letters = "TDIWECO";
  auto line =
      printable(fmt::format("{} {} {} {}", to_text(now), letters[static_cast<std::size_t>(level)],
                            who, fmt::vformat(format, args)),
                log_octets_max);
  where.say([logger = spdlog::default_logger_raw(), level, text = std::move(line)] {
    logger->log(level, spdlog::string_view_t(text));
  });
}

} // namespace rubicon
