#include "radio/listener.hpp"

#include <algorithm>
#include <cassert>

#include "radio/frame.hpp"

namespace rubicon::radio {

listener::listener(const listening_config& config, instant first, instant now)
    : config_(config), first_(first), since_(now), awake_until_(now + config.awake),
      deadline_(awake_until_) {
  assert(config.enabled());
}

bool listener::stay_awake(instant now) {
  const bool was_asleep = state_ == state::asleep;
  const bool was_awake = state_ == state::awake;
  state_ = state::awake;
  awake_until_ = std::max(awake_until_, now + config_.awake);
  if (!was_awake)
    deadline_ = awake_until_;
  return was_asleep;
}

void listener::on_time(instant now, bool was_busy, bool busy) {
  if (now < deadline_)
    return;
  switch (state_) {
  case state::asleep:
    state_ = state::checking;
    since_ = now;
    deadline_ = now + config_.check;
    return;
  case state::checking:
    if (was_busy || busy)
      stay_awake(now);
    else
      sleep(now);
    return;
  case state::awake:
    if (awake_until_ > now)
      deadline_ = awake_until_;
    else if (busy)
      deadline_ = now + air_time(psdu_max); // then it is seen again
    else
      sleep(now);
    return;
  }
}

void listener::sleep(instant now) {
  state_ = state::asleep;
  const auto gone = now - first_;
  const auto checks = gone < 0s ? 0 : gone / config_.interval + 1;
  deadline_ = first_ + checks * config_.interval;
}

} // namespace rubicon::radio
