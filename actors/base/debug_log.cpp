#include "actors/base/debug_log.hpp"

#include <any>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <caf/binary_serializer.hpp>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "core/text/printable.hpp"
#include "core/time.hpp"
#include "explain/record.hpp"

namespace rubicon {

namespace {

std::string_view module_of(std::string_view path) {
  return path.substr(0, path.find('/'));
}

} // namespace

debug_log::debug_log(std::string folder, std::size_t file_octets_max, config::debug_selection of)
    : folder_(std::move(folder)), file_octets_max_(file_octets_max), of_(std::move(of)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error)
    throw std::runtime_error("cannot create debug folder " + folder_ + ": " + error.message());
  if (::access(folder_.c_str(), W_OK | X_OK) != 0)
    throw std::runtime_error("cannot write into debug folder " + folder_ + ": " +
                             std::generic_category().message(errno));
}

void debug_log::write(const scheduler::delivery& x) {
  const bool is_sent = !x.sender.empty() && x.sender != x.path;
  if (!of_.has(x.path) && !(is_sent && of_.has(x.sender)))
    return; // most are not, and to write them down takes time
  const auto time = to_text(x.time);
  const auto length = x.message.type().measure(x.message);
  const auto text = x.message.text();
  write_line(x.path, fmt::format("{} {} received from={} length={} {}", time, x.path,
                                 x.sender.empty() ? "-" : x.sender, length, text));
  if (is_sent)
    write_line(x.sender,
               fmt::format("{} {} sent to={} length={} {}", time, x.sender, x.path, length, text));
}

void debug_log::write(const scheduler::remark& x) {
  if (x.what == selected) {
    of_ = std::any_cast<const config::debug_selection&>(x.content);
    return;
  }
  const auto* told = std::any_cast<explain::record>(&x.content);
  if (told == nullptr || told->from == told->to)
    return;
  const auto time = to_text(x.time);
  const auto text =
      fmt::format("{} number={} with={} am_type={} {} {}", to_string(told->what), told->id,
                  to_string(told->mote), told->channel, told->yes ? "yes" : "no", told->text);
  const auto length = told->octets.size();
  write_line(told->from, fmt::format("{} {} sent to={} length={} {}", time, told->from, told->to,
                                     length, text));
  write_line(told->to, fmt::format("{} {} received from={} length={} {}", time, told->to,
                                   told->from, length, text));
}

std::string debug_log::finish() {
  for (const auto& [module, logger] : loggers_)
    logger->flush();
  return error_;
}

void debug_log::write_line(std::string_view path, std::string_view line) {
  if (!error_.empty() || !of_.has(path))
    return;
  if (auto* const logger = logger_of(path))
    logger->info("{}", printable(line)); // what is remote must not look like another line
}

void debug_log::fail(const std::string& why) {
  if (!error_.empty())
    return;
  error_ = "debug logs in " + folder_ + " are not complete: " + why;
  spdlog::error("{}", printable(error_));
}

spdlog::logger* debug_log::logger_of(std::string_view path) {
  const auto module = module_of(path);
  const auto found = loggers_.find(module);
  if (found != loggers_.end())
    return found->second.get();
  const auto name = std::string(module);
  try {
    auto sink = std::make_shared<spdlog::sinks::rotating_file_sink_st>(
        folder_ + '/' + name + ".log", file_octets_max_, files_max - 1);
    auto logger = std::make_shared<spdlog::logger>(name, std::move(sink));
    logger->set_pattern("%v");
    logger->set_error_handler([this](const std::string& why) { fail(why); });
    return loggers_.emplace(name, std::move(logger)).first->second.get();
  } catch (const spdlog::spdlog_ex& error) {
    fail(error.what()); // in the middle of a handler of an actor that has done no wrong
    return nullptr;
  }
}

} // namespace rubicon
