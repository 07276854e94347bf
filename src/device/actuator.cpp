#include "device/actuator.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <utility>

namespace rubicon::device {

namespace {

constexpr std::int64_t full = 255;

} // namespace

actuator::actuator(actuator_config config) : config_(std::move(config)), target_(config_.initial) {
  assert(config_.kind != actuator_kind::relay || config_.travel == 0s);
  from_ = travel_of(target_);
}

bool actuator::set(std::uint8_t target, instant now) {
  if (config_.kind == actuator_kind::relay && target > 1)
    return false;
  from_ = travel_at(now);
  begin_ = now;
  target_ = target;
  const auto rest = std::chrono::abs(travel_of(target) - from_);
  arrival_ = rest > 0s ? std::optional(now + rest) : std::nullopt;
  return true;
}

std::uint8_t actuator::state(instant now) const {
  if (!arrival_ || now >= *arrival_)
    return target_;
  const auto travel = config_.travel.count();
  return static_cast<std::uint8_t>((travel_at(now).count() * full + travel / 2) / travel);
}

bool actuator::on_time(instant now) {
  if (!arrival_ || now < *arrival_)
    return false;
  from_ = travel_of(target_);
  arrival_.reset();
  return true;
}

duration actuator::travel_at(instant now) const {
  const auto end = travel_of(target_);
  if (!arrival_ || now >= *arrival_)
    return end;
  const auto moved = std::max(now - begin_, duration(0));
  return end > from_ ? from_ + moved : from_ - moved;
}

duration actuator::travel_of(std::uint8_t state) const {
  return config_.travel * state / full;
}

} // namespace rubicon::device
