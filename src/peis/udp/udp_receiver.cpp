#include "peis/udp/udp_receiver.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

namespace {

/// A sender without credit may ask with a part whether there is room again.
constexpr std::size_t parts_to_spare = 16;
constexpr std::size_t bitmap_max = 64; ///< octets
constexpr std::size_t memory_first = std::size_t{64} * 1024;

} // namespace

udp_receiver::outcome udp_receiver::on_part(const udp_segment& x) {
  ++count_;
  newest_ = std::max(newest_, widened(x.number, newest_));
  report_due_ = true;
  const auto waiting = in_order_.size() / udp_content_max;
  if (x.sequence < expected_ || early_.contains(x.sequence))
    return outcome::repeated;
  if (x.sequence - expected_ >= parts_max_ || waiting >= parts_max_ + parts_to_spare)
    return outcome::out_of_window;
  if (x.sequence != expected_)
    early_.emplace(x.sequence, to_bytes(x.content));
  else
    append_in_order(x.content);
  return outcome::taken;
}

void udp_receiver::append_in_order(byte_view content) {
  if (in_order_.capacity() < memory_first)
    in_order_.reserve(memory_first);
  in_order_.insert(in_order_.end(), content.begin(), content.end());
  ++expected_;
  while (!early_.empty() && early_.begin()->first == expected_) {
    const auto& next = early_.begin()->second;
    in_order_.insert(in_order_.end(), next.begin(), next.end());
    early_.erase(early_.begin());
    ++expected_;
  }
}

bytes udp_receiver::take(bytes next) {
  next.clear();
  auto x = std::exchange(in_order_, std::move(next));
  if (given_credit_ < parts_max_ / 2)
    report_due_ = true; // the other side may be waiting for it
  return x;
}

void udp_receiver::report_in(udp_segment& x) {
  x.expected = expected_;
  x.newest = static_cast<std::uint32_t>(newest_);
  x.count = count_;
  x.credit = given_credit_ = credit();
}

std::uint16_t udp_receiver::credit() const {
  const auto waiting = std::min(parts_max_, in_order_.size() / udp_content_max);
  return static_cast<std::uint16_t>(parts_max_ - waiting);
}

bytes udp_receiver::bitmap() const {
  bytes x;
  for (const auto& [sequence, content] : early_) {
    const auto at = sequence - expected_ - 1;
    if (at / 8 >= bitmap_max)
      break;
    x.resize(std::max<std::size_t>(x.size(), at / 8 + 1));
    x[at / 8] = static_cast<std::uint8_t>(x[at / 8] | 0x80U >> at % 8);
  }
  return x;
}

} // namespace rubicon::peis
