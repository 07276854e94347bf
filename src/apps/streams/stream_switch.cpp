#include "apps/streams/stream_switch.hpp"

#include <array>

namespace rubicon::apps {

namespace {

constexpr duration command_pause = 5s; ///< before a command that has failed is given again

} // namespace

void stream_switch::joined(communication::island_octet island, std::uint16_t mote,
                           communication::status success) {
  number_.reset();
  retry_.reset();
  stream_application::joined(island, mote, success);
  if (success == communication::SUCCESS && state_)
    command();
}

std::optional<bool> stream_switch::wanted(double value) const {
  const bool on_when_low = config_.on_at < config_.off_at;
  if (on_when_low ? value <= config_.on_at : value >= config_.on_at)
    return true;
  if (on_when_low ? value >= config_.off_at : value <= config_.off_at)
    return false;
  return std::nullopt;
}

void stream_switch::on_record(std::size_t, const stream::sensor_record& x) {
  const auto now = wanted(x.value);
  if (!now || now == state_)
    return;
  ++changes_;
  state_ = now;
  notify("switches " + std::string(*now ? "on" : "off") + " at " + std::to_string(x.value));
  if (!number_) // else when the one in flight has ended
    command();
}

void stream_switch::command() {
  retry_.reset();
  commanded_ = *state_;
  const std::array<std::uint8_t, 1> octets{commanded_ ? std::uint8_t{1} : std::uint8_t{0}};
  number_ = layer().send_numbered(config_.to, octets, true, config_.channel);
  if (number_)
    return;
  ++failed_;
  retry_ = layer().now() + command_pause;
}

void stream_switch::ackOf(std::uint32_t number, communication::status success) {
  if (number != number_)
    return;
  number_.reset();
  ++(success == communication::SUCCESS ? acknowledged_ : failed_);
  if (commanded_ != *state_)
    command();
  else if (success == communication::FAIL)
    retry_ = layer().now() + command_pause;
}

void stream_switch::on_time(instant now) {
  stream_application::on_time(now);
  if (retry_ && *retry_ <= now && layer().address())
    command();
  else if (retry_ && *retry_ <= now)
    retry_.reset(); // joined() gives the command
}

std::optional<instant> stream_switch::deadline() const {
  return earliest(stream_application::deadline(), retry_);
}

std::vector<figure> stream_switch::figures() const {
  return {{"changes", static_cast<double>(changes_)},
          {"commands acknowledged", static_cast<double>(acknowledged_)},
          {"commands failed", static_cast<double>(failed_)}};
}

} // namespace rubicon::apps
