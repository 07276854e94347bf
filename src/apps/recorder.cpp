#include "apps/recorder.hpp"

#include <algorithm>
#include <utility>

#include "core/serial_number.hpp"

namespace rubicon::apps {

namespace {

/// @param ms 0 and more
std::string seconds_text(std::int64_t ms) {
  const auto rest = std::to_string(ms % 1000);
  return std::to_string(ms / 1000) + '.' + std::string(3 - rest.size(), '0') + rest;
}

} // namespace

/// Who has not the time goes by the record before it.
std::int64_t recorder::whole_time_ms(std::uint32_t low) {
  const auto known = layer().network_time();
  const auto around = known ? *known / 1ms : last_ms_.value_or(low);
  return std::max<std::int64_t>(unwrapped(low, around), 0);
}

void recorder::on_record(std::size_t input, const stream::sensor_record& x) {
  if (waiting_ == lines_max) {
    ++dropped_;
    return;
  }
  ++waiting_;
  ++recorded_;
  last_ms_ = whole_time_ms(x.time_ms);
  lines_ += seconds_text(*last_ms_) + ',' + std::to_string(x.source.island.value) + ',' +
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
