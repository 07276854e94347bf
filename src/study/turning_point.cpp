#include "study/turning_point.hpp"

#include <cassert>
#include <chrono>

namespace rubicon::study {

namespace {

duration whole_ms(duration x) {
  return std::chrono::ceil<std::chrono::milliseconds>(x);
}

} // namespace

turning_point::turning_point(duration seen, duration end, duration within)
    : seen_(whole_ms(seen)), end_(whole_ms(end)), within_(within), certain_from_(end_) {
  assert(within >= 1ms);
}

std::optional<turning_point::question> turning_point::next() const {
  switch (state_) {
  case state::start:
    return question{0s, true};
  case state::seen:
    return question{seen_, false};
  case state::between: {
    const auto middle = before_->at + (certain_from_ - before_->at) / 2;
    return question{std::chrono::floor<std::chrono::milliseconds>(middle), false};
  }
  case state::before:
    return question{before_->at, true};
  case state::ended:
    break;
  }
  return std::nullopt;
}

void turning_point::take(const future_count& x) {
  assert(x.of > 0);
  switch (state_) {
  case state::start:
    at_start_ = x;
    if (x.all()) {
      certain_from_ = x.at;
      state_ = state::ended;
      return;
    }
    before_ = x;
    if (seen_ > x.at && seen_ < end_)
      state_ = state::seen;
    else
      look_between();
    return;
  case state::seen:
  case state::between:
    if (x.all())
      certain_from_ = x.at;
    else
      before_ = x;
    look_between();
    return;
  case state::before:
    before_ = x;
    state_ = state::ended;
    return;
  case state::ended:
    return;
  }
}

void turning_point::look_between() {
  if (certain_from_ - before_->at > within_)
    state_ = state::between;
  else
    state_ = before_->at == at_start_.at ? state::ended : state::before; // the start was counted
}

} // namespace rubicon::study
