#include "firmware/session.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <utility>

namespace rubicon::firmware {

namespace {

constexpr unsigned frame_type_mask = 7; // IEEE 802.15.4-2006 7.2.1.1.1
constexpr unsigned frame_type_ack = 2;
constexpr unsigned leds_mask = 0xff;

/// The farthest that a timer can be set; beyond it is never.
constexpr std::uint64_t timer_max_us = 3'000'000'000'000'000; // 95 years

char printable(std::uint8_t x) {
  return x >= ' ' && x < 0x7f ? static_cast<char>(x) : '?';
}

} // namespace

session::session(std::unique_ptr<code> firmware, const identity& who, random_stream rng,
                 reader read)
    : code_(std::move(firmware)), who_(who), rng_(rng), read_(std::move(read)) {
  assert(code_ != nullptr);
}

template <class Call>
outputs session::call(instant now, Call what) {
  now_ = now;
  lines_ = 0;
  ++counters_.calls;
  what(shown(now));
  return std::exchange(out_, {});
}

outputs session::start(instant now) {
  began_ = now;
  return call(now, [this](std::uint64_t at) {
    code_->init(who_, *this);
    code_->run(at);
  });
}

outputs session::on_time(instant now) {
  if (!due_ || now < *due_)
    return {};
  due_.reset();
  return call(now, [this](std::uint64_t at) { code_->run(at); });
}

outputs session::on_frame(byte_view frame, int rssi_dbm, instant now) {
  ++counters_.received;
  return call(now, [&](std::uint64_t at) { code_->received(at, frame, rssi_dbm); });
}

outputs session::on_sent(outcome how, instant now) {
  assert(open_ > 0);
  --open_;
  counters_.unsent += how == RUBICON_MOTE_SENT ? 0 : 1;
  return call(now, [&](std::uint64_t at) { code_->sent(at, how); });
}

std::uint64_t session::shown(instant now) const {
  return static_cast<std::uint64_t>(
      std::chrono::floor<std::chrono::microseconds>(now - began_).count());
}

answer session::send(byte_view frame) {
  if (frame.size() < RUBICON_MOTE_FRAME_MIN || frame.size() > RUBICON_MOTE_FRAME_MAX ||
      (frame[0] & frame_type_mask) == frame_type_ack) {
    ++counters_.frames_invalid;
    return RUBICON_MOTE_INVALID;
  }
  if (open_ == open_frames_max) {
    ++counters_.frames_full;
    return RUBICON_MOTE_FULL;
  }
  ++open_;
  ++counters_.frames;
  out_.emplace_back(send_frame{to_bytes(frame)});
  return RUBICON_MOTE_OK;
}

/// Of several between two frames the last counts.
template <class Output>
void session::replace_last(Output x) {
  for (auto at = out_.rbegin(); at != out_.rend(); ++at) {
    if (std::holds_alternative<send_frame>(*at))
      break;
    if (auto* before = std::get_if<Output>(&*at)) {
      *before = x;
      return;
    }
  }
  out_.emplace_back(x);
}

void session::set_radio(bool on) {
  replace_last(switch_radio{on});
}

void session::set_timer(std::uint64_t at_us) {
  if (at_us > timer_max_us) {
    due_.reset();
    return;
  }
  const auto asked = began_ + 1us * static_cast<duration::rep>(at_us);
  const auto earliest = now_ + run_pause_min;
  counters_.early_timers += asked < earliest ? 1 : 0;
  due_ = std::max(asked, earliest);
}

void session::write_serial(byte_view octets) {
  counters_.serial_octets += octets.size();
  for (const auto each : octets) {
    if (each == '\n')
      end_serial_line();
    else if (each != '\r' && serial_.size() < line_octets_max)
      serial_ += printable(each);
  }
}

void session::end_serial_line() {
  put_line(true, std::exchange(serial_, {}));
}

std::uint32_t session::draw() {
  return static_cast<std::uint32_t>(rng_.next() >> 32U);
}

std::optional<std::int32_t> session::read(std::string_view sensor) {
  const auto found = read_ ? read_(sensor) : std::nullopt;
  counters_.absent_sensors += found ? 0 : 1;
  return found;
}

void session::set_leds(unsigned on) {
  replace_last(show_leds{on & leds_mask});
}

void session::log(std::string_view line) {
  std::string text;
  for (const auto each : line.substr(0, line_octets_max))
    text += printable(static_cast<std::uint8_t>(each));
  put_line(false, std::move(text));
}

void session::put_line(bool serial, std::string text) {
  if (lines_ == lines_max) {
    ++counters_.lines_dropped;
    return;
  }
  ++lines_;
  out_.emplace_back(write_line{serial, std::move(text)});
}

} // namespace rubicon::firmware
