#include "apps/stream_reader.hpp"

namespace rubicon::apps {

void stream_reader::on_opened(std::size_t) {
  if (openings() == 1)
    tell("stream " + std::to_string(config_.stream) + " is open");
  last_ms_.reset();
}

void stream_reader::on_record(std::size_t, const stream::sensor_record& x) {
  const auto period = static_cast<std::uint32_t>(config_.every / 1ms);
  if (last_ms_ && period > 0) { // rounded: clocks are corrected between records
    const auto steps = (x.time_ms - *last_ms_ + period / 2) / period;
    missing_ += steps > 0 ? steps - 1 : 0;
  }
  last_ms_ = x.time_ms;
  ++records_;
}

std::vector<figure> stream_reader::figures() const {
  const auto all = static_cast<double>(records_ + missing_);
  return {{"records", static_cast<double>(records_)},
          {"records missing", static_cast<double>(missing_)},
          {"delivery %", all > 0 ? 100 * static_cast<double>(records_) / all : 0},
          {"openings", static_cast<double>(openings())}};
}

} // namespace rubicon::apps
