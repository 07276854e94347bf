// Writes down the records of streams, as lines of a CSV file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "apps/streams/stream_application.hpp"

namespace rubicon::apps {

/// Whoever hosts it takes the lines and puts them into the file.
class recorder final : public stream_application {
public:
  static constexpr std::string_view heading = "time_s,island,mote,stream,value\n";
  static constexpr std::size_t lines_max = 1024; ///< that wait to be taken

  explicit recorder(recorder_config config)
      : stream_application(config.streams, config.every), config_(std::move(config)) {}

  [[nodiscard]] std::vector<figure> figures() const override;
  [[nodiscard]] std::string_view file() const override { return config_.file; }
  [[nodiscard]] std::string_view file_heading() const override { return heading; }

  /// Lines since the last call: seconds of network time since 1970, the source, the stream, its
  /// value. A record has the low 32 bits of the time; the PC's own has the rest.
  [[nodiscard]] std::string take_lines() override;

private:
  void on_record(std::size_t input, const stream::sensor_record& x) override;
  [[nodiscard]] std::int64_t whole_time_ms(std::uint32_t low);

  recorder_config config_;
  std::string lines_;
  std::optional<std::int64_t> last_ms_; ///< since 1970, of the newest line
  std::size_t waiting_ = 0;
  std::uint64_t recorded_ = 0;
  std::uint64_t dropped_ = 0;
};

} // namespace rubicon::apps
