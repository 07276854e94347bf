#include "apps/actuator.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::apps {

namespace {

constexpr duration period_min = 100ms; ///< as of samplers, where the file says nothing

} // namespace

void actuator::on_start(instant) {
  provide(static_cast<std::uint8_t>(config_.channel));
}

void actuator::joined(communication::island_octet, std::uint16_t, communication::status success) {
  in_island_ = success == communication::SUCCESS;
  number_.reset();
  again_.reset();
  failed_ = false;
  if (in_island_)
    send_news();
  begin_period();
}

void actuator::ackOf(std::uint32_t number, communication::status success) {
  if (number != number_)
    return; // a newer state is on its way
  number_.reset();
  if (success == communication::FAIL)
    again_later();
}

void actuator::outputsWanted(std::span<const communication::output_wanted> all) {
  const auto wanted = communication::wanted_on(all, config_.channel);
  const bool is_asked = wanted && wanted->period.count() > 0;
  const auto period = is_asked ? std::max<duration>(wanted->period, period_min) : duration{};
  if (std::exchange(period_, period) != period)
    begin_period();
}

void actuator::begin_period() {
  begins_ = in_island_ && period_ > 0s;
  due_.reset();
}

void actuator::on_time(instant now) {
  if (std::exchange(begins_, false))
    due_ = now + period_;
  if (std::exchange(failed_, false)) {
    again_ = now + pause_; // not by the clock of its mote, which layer() has
    pause_ = std::min(2 * pause_, again_max);
  }
  if (again_ && *again_ <= now) {
    again_.reset();
    if (layer().address()) // else it is sent when the mote has joined
      send_state();
  }
  if (!due_ || *due_ > now)
    return;
  while (*due_ <= now)
    *due_ += period_;
  layer().send_numbered(own_gateway, bytes{state_}, /*reliable=*/false,
                        static_cast<std::uint8_t>(config_.channel)); // the next one follows
}

void actuator::receiveFrom(mote_address, byte_view octets, std::uint8_t) {
  if (!octets.empty())
    layer().set_actuator(config_.actuator, octets[0]);
}

void actuator::actuatorChanged(std::string_view, std::uint8_t state, bool) {
  state_ = state;
  send_news();
}

void actuator::send_news() {
  pause_ = again_first;
  send_state();
}

void actuator::send_state() {
  again_.reset();
  failed_ = false;
  number_ = layer().send_numbered(own_gateway, bytes{state_}, /*reliable=*/true,
                                  static_cast<std::uint8_t>(config_.channel));
  if (!number_)
    again_later();
}

/// Without an address it is sent when the mote has joined.
void actuator::again_later() {
  failed_ = layer().address().has_value();
}

} // namespace rubicon::apps
