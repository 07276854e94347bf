// The read end of a stream of sensor records: counts what comes, and what does not.
#pragma once

#include "apps/streams/stream_application.hpp"

namespace rubicon::apps {

class stream_reader final : public stream_application {
public:
  explicit stream_reader(stream_reader_config config)
      : stream_application({config.stream}, config.every), config_(config) {}

  [[nodiscard]] std::vector<figure> figures() const override;

private:
  void on_opened(std::size_t input) override;
  void on_record(std::size_t input, const stream::sensor_record& x) override;

  stream_reader_config config_;
  std::uint64_t records_ = 0;
  std::uint64_t missing_ = 0;
  std::optional<std::uint32_t> last_ms_; ///< time in the last record
};

} // namespace rubicon::apps
