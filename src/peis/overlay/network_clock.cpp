#include "peis/overlay/network_clock.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/codec.hpp"
#include "core/serial_number.hpp"

namespace rubicon::peis {

namespace {

constexpr duration dead_band = 500ms; // real kernels neither follow nor mind less
constexpr duration agreement = 500us; // what measured routes leave between marked peers
constexpr std::int64_t in_flight_max_us = 0xffffff;

} // namespace

bytes encode(const clock_message& x) {
  const auto whole = std::chrono::floor<std::chrono::seconds>(x.network_time);
  const auto rest = std::chrono::duration_cast<std::chrono::microseconds>(x.network_time - whole);
  const auto way = std::clamp<std::int64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(x.in_flight).count(), 0,
      in_flight_max_us);
  byte_writer to;
  to.big(static_cast<std::uint32_t>(whole.count())).big(static_cast<std::int32_t>(rest.count()));
  to.big(static_cast<std::uint32_t>((x.master ? 1U << 24 : 0U) | static_cast<std::uint32_t>(way)));
  return to.finish();
}

result<clock_message> decode_clock(byte_view octets, duration known) {
  byte_reader from(octets);
  const auto low_seconds = from.big<std::uint32_t>();
  const auto microseconds = from.big<std::int32_t>();
  const auto rest = from.big<std::uint32_t>();
  if (!from.ok())
    return errc::truncated;
  const std::chrono::seconds whole(
      unwrapped(low_seconds, std::chrono::floor<std::chrono::seconds>(known).count()));
  if (whole < 0s || whole >= network_time_end || microseconds < 0 || microseconds >= 1'000'000)
    return errc::bad_value;
  return clock_message{whole + std::chrono::microseconds(microseconds), rest >> 24 != 0,
                       std::chrono::microseconds(rest & in_flight_max_us)};
}

network_clock::network_clock(clock_config config, peer_id self, instant now)
    : config_(config), self_(self), offset_(config.offset), drifted_(now),
      next_(now + config.period) {}

void network_clock::drift(instant now) {
  const auto since = now - std::exchange(drifted_, now);
  offset_ += duration(static_cast<duration::rep>(
      std::floor(static_cast<double>(since.count()) * (static_cast<double>(config_.ppb) * 1e-9))));
}

void network_clock::on_message(const clock_message& x, peer_id source, duration in_transit,
                               bool marked, instant now) {
  drift(now);
  if (config_.master && !x.master)
    return;
  const auto delta = x.network_time + in_transit - at(now);
  last_error_ = delta;
  const bool rules_us = x.master && !config_.master;
  const auto band = marked ? duration(0) : dead_band;
  if (delta > band || (rules_us && delta < -band))
    offset_ += delta;
  if (rules_us || (source > self_ && delta > -(marked ? agreement : dead_band)))
    next_ = now + config_.quiet;
}

std::optional<clock_message> network_clock::on_time(instant now) {
  if (now < next_)
    return std::nullopt;
  drift(now);
  next_ += config_.period;
  if (next_ <= now)
    next_ = now + config_.period; // late: once, without catching up
  return clock_message{at(now), config_.master, 0s};
}

void network_clock::step(duration by, instant now) {
  drift(now);
  const auto longest_back = -at(now);
  const auto longest_ahead = network_time_end - at(now) - duration(1);
  offset_ +=
      std::clamp(by, std::min(longest_back, duration(0)), std::max(longest_ahead, duration(0)));
}

} // namespace rubicon::peis
