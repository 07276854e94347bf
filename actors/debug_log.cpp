#include "actors/debug_log.hpp"

#include <filesystem>
#include <stdexcept>
#include <vector>

#include <caf/binary_serializer.hpp>
#include <spdlog/sinks/rotating_file_sink.h>

#include "core/time.hpp"

namespace rubicon {

namespace {

std::string_view module_of(std::string_view path) {
  return path.substr(0, path.find('/'));
}

/// Octets of the message as it would be serialized: payload and fields.
std::size_t length_of(const caf::type_erased_tuple& content) {
  std::vector<char> octets;
  caf::binary_serializer sink(nullptr, octets);
  for (std::size_t i = 0; i < content.size(); ++i) {
    if (content.save(i, sink))
      return 0; // a system message that names actors has no length of its own
  }
  return octets.size();
}

} // namespace

debug_log::debug_log(std::string folder, std::size_t file_octets_max)
    : folder_(std::move(folder)), file_octets_max_(file_octets_max) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error)
    throw std::runtime_error("cannot create debug folder " + folder_ + ": " + error.message());
}

void debug_log::write(const scheduler::delivery& x) {
  const auto time = to_text(x.time);
  const auto length = length_of(x.content);
  const auto text = x.content.stringify();
  of(x.path).info("{} {} received from={} length={} {}", time, x.path,
                  x.sender.empty() ? "-" : x.sender, length, text);
  if (!x.sender.empty() && x.sender != x.path)
    of(x.sender).info("{} {} sent to={} length={} {}", time, x.sender, x.path, length, text);
}

spdlog::logger& debug_log::of(std::string_view path) {
  const auto module = module_of(path);
  const auto found = loggers_.find(module);
  if (found != loggers_.end())
    return *found->second;
  const auto name = std::string(module);
  try {
    auto sink = std::make_shared<spdlog::sinks::rotating_file_sink_st>(
        folder_ + '/' + name + ".log", file_octets_max_, files_max - 1);
    auto logger = std::make_shared<spdlog::logger>(name, std::move(sink));
    logger->set_pattern("%v");
    return *loggers_.emplace(name, std::move(logger)).first->second;
  } catch (const spdlog::spdlog_ex& error) {
    throw std::runtime_error(error.what());
  }
}

} // namespace rubicon
