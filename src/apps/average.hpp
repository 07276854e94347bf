// An operator over streams: the average of several inputs is a stream again (STR-22).
#pragma once

#include "apps/streams/stream_application.hpp"

namespace rubicon::apps {

/// Writes, at its rate, the mean of the newest values of the streams that are open and have given
/// one. Its records have this node as source and the time of the newest of those values.
class average final : public stream_application {
public:
  explicit average(average_config config);

  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override;
  [[nodiscard]] std::vector<figure> figures() const override;
  [[nodiscard]] std::vector<stream_end> stream_ends(instant now) const override;

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void openRemoteDone(int stream, std::uint16_t name, communication::status success) override;

private:
  void on_record(std::size_t input, const stream::sensor_record& x) override;
  void on_lost(std::size_t input) override { newest_[input].reset(); }
  struct write_end {
    stream_output what;
    int stream = -1;
    std::optional<instant> retry = {};
    std::uint64_t written = 0;
    std::uint64_t unwritten = 0;
    std::uint64_t openings = 0;
    std::uint64_t opens_failed = 0;
    instant changed = {};                      ///< when it was opened or closed
    std::optional<std::uint32_t> last_ms = {}; ///< time in the newest record
  };

  void open(write_end& x);
  void close(write_end& x);
  void write();

  average_config config_;
  std::vector<std::optional<stream::sensor_record>> newest_; ///< per input
  std::vector<write_end> outputs_;
  std::optional<instant> due_; ///< of the next mean; nothing: no output has been open
  std::uint64_t read_ = 0;
  std::uint64_t written_ = 0;
  std::uint64_t without_value_ = 0;
};

} // namespace rubicon::apps
