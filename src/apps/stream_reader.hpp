// The read end of a stream of sensor records: counts what comes, and what does not.
#pragma once

#include "apps/application.hpp"

namespace rubicon::apps {

class stream_reader final : public application {
public:
  explicit stream_reader(stream_reader_config config) : config_(config) {}

  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return retry_; }
  [[nodiscard]] std::vector<figure> figures() const override;

  void joined(mote::island_octet island, std::uint16_t mote, mote::status success) override;
  void openRemoteDone(int stream, std::uint16_t name, mote::status success) override;
  void readDone(int stream, byte_view record, mote::status success) override;

private:
  void on_start(instant) override {}
  void open();

  stream_reader_config config_;
  int stream_ = -1;
  std::optional<instant> retry_;
  std::uint64_t records_ = 0;
  std::uint64_t missing_ = 0;
  std::optional<std::uint32_t> last_ms_; ///< time in the last record
  std::uint64_t openings_ = 0;
};

} // namespace rubicon::apps
