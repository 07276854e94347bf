#include "network/clock/clock_stamp.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "network/wire.hpp"

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

constexpr unsigned period_bits = 13;
constexpr microseconds tells_network_time{std::int64_t{1} << 47}; ///< added to tick.from
constexpr double doubt_steps = 8;                                 ///< in which a doubt doubles
constexpr double rate_unit = 1e-8;                                ///< of the network time

} // namespace

std::uint8_t doubt_of(microseconds x) {
  if (x <= microseconds{0})
    return 0;
  const auto code = std::ceil(doubt_steps * std::log2(static_cast<double>(x.count())));
  return static_cast<std::uint8_t>(std::clamp(code, 1.0, doubt_asks - 1.0));
}

microseconds limit_of(std::uint8_t doubt) {
  if (doubt == 0)
    return microseconds{0};
  return microseconds(static_cast<std::int64_t>(std::ceil(std::exp2(doubt / doubt_steps))));
}

void write(byte_writer& to, const clock_stamp& x) {
  to.big(x.root.value).octet(x.era).big(x.sequence);
  assert(x.tick.from >= island_time{} && x.tick.from.time_since_epoch() < tells_network_time);
  write(to, x.time);
  to.big(x.age_us).big(x.tick.first);
  write(to, x.network ? x.tick.from + tells_network_time : x.tick.from);
  to.big(static_cast<std::uint16_t>(x.tick.period.count() | x.slots_used << period_bits));
  to.octet(x.doubt);
  if (x.network) {
    const auto rate = std::clamp(std::floor(x.network->rate / rate_unit + 0.5), -32768.0, 32767.0);
    to.big(static_cast<std::uint64_t>(x.network->ahead.count()));
    to.big(static_cast<std::uint16_t>(static_cast<std::int16_t>(rate)));
  }
}

clock_stamp read_clock_stamp(byte_reader& from) {
  clock_stamp x;
  x.root = mote_id{from.big<std::uint16_t>()};
  x.era = from.octet();
  x.sequence = from.big<std::uint16_t>();
  x.time = read_island_time(from);
  x.age_us = from.big<std::uint32_t>();
  x.tick.first = from.big<std::uint32_t>();
  x.tick.from = read_island_time(from);
  const auto period = from.big<std::uint16_t>();
  x.tick.period = std::chrono::milliseconds(period & ((1U << period_bits) - 1));
  x.slots_used = static_cast<std::uint8_t>(period >> period_bits);
  x.doubt = from.octet();
  if (x.tick.from.time_since_epoch() >= tells_network_time) {
    x.tick.from -= tells_network_time;
    network_line line;
    line.ahead = microseconds(static_cast<std::int64_t>(from.big<std::uint64_t>()));
    line.rate = static_cast<std::int16_t>(from.big<std::uint16_t>()) * rate_unit;
    x.network = line;
  }
  return x;
}

} // namespace rubicon::network
