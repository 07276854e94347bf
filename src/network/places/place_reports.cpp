#include "network/places/place_reports.hpp"

#include <algorithm>

namespace rubicon::network {

instant place_reports::due(std::optional<virtual_coordinates> place, mote_id parent) const {
  if (place && !place_) // until then channels to this mote are looked for everywhere
    return reported_ + gap;
  return reported_ + (place != place_ || parent != parent_ ? gap_ : period);
}

void place_reports::on_report(std::optional<virtual_coordinates> place, bool is_held, instant now,
                              random_stream& rng) {
  const bool is_restless = now - reported_ < period;
  gap_ = is_restless ? std::min(2 * gap_, period) : gap;
  place_ = place;
  reported_ = now;
  if (is_held)
    reported_ -= rng.between(0s, period / 4);
}

} // namespace rubicon::network
