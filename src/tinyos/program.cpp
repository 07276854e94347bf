#include "tinyos/program.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>

#include "core/codec.hpp"

namespace rubicon::tinyos {

namespace {

constexpr std::size_t oscilloscope_octets = 4 * 2 + readings_in_packet * 2;
constexpr std::size_t blink_octets = 4;
constexpr std::size_t count_octets = 2;

std::uint16_t milliseconds(duration x) {
  return static_cast<std::uint16_t>(x / 1ms);
}

} // namespace

program::program(const program_config& config, mote_id self, instant first)
    : kind_(config.kind), self_(self), interval_(config.every), due_(first) {
  assert(interval_ >= 1ms);
}

std::optional<packet> program::on_time(instant now, const reader& read) {
  if (now < due_)
    return {};
  due_ = std::max(due_ + interval_, now); // what a late caller has missed is not made up for
  if (kind_ == program_kind::oscilloscope)
    return read_on(now, read);
  ++count_;
  return send(count());
}

/// The packet goes with the tick after its last reading, which is the first of the next one's.
std::optional<packet> program::read_on(instant /*now*/, const reader& read) {
  std::optional<packet> out;
  if (filled_ == readings_.size()) {
    out = send(readings());
    filled_ = 0;
    if (!took_count_)
      ++count_;
    took_count_ = false;
  }
  readings_[filled_++] = read();
  return out;
}

std::optional<packet> program::send(packet x) {
  if (at_radio_) {
    ++counters_.radio_busy;
    return {};
  }
  at_radio_ = true;
  ++counters_.packets;
  return x;
}

void program::on_sent(bool sent) {
  at_radio_ = false;
  counters_.unsent += sent ? 0 : 1;
}

packet program::readings() const {
  byte_writer out;
  out.big(version_).big(milliseconds(interval_)).big(self_.value).big(count_);
  for (const auto each : readings_)
    out.big(each);
  return {oscilloscope_type, out.finish()};
}

packet program::count() const {
  byte_writer out;
  if (kind_ == program_kind::blink)
    out.big(self_.value);
  out.big(count_);
  return {counter_type, out.finish()};
}

void program::on_packet(std::uint8_t am_type, byte_view payload, instant now) {
  const bool reads = kind_ == program_kind::oscilloscope;
  if (am_type != (reads ? oscilloscope_type : counter_type))
    return;
  const auto octets = reads                          ? oscilloscope_octets
                      : kind_ == program_kind::blink ? blink_octets
                                                     : count_octets;
  if (payload.size() != octets) {
    ++counters_.ignored;
    return;
  }
  ++counters_.received;
  if (reads)
    on_settings(payload, now);
  else
    leds_ = payload.back() & 7U; // of the count, which comes last in both
}

void program::on_settings(byte_view payload, instant now) {
  byte_reader in(payload);
  const auto version = in.big<std::uint16_t>();
  const auto interval = in.big<std::uint16_t>();
  in.skip(2); // whose
  const auto count = in.big<std::uint16_t>();
  leds_ ^= 4U; // it toggles one for each packet
  if (version > version_) {
    ++counters_.settings;
    version_ = version;
    interval_ = std::max<duration>(1ms * interval, 1ms); // 0 would be a timer without end
    due_ = now + interval_;
    filled_ = 0;
  }
  if (count > count_) {
    count_ = count;
    took_count_ = true;
  }
}

} // namespace rubicon::tinyos
