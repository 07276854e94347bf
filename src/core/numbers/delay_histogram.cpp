#include "core/numbers/delay_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/describe/content.hpp"

namespace rubicon {

namespace {

// Each power of two of nanoseconds has as many buckets of equal width, below the first of them a
// bucket is one nanosecond wide.
constexpr unsigned buckets_log2 = 6;
constexpr unsigned buckets_per_octave = 1U << buckets_log2;

using bucket = std::pair<std::uint16_t, std::uint32_t>;

std::uint16_t bucket_of(std::uint64_t ns) {
  if (ns < buckets_per_octave)
    return static_cast<std::uint16_t>(ns);
  const auto octave = static_cast<unsigned>(std::bit_width(ns)) - 1 - buckets_log2;
  return static_cast<std::uint16_t>(std::uint64_t{octave} * buckets_per_octave + (ns >> octave));
}

/// Halfway between the smallest and the largest whole number in a bucket. What another computer
/// sends may have any number.
double middle_ns(std::uint16_t number) {
  number = std::min(number, bucket_of(std::numeric_limits<std::uint64_t>::max()));
  if (number < buckets_per_octave)
    return number;
  const auto octave = number / buckets_per_octave - 1;
  const auto smallest = static_cast<std::uint64_t>(number - octave * buckets_per_octave) << octave;
  const auto width = std::uint64_t{1} << octave;
  return static_cast<double>(smallest) + static_cast<double>(width - 1) / 2;
}

std::uint32_t add_up(std::uint32_t a, std::uint32_t b) {
  return b > std::numeric_limits<std::uint32_t>::max() - a
             ? std::numeric_limits<std::uint32_t>::max()
             : a + b;
}

} // namespace

void delay_histogram::add(duration x) {
  const auto ns = static_cast<std::uint64_t>(std::max<duration::rep>(x.count(), 0));
  ++count_;
  sum_ns_ += static_cast<double>(ns);
  const auto number = bucket_of(ns);
  auto place = std::ranges::lower_bound(buckets_, number, {}, &bucket::first);
  if (place == buckets_.end() || place->first != number)
    place = buckets_.emplace(place, number, 0);
  place->second = add_up(place->second, 1);
}

delay_histogram& delay_histogram::operator+=(const delay_histogram& x) {
  count_ += x.count_;
  sum_ns_ += x.sum_ns_;
  std::vector<bucket> merged;
  merged.reserve(buckets_.size() + x.buckets_.size());
  std::ranges::merge(buckets_, x.buckets_, std::back_inserter(merged), {}, &bucket::first,
                     &bucket::first);
  buckets_.clear();
  for (const auto& [number, count] : merged) {
    if (!buckets_.empty() && buckets_.back().first == number)
      buckets_.back().second = add_up(buckets_.back().second, count);
    else
      buckets_.emplace_back(number, count);
  }
  return *this;
}

double delay_histogram::mean_ms() const {
  return count_ == 0 ? 0 : sum_ns_ / static_cast<double>(count_) / 1e6;
}

double delay_histogram::quantile_ms(double q) const {
  if (buckets_.empty())
    return 0;
  const auto rank = std::max(1.0, std::ceil(q * static_cast<double>(count_)));
  double passed = 0;
  for (const auto& [number, count] : buckets_) {
    passed += count;
    if (passed >= rank)
      return middle_ns(number) / 1e6;
  }
  return middle_ns(buckets_.back().first) / 1e6;
}

void delay_histogram::fold_into(fold64& x) const {
  x.add(count_);
  fold_content(x, sum_ns_);
  fold_content(x, buckets_);
}

void delay_histogram::print_to(std::string& out) const {
  out += std::to_string(count_) + " of ";
  print_content(out, mean_ms());
  out += " ms";
}

} // namespace rubicon
