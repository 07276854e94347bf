#include "gateway/leadership.hpp"

#include <algorithm>

namespace rubicon::gateway {

leadership::change leadership::on_poll(const network::gateway_poll& x, instant now) {
  newest_term_ = std::max(newest_term_, x.term);
  const bool led = lease_until_.has_value();
  if (!x.leads || x.life != config_.life) {
    if (led)
      end_lead(now);
    return led ? change::lost : change::none;
  }
  if (!led)
    since_ = now;
  lease_until_ = now + config_.lease;
  if (led && term_ == x.term)
    return change::none;
  term_ = x.term;
  ++led_;
  return change::taken;
}

leadership::change leadership::on_time(instant now) {
  if (!lease_until_ || now < *lease_until_)
    return change::none;
  end_lead(now);
  return change::lost;
}

void leadership::end_lead(instant now) {
  lease_until_.reset();
  leading_ += now - since_;
}

duration leadership::leading(instant now) const {
  return leading_ + (lease_until_ ? now - since_ : duration{});
}

} // namespace rubicon::gateway
