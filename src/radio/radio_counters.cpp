#include "radio/radio_counters.hpp"

#include <numeric>

namespace rubicon::radio {

std::string to_string(copy_outcome x) {
  switch (x) {
  case copy_outcome::delivered:
    return "delivered";
  case copy_outcome::weak:
    return "weak";
  case copy_outcome::loss:
    return "loss";
  case copy_outcome::collision:
    return "collision";
  case copy_outcome::captured:
    return "captured";
  case copy_outcome::half_duplex:
    return "half_duplex";
  case copy_outcome::off:
    return "off";
  case copy_outcome::filtered:
    return "filtered";
  case copy_outcome::overflow:
    return "overflow";
  case copy_outcome::duplicate:
    return "duplicate";
  case copy_outcome::out_of_reach:
    return "out_of_reach";
  }
  return "unknown";
}

bool copy_counters::balanced() const {
  return sent == std::accumulate(ended.begin(), ended.end(), std::uint64_t{0});
}

copy_counters link_counters::link(std::size_t place) const {
  copy_counters x;
  if (rows_ == nullptr)
    return x;
  x.sent = frames_;
  for (std::size_t i = 0; i < copy_outcomes; ++i)
    x.ended[i] = ended(place, i);
  return x;
}

bool request_counters::balanced() const {
  auto ended = sent;
  for_each_field(failed, [&ended](std::string_view /*cause*/, auto count) { ended += count; });
  return requests == ended + open;
}

} // namespace rubicon::radio
