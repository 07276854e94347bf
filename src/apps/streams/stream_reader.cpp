#include "apps/streams/stream_reader.hpp"

namespace rubicon::apps {

namespace {

constexpr duration leap_min = 24h; ///< more than that between two records: the time was set

} // namespace

void stream_reader::on_opened(std::size_t) {
  if (openings() == 1)
    notify("stream " + std::to_string(config_.stream) + " is open");
}

void stream_reader::on_record(std::size_t, const stream::sensor_record& x) {
  const auto period = static_cast<std::uint32_t>(config_.every / 1ms);
  const auto since = static_cast<std::int32_t>(x.time_ms - last_ms_.value_or(x.time_ms));
  if (since > 0 && since < leap_min / 1ms && period > 0) { // rounded: clocks are corrected
    const auto steps = (static_cast<std::uint32_t>(since) + period / 2) / period;
    missing_ += steps > 0 ? steps - 1 : 0;
  }
  last_ms_ = x.time_ms;
  ++records_;
}

std::vector<figure> stream_reader::figures() const {
  const auto all = static_cast<double>(records_ + missing_);
  return {{"records", static_cast<double>(records_)},
          {"records missing", static_cast<double>(missing_)},
          {"delivery %", all > 0 ? 100 * static_cast<double>(records_) / all : 0, false},
          {"openings", static_cast<double>(openings())},
          {"opens failed", static_cast<double>(opens_failed())}};
}

} // namespace rubicon::apps
