#include "serial/ack_patience.hpp"

#include <algorithm>

namespace rubicon::serial {

namespace {

constexpr unsigned noisy_answers_max = 64;

} // namespace

void ack_patience::on_answer(duration round_trip, bool repeated) {
  silent_ = false;
  round_trips_[next_] = round_trip;
  next_ = (next_ + 1) % round_trips_.size();
  measured_ = std::min(measured_ + 1, round_trips_.size());
  if (repeated)
    noisy_answers_ = noisy_answers_max;
  else if (noisy_answers_ > 0)
    --noisy_answers_;
}

void ack_patience::on_silence() {
  if (silent_) {
    measured_ = 0;
    next_ = 0;
  }
  silent_ = true;
}

duration ack_patience::wait(bool last_attempt) const {
  if (noisy_answers_ == 0 || measured_ == 0)
    return longest_;
  const auto end = round_trips_.begin() + static_cast<std::ptrdiff_t>(measured_);
  const auto slowest = *std::max_element(round_trips_.begin(), end);
  const auto usual = slowest + slowest / 8 + 250us;
  return std::min(last_attempt ? 4 * usual : usual, longest_);
}

} // namespace rubicon::serial
