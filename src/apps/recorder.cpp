#include "apps/recorder.hpp"

#include <utility>

namespace rubicon::apps {

namespace {

std::string seconds_text(std::uint32_t ms) {
  const auto rest = std::to_string(ms % 1000);
  return std::to_string(ms / 1000) + '.' + std::string(3 - rest.size(), '0') + rest;
}

} // namespace

void recorder::on_record(std::size_t input, const stream::sensor_record& x) {
  if (waiting_ == lines_max) {
    ++dropped_;
    return;
  }
  ++waiting_;
  ++recorded_;
  lines_ += seconds_text(x.time_ms) + ',' + std::to_string(x.source.island.value) + ',' +
            std::to_string(x.source.mote.value) + ',' + std::to_string(name_of(input)) + ',' +
            std::to_string(x.value) + '\n';
}

std::string recorder::take_lines() {
  waiting_ = 0;
  return std::exchange(lines_, {});
}

std::vector<figure> recorder::figures() const {
  return {{"records", static_cast<double>(recorded_)},
          {"records dropped", static_cast<double>(dropped_)},
          {"openings", static_cast<double>(openings())}};
}

} // namespace rubicon::apps
