#include "cli/print/logging.hpp"

#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "cli/print/progress_bar.hpp"
#include "cli/print/repeated_lines.hpp"

namespace rubicon::cli {

namespace {

/// Passes lines on, and of errors that repeat the first ones.
class shortened_sink final : public spdlog::sinks::base_sink<std::mutex> {
public:
  explicit shortened_sink(spdlog::sink_ptr to) : to_(std::move(to)) {}

protected:
  void sink_it_(const spdlog::details::log_msg& x) override {
    const std::string_view text(x.payload.data(), x.payload.size());
    const auto verdict =
        x.level < spdlog::level::err ? repeated_lines::verdict::shown : seen_.next(text);
    if (verdict == repeated_lines::verdict::left_out)
      return;
    if (verdict == repeated_lines::verdict::shown) {
      to_->log(x);
      return;
    }
    const auto whole = std::string(text) + "; equal lines that follow are left out";
    auto last = x;
    last.payload = whole;
    to_->log(last);
  }
  void flush_() override { to_->flush(); }
  void set_pattern_(const std::string& pattern) override { to_->set_pattern(pattern); }
  void set_formatter_(std::unique_ptr<spdlog::formatter> x) override {
    to_->set_formatter(std::move(x));
  }

private:
  spdlog::sink_ptr to_;
  repeated_lines seen_;
};

} // namespace

void set_up_logging(const std::string& level, const console& errors) {
  const auto mode = errors.colour ? spdlog::color_mode::always : spdlog::color_mode::never;
  auto sink =
      std::make_shared<shortened_sink>(std::make_shared<spdlog::sinks::stderr_color_sink_mt>(mode));
  auto logger = std::make_shared<spdlog::logger>("rubicon", std::move(sink));
  const std::string before = errors.is_terminal ? std::string(erase_line) : "";
  logger->set_pattern(before + "%^%v%$");
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(std::move(logger));
}

} // namespace rubicon::cli
