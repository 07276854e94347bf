#include "serial/ack_patience.hpp"

#include <algorithm>

namespace rubicon::serial {

namespace {

constexpr unsigned noisy_answers_max = 64;

} // namespace

void ack_patience::on_answer(duration answer, bool repeated) {
  silent_ = false;
  answers_[next_] = answer;
  next_ = (next_ + 1) % answers_.size();
  measured_ = std::min(measured_ + 1, answers_.size());
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

duration ack_patience::wait(duration on_line, duration longest, bool last_attempt) const {
  if (noisy_answers_ == 0 || measured_ == 0)
    return longest;
  const auto end = answers_.begin() + static_cast<std::ptrdiff_t>(measured_);
  const auto slowest = *std::max_element(answers_.begin(), end);
  const auto usual = on_line + slowest + slowest / 8 + 250us;
  return std::min(last_attempt ? 4 * usual : usual, longest);
}

} // namespace rubicon::serial
