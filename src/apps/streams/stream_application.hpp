// Programs that read streams of sensor records: they open the read ends when their node has joined,
// and anew when a writer is gone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "apps/application.hpp"
#include "stream/sensor_record.hpp"

namespace rubicon::apps {

/// What such programs have in common. An overrider of a function that is not pure calls it.
class stream_application : public application {
public:
  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return retry_; }

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void openRemoteDone(int stream, std::uint16_t name, communication::status success) override;
  void readDone(int stream, byte_view record, communication::status success) final;
  [[nodiscard]] std::vector<stream_end> stream_ends(instant now) const override;

protected:
  /// A stream that is read.
  struct read_stream {
    std::uint16_t name = 0; ///< symbolic
    duration every{};       ///< as its writer's
  };

  /// @param streams all different
  explicit stream_application(const std::vector<read_stream>& streams);
  stream_application(const std::vector<std::uint16_t>& streams, duration every);

  virtual void on_opened(std::size_t /*input*/) {} ///< a place in the constructor's list
  virtual void on_record(std::size_t input, const stream::sensor_record& x) = 0;
  virtual void on_lost(std::size_t /*input*/) {} ///< its writer is gone

  [[nodiscard]] std::uint16_t name_of(std::size_t input) const { return inputs_[input].name; }
  [[nodiscard]] std::size_t inputs() const { return inputs_.size(); }
  [[nodiscard]] std::uint64_t openings() const { return openings_; } ///< of all inputs
  [[nodiscard]] std::uint64_t opens_failed() const { return opens_failed_; }

private:
  struct read_end {
    std::uint16_t name = 0;
    duration every{};
    int stream = -1;
    bool is_wanted = false; ///< to be opened at retry_
    std::uint64_t records = 0;
    std::uint64_t openings = 0;
    std::optional<instant> first{}; ///< when the first record came
    std::optional<std::uint32_t> last_ms = {};
    instant last{}; ///< when the newest record came
    duration pause{};
    instant changed{}; ///< when it was opened or closed
  };

  void on_start(instant) final {}
  void open(read_end& x);
  void retry(read_end& x);

  std::vector<read_end> inputs_;
  std::optional<instant> retry_;
  std::uint64_t openings_ = 0;
  std::uint64_t opens_failed_ = 0;
};

} // namespace rubicon::apps
