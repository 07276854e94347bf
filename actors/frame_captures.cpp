#include "actors/frame_captures.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <variant>

#include <spdlog/spdlog.h>

#include "core/printable.hpp"

namespace rubicon {

frame_captures::frame_captures(const std::string& folder,
                               const config::ecology_description& ecology, bool with_lost)
    : with_lost_(with_lost) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw std::runtime_error(folder + ": " + failure.message());
  for (const auto& island : ecology.islands) {
    auto made = io::pcap_file::open(folder + "/island-" + to_string(island.id) + ".pcap");
    if (const auto* reason = std::get_if<std::string>(&made))
      throw std::runtime_error(*reason);
    captures_.emplace(static_cast<std::uint16_t>(island.id.value),
                      capture{std::move(std::get<io::pcap_file>(made)), {}, false});
  }
}

void frame_captures::write(const radio::overheard& x) {
  if (!x.received && !with_lost_)
    return;
  auto& to = captures_.at(x.pan);
  to.waiting.emplace(x.begin, x.psdu);
  to.write_until(x.begin + radio::air_time(x.psdu.size()) - radio::air_time(radio::psdu_max));
  tell_failure(to);
}

void frame_captures::tell_failure(capture& x) {
  if (!x.file.error().empty() && !std::exchange(x.is_told, true))
    spdlog::error("a capture is not complete: {}", printable(x.file.error()));
}

std::string frame_captures::finish() {
  std::string failed;
  for (auto& [pan, x] : captures_) {
    x.write_until(instant::max());
    x.file.flush();
    tell_failure(x);
    if (!x.file.error().empty())
      failed += (failed.empty() ? "captures are not complete: " : ", ") + x.file.error();
  }
  return failed;
}

void frame_captures::capture::write_until(instant begin) {
  const auto end = waiting.upper_bound(begin);
  for (auto next = waiting.begin(); next != end; ++next)
    file.write(next->first, next->second.view());
  waiting.erase(waiting.begin(), end);
}

} // namespace rubicon
