// Lets its gateway command an actuator of its mote.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "apps/application.hpp"

namespace rubicon::apps {

/// Obeys the first octet of what it receives, and sends the actuator's state after every change,
/// when its mote has joined, and at the period that was requested (IF-03). The newest
/// state is sent again, ever more rarely, until its gateway has it: else who reads it would take
/// the one before for the newest, until the next change.
class actuator final : public application {
public:
  /// @param state of the actuator when its mote starts
  actuator(actuator_config config, std::uint8_t state)
      : config_(std::move(config)), state_(state) {}

  static constexpr duration again_first = 5s; ///< after a state that did not arrive,
  static constexpr duration again_max = 1min; ///< each time twice as long

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void ackOf(std::uint32_t number, communication::status success) override;
  void receiveFrom(mote_address source, byte_view octets, std::uint8_t am_type) override;
  void outputsWanted(std::span<const communication::output_wanted> all) override;
  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override {
    return begins_ || failed_ ? std::optional(instant{}) // as soon as it may be
                              : earliest(due_, again_);
  }
  void actuatorChanged(std::string_view name, std::uint8_t state, bool obeyed) override;

private:
  void on_start(instant now) override;
  void begin_period();
  void send_news();
  void send_state();
  void again_later();

  actuator_config config_;
  std::uint8_t state_ = 0;
  bool in_island_ = false;
  bool begins_ = false;                 ///< its periods do, at the next on_time()
  bool failed_ = false;                 ///< the newest message has: a pause begins then
  duration period_{};                   ///< 0: none was requested
  std::optional<instant> due_;          ///< when the state is sent as requested
  std::optional<std::uint32_t> number_; ///< of the message with the newest state, in flight
  duration pause_ = again_first;
  std::optional<instant> again_; ///< when that state is sent again
};

} // namespace rubicon::apps
