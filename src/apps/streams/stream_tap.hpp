// Reads streams of sensor records for somebody beside it, who takes the values.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "apps/streams/stream_application.hpp"

namespace rubicon::apps {

class stream_tap final : public stream_application {
public:
  struct value {
    std::uint16_t stream = 0;
    std::int16_t count = 0;
    std::uint32_t time_ms = 0; ///< as in the record
  };

  using stream_application::read_stream;

  /// @param streams at least one, all different
  explicit stream_tap(const std::vector<read_stream>& streams) : stream_application(streams) {}

  /// Those that have come since the last call, in their order.
  [[nodiscard]] std::vector<value> take_values() { return std::exchange(values_, {}); }

  [[nodiscard]] std::vector<figure> figures() const override {
    return {{"records", static_cast<double>(records_)},
            {"openings", static_cast<double>(openings())},
            {"opens failed", static_cast<double>(opens_failed())}};
  }

private:
  void on_record(std::size_t input, const stream::sensor_record& x) override {
    ++records_;
    values_.push_back({name_of(input), x.value, x.time_ms});
  }

  std::vector<value> values_;
  std::uint64_t records_ = 0;
};

} // namespace rubicon::apps
