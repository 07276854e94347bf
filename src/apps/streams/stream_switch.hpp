// Switches an actuator of a mote as the values of a stream say.
#pragma once

#include "apps/streams/stream_application.hpp"

namespace rubicon::apps {

/// Sends one octet, 1 or 0, reliably to the mote whose app `actuator` obeys it; again after a pause
/// until it is acknowledged. Between its two thresholds it leaves the actuator as it is.
class stream_switch final : public stream_application {
public:
  explicit stream_switch(stream_switch_config config)
      : stream_application({config.stream}, config.every), config_(config) {}

  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override;
  [[nodiscard]] std::vector<figure> figures() const override;

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void ackOf(std::uint32_t number, communication::status success) override;

private:
  void on_record(std::size_t input, const stream::sensor_record& x) override;
  [[nodiscard]] std::optional<bool> wanted(double value) const; ///< nothing: as it is
  void command();

  stream_switch_config config_;
  std::optional<bool> state_;           ///< to be; nothing: no value has said
  std::optional<std::uint32_t> number_; ///< of the command in flight
  bool commanded_ = false;              ///< its state
  std::optional<instant> retry_;
  std::uint64_t changes_ = 0;
  std::uint64_t acknowledged_ = 0;
  std::uint64_t failed_ = 0;
};

} // namespace rubicon::apps
