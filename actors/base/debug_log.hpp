// Debug mode (D1.1 2.2 R1.DEBUGMODE, NFR-01, NFR-03): every module's messages, one line each.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>

#include <spdlog/logger.h>

#include "config/plan/debug_selection.hpp"
#include "scheduler/trace.hpp"

namespace rubicon {

/// Writes FOLDER/MODULE.log, a module being the first part of an actor's path (`mote`, `gateway`,
/// ...): a line for each message sent and one for each received, with ecology time, actor, peer,
/// type, length and ids. A full file is rotated: a module has at most `files_max` files of
/// `file_octets_max` (NFR-03), the newest without a number.
class debug_log {
public:
  static constexpr std::size_t files_max = 3;

  /// Creates the folder. @throws std::runtime_error if that fails, or files may not be made in it
  /// @param of whose messages are written at first; a remark of the ecology says who follows
  debug_log(std::string folder, std::size_t file_octets_max, config::debug_selection of = {});
  debug_log(const debug_log&) = delete;
  debug_log& operator=(const debug_log&) = delete;

  void write(const scheduler::delivery& x);
  void write(const scheduler::remark& x); ///< of what a program and its mote tell each other

  /// The kind of the remark by which the ecology tells a new debug_selection.
  static constexpr std::string_view selected = "debug_selected";

  /// @returns what could not be written, and why; empty if nothing is missing
  [[nodiscard]] std::string finish();

private:
  /// nullptr if its file cannot be opened
  [[nodiscard]] spdlog::logger* logger_of(std::string_view path);
  void write_line(std::string_view path, std::string_view line);
  void fail(const std::string& why);

  std::string folder_;
  std::size_t file_octets_max_;
  config::debug_selection of_;
  std::map<std::string, std::shared_ptr<spdlog::logger>, std::less<>> loggers_;
  std::string error_; ///< the first; nothing is written after it
};

} // namespace rubicon
