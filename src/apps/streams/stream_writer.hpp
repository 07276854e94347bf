// Streams a transducer's records to another node: a sensor stream read into a remote stream.
#pragma once

#include "apps/application.hpp"

namespace rubicon::apps {

/// off --joined--> opening --openRemoteDone--> streaming --write fails--> a pause, then opening
/// An open that fails, of the remote stream or of the sensor's, is counted, and tried again.
class stream_writer final : public application {
public:
  /// @param rng of its pauses: writers that have failed together do not go on together
  explicit stream_writer(stream_writer_config config, random_stream rng = random_stream(1))
      : config_(config), rng_(rng) {}

  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return retry_; }
  [[nodiscard]] std::vector<figure> figures() const override;
  [[nodiscard]] std::vector<stream_end> stream_ends(instant now) const override;

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void openRemoteDone(int stream, std::uint16_t name, communication::status success) override;
  void readDone(int stream, byte_view record, communication::status success) override;

private:
  void on_start(instant) override {}
  void open();
  void give_up();
  void stop();

  stream_writer_config config_;
  random_stream rng_;
  bool is_member_ = false;
  int sensor_ = -1;
  int remote_ = -1;
  std::optional<instant> retry_;
  std::uint64_t written_ = 0;
  std::uint64_t unwritten_ = 0;
  std::uint64_t openings_ = 0;
  std::uint64_t opens_failed_ = 0;
  instant changed_;                      ///< when the remote stream was opened or closed
  std::optional<std::uint32_t> last_ms_; ///< time in the newest record
};

} // namespace rubicon::apps
