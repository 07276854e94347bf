#include "control/refusal_log.hpp"

#include <utility>

namespace rubicon::control {

std::optional<std::string> refusal_log::note(const std::string& who, const std::string& why,
                                             instant now) {
  if (lines_ == 0 || now - begun_ >= period) {
    begun_ = now;
    lines_ = 0;
  }
  std::erase_if(reported_, [now](const auto& x) { return now - x.second >= period; });
  auto line = who + " was rejected: it " + why;
  if (reported_.contains(line) || reported_.size() >= known_max || lines_ >= lines_max) {
    ++left_out_;
    return std::nullopt;
  }
  ++lines_;
  reported_.emplace(line, now);
  return line;
}

std::optional<instant> refusal_log::deadline() const {
  return left_out_ > 0 ? std::optional(begun_ + period) : std::nullopt;
}

std::optional<std::string> refusal_log::on_time(instant now) {
  const auto due = deadline();
  if (!due || now < *due)
    return std::nullopt;
  const auto count = std::exchange(left_out_, 0);
  begun_ = now;
  lines_ = 0;
  return std::to_string(count) + (count == 1 ? " more was rejected" : " more were rejected") +
         " in a minute";
}

} // namespace rubicon::control
