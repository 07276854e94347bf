#include "radio/medium/noise.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <compare>
#include <utility>

namespace rubicon::radio {

namespace {

constexpr std::uint64_t bits_per_reading = 5;
constexpr std::uint64_t half_bits = bits_per_reading * noise_trace::history / 2;

/// 0..22.
std::uint64_t level(std::int8_t reading_dbm) {
  return static_cast<std::uint64_t>(std::clamp<int>(reading_dbm, -115, -5) + 115) / 5;
}

struct pattern {
  std::uint64_t older = 0;
  std::uint64_t newer = 0;

  void push(std::int8_t reading_dbm) {
    constexpr auto mask = (std::uint64_t{1} << half_bits) - 1;
    older = (older << bits_per_reading | newer >> (half_bits - bits_per_reading)) & mask;
    newer = (newer << bits_per_reading | level(reading_dbm)) & mask;
  }

  friend auto operator<=>(const pattern&, const pattern&) = default;
};

struct meeting {
  pattern before;
  std::uint32_t place = 0;

  friend auto operator<=>(const meeting&, const meeting&) = default;
};

/// Ascending by pattern, then place; also what stands before the end of the trace.
std::vector<meeting> meetings(const std::vector<std::int8_t>& readings) {
  std::vector<meeting> all;
  all.reserve(readings.size() - noise_trace::history + 1);
  pattern last;
  for (std::uint32_t place = 0; place < readings.size(); ++place) {
    if (place >= noise_trace::history)
      all.push_back({last, place});
    last.push(readings[place]);
  }
  all.push_back({last, static_cast<std::uint32_t>(readings.size())});
  std::sort(all.begin(), all.end());
  return all;
}

} // namespace

noise_trace::noise_trace(std::vector<std::int8_t> readings_dbm)
    : readings_(std::move(readings_dbm)) {
  assert(readings_.size() >= readings_min && readings_.size() <= readings_max);
  const auto all = meetings(readings_);
  const auto end = static_cast<std::uint32_t>(readings_.size());
  patterns_.resize(all.size());
  places_.reserve(all.size() - 1);
  bool end_is_new = false;
  std::uint32_t commonest = 0;
  std::size_t most = 0;
  for (auto from = all.begin(); from != all.end();) {
    const auto to = std::find_if(from, all.end(),
                                 [from](const meeting& x) { return x.before != from->before; });
    const auto number = static_cast<std::uint32_t>(starts_.size());
    const auto start = places_.size();
    for (; from != to; ++from) {
      patterns_[from->place - history] = number;
      if (from->place != end) // nothing follows there
        places_.push_back(from->place);
    }
    if (places_.size() == start) {
      end_is_new = true;
      continue;
    }
    starts_.push_back(static_cast<std::uint32_t>(start));
    if (places_.size() - start > most) {
      most = places_.size() - start;
      commonest = number;
    }
  }
  starts_.push_back(static_cast<std::uint32_t>(places_.size()));
  if (end_is_new)
    patterns_.back() = commonest;
}

std::uint32_t noise_trace::random_place(random_stream& rng) const {
  return static_cast<std::uint32_t>(history + rng.below(readings_.size() - history));
}

std::uint32_t noise_trace::next_place(std::uint32_t place, random_stream& rng) const {
  const auto now = patterns_[place + 1 - history];
  const auto start = starts_[now];
  const auto count = starts_[now + 1] - start;
  return places_[count == 1 ? start : start + rng.below(count)];
}

noise_source::noise_source(std::shared_ptr<const noise_trace> trace, random_stream rng)
    : trace_(std::move(trace)), rng_(rng) {
  assert(trace_);
}

std::int8_t noise_source::at(instant at) {
  const auto now = std::chrono::floor<std::chrono::milliseconds>(at.time_since_epoch()).count();
  assert(!started_ || now >= millisecond_);
  if (!started_ || now - millisecond_ > memory / 1ms) {
    place_ = trace_->random_place(rng_);
    started_ = true;
  } else {
    for (; millisecond_ < now; ++millisecond_)
      place_ = trace_->next_place(place_, rng_);
  }
  millisecond_ = now;
  return trace_->readings()[place_];
}

} // namespace rubicon::radio
