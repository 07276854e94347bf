#include "cli/print/logging.hpp"

#include <memory>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "cli/print/progress_bar.hpp"

namespace rubicon::cli {

void set_up_logging(const std::string& level, const console& errors) {
  const auto mode = errors.colour ? spdlog::color_mode::always : spdlog::color_mode::never;
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(mode);
  auto logger = std::make_shared<spdlog::logger>("rubicon", std::move(sink));
  const std::string before = errors.is_terminal ? std::string(erase_line) : "";
  logger->set_pattern(before + "%^%v%$");
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(std::move(logger));
}

} // namespace rubicon::cli
