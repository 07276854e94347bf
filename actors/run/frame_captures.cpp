#include "actors/run/frame_captures.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <variant>

#include <spdlog/spdlog.h>

#include "core/text/printable.hpp"
#include "radio/frame.hpp"

namespace rubicon {

frame_captures::frame_captures(const std::string& folder,
                               const config::ecology_description& ecology, bool with_lost)
    : with_lost_(with_lost) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw std::runtime_error(folder + ": " + failure.message());
  for (const auto& island : ecology.islands)
    captures_.emplace(static_cast<std::uint16_t>(island.id.value), made(folder, island, with_lost));
}

frame_captures::capture frame_captures::made(const std::string& folder,
                                             const config::island_description& x, bool with_lost) {
  const auto path = folder + "/island-" + to_string(x.id) + ".pcap";
  const auto begun = [](auto opened) {
    if (const auto* reason = std::get_if<std::string>(&opened))
      throw std::runtime_error(*reason);
    return std::get<0>(std::move(opened));
  };
  if (!with_lost)
    return {begun(io::pcap_file::open(path)), {}, {}, false};
  capture out{begun(io::pcapng_file::open(path + "ng", printable(x.name))), {}, {}, false};
  out.names[x.sink.id] = "sink";
  for (const auto& mote : x.motes)
    out.names[mote.id] = mote.name;
  return out;
}

void frame_captures::write(const radio::overheard& x) {
  if (!x.received && !with_lost_)
    return;
  auto& to = captures_.at(x.pan);
  to.waiting.emplace(x.begin, capture::seen{x.psdu, x.received ? std::string() : to.comment_on(x)});
  to.write_until(x.begin + radio::air_time(x.psdu.size()) - radio::air_time(radio::psdu_max));
  report_failure(to);
}

void frame_captures::report_failure(capture& x) {
  if (!x.error().empty() && !std::exchange(x.is_reported, true))
    spdlog::error("a capture is not complete: {}", printable(x.error()));
}

std::string frame_captures::finish() {
  std::string failed;
  for (auto& [pan, x] : captures_) {
    x.write_until(instant::max());
    x.flush();
    report_failure(x);
    if (!x.error().empty())
      failed += (failed.empty() ? "captures are not complete: " : ", ") + x.error();
  }
  return failed;
}

void frame_captures::capture::write_until(instant begin) {
  const auto end = waiting.upper_bound(begin);
  for (auto next = waiting.begin(); next != end; ++next) {
    const auto& [at, frame] = *next;
    if (auto* const plain = std::get_if<io::pcap_file>(&file))
      plain->write(at, frame.psdu.view());
    else
      std::get<io::pcapng_file>(file).write(at, frame.psdu.view(), frame.comment);
  }
  waiting.erase(waiting.begin(), end);
}

void frame_captures::capture::flush() {
  std::visit([](auto& x) { x.flush(); }, file);
}

const std::string& frame_captures::capture::error() const {
  return std::visit([](const auto& x) -> const std::string& { return x.error(); }, file);
}

/// `lost: collision, from climate-7 (7) to sink (1)`
std::string frame_captures::capture::comment_on(const radio::overheard& x) const {
  const auto frame = radio::decode(x.psdu.view());
  if (!frame)
    return "lost";
  if (frame->type == radio::frame_type::ack)
    return "lost: an unexpected acknowledgement";
  const auto from = "from " + name_of(frame->source) + " to ";
  if (frame->destination == broadcast_mote)
    return "lost: no radio received it, " + from + "all";
  return "lost: " + to_string(x.outcome) + ", " + from + name_of(frame->destination);
}

std::string frame_captures::capture::name_of(mote_id x) const {
  const auto found = names.find(x);
  return found == names.end() ? to_string(x) : printable(found->second) + " (" + to_string(x) + ')';
}

} // namespace rubicon
