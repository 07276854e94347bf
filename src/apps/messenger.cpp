#include "apps/messenger.hpp"

#include <string>
#include <utility>

#include "apps/app_keys.hpp"

namespace rubicon::apps {

void messenger::joined(communication::island_octet, std::uint16_t, communication::status success) {
  begins_ = success == communication::SUCCESS && !(config_.count && sent_ >= *config_.count);
  next_.reset();
}

void messenger::change(const keys::key_changes& settings) {
  const auto every = config_.every;
  keys::apply(settings, config_);
  begins_ = begins_ || (next_ && config_.every != every);
}

std::optional<instant> messenger::deadline() const {
  return begins_ ? std::optional(instant{}) : next_;
}

void messenger::on_time(instant now) {
  if (std::exchange(begins_, false)) {
    next_ = now + config_.every;
  } else if (next_ && *next_ <= now) {
    *next_ += config_.every;
    send();
    if (config_.count && sent_ >= *config_.count)
      next_.reset();
  }
}

void messenger::send() {
  ++sent_;
  const auto number = layer().send_numbered(config_.to, to_bytes(std::string_view(config_.text)),
                                            config_.reliable, config_.am_type);
  if (!number)
    warn("event=undelivered number=" + std::to_string(sent_) + " refused=true");
  else if (config_.reliable)
    in_flight_[*number] = sent_;
}

void messenger::ackOf(std::uint32_t number, communication::status success) {
  const auto sent = in_flight_.extract(number);
  if (!sent.empty() && success == communication::FAIL)
    warn("event=undelivered number=" + std::to_string(sent.mapped()) + " refused=false");
}

} // namespace rubicon::apps
