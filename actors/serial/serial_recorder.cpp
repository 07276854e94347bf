#include "actors/serial/serial_recorder.hpp"

#include <cerrno>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "actors/messages/serial.hpp"

namespace rubicon {

namespace {

/// The island in `gateway/kitchen` and `serial_line/kitchen`; of further gateways and lines only
/// what goes over the first is recorded.
std::string island_in(std::string_view path, std::string_view kind) {
  if (!path.starts_with(kind))
    return {};
  const auto name = path.substr(kind.size());
  return name.find('/') == std::string_view::npos ? std::string(name) : std::string();
}

/// `kitchen/real`, of its gateway or in `real_line/kitchen/real`.
std::string real_line_of(const std::string& island) {
  return island + std::string(serial::real_line_suffix);
}
std::string real_line_in(std::string_view path) {
  constexpr std::string_view kind = "real_line/";
  return path.starts_with(kind) ? std::string(path.substr(kind.size())) : std::string();
}

} // namespace

serial_recorder::serial_recorder(std::string path)
    : path_(std::move(path)), file_(std::fopen(path_.c_str(), "w"), std::fclose) {
  if (file_ == nullptr)
    throw std::runtime_error(path_ + ": " + std::generic_category().message(errno));
  failed_ = std::fprintf(file_.get(), "%s\n", std::string(serial::recording_title).c_str()) < 0;
}

void serial_recorder::write(const scheduler::delivery& x) {
  if (const auto* heard = x.as<serial_octets>()) {
    auto island = island_in(x.path, "gateway/");
    if (island.empty())
      island = island_in(x.path, "pty_end/");
    if (!island.empty())
      take(x.time, island, serial::direction::to_pc, heard->octets.view());
  } else if (const auto* written = x.as<serial_write>()) {
    auto line = island_in(x.path, "serial_line/");
    if (line.empty())
      line = real_line_in(x.path);
    if (written->towards == serial::direction::to_mote && !line.empty())
      take(x.time, line, written->towards, written->octets.view());
  } else if (const auto* real = x.as<real_octets>()) {
    if (const auto island = island_in(x.path, "gateway/"); !island.empty())
      take(x.time, real_line_of(island), serial::direction::to_pc, real->octets.view());
  }
}

std::string serial_recorder::finish() {
  const bool whole = !failed_ && std::fclose(file_.release()) == 0;
  return whole ? std::string() : path_ + " is not complete: it could not be written";
}

void serial_recorder::take(instant at, const std::string& island, serial::direction towards,
                           byte_view octets) {
  auto& decoder = decoders_[{island, towards}];
  for (const auto octet : octets) {
    const auto x = decoder.on_octet(octet);
    if (!x)
      continue;
    const auto line = serial::to_text(serial::recorded_frame{at, island, towards, *x}) + '\n';
    failed_ |= std::fwrite(line.data(), 1, line.size(), file_.get()) != line.size() ||
               std::fflush(file_.get()) != 0; // whoever watches a run in wall time sees it
  }
}

} // namespace rubicon
