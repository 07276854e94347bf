#include "mote/crystal.hpp"

namespace rubicon::mote {

namespace {

constexpr std::int64_t billion = 1'000'000'000;

} // namespace

instant crystal::own(instant real) const {
  const auto since = real.time_since_epoch().count();
  const auto ahead = since / billion * ppb_ + since % billion * ppb_ / billion;
  return real + duration(ahead);
}

instant crystal::real(instant own) const {
  auto guess = own;
  for (int i = 0; i < 4; ++i) // each brings it nearer by a factor of 1e9 / ppb
    guess += own - this->own(guess);
  while (this->own(guess) < own)
    guess += 1ns;
  while (this->own(guess - 1ns) >= own)
    guess -= 1ns;
  return guess;
}

} // namespace rubicon::mote
