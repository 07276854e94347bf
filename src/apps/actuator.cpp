#include "apps/actuator.hpp"

namespace rubicon::apps {

void actuator::on_start(instant) {
  provide(static_cast<std::uint8_t>(config_.channel));
}

void actuator::joined(communication::island_octet, std::uint16_t, communication::status success) {
  if (success == communication::SUCCESS)
    tell_state();
}

void actuator::receiveFrom(mote_address, byte_view octets, std::uint8_t) {
  if (!octets.empty())
    layer().set_actuator(config_.actuator, octets[0]);
}

void actuator::actuatorChanged(std::string_view, std::uint8_t state, bool) {
  state_ = state;
  tell_state();
}

void actuator::tell_state() {
  layer().send_numbered(own_gateway, bytes{state_}, true,
                        static_cast<std::uint8_t>(config_.channel));
}

} // namespace rubicon::apps
