#include "peis/tuples/tuple_clock.hpp"

namespace rubicon::peis {

std::optional<timestamp> tuple_clock::to_timestamp(instant x) const {
  const auto since = x.time_since_epoch() + offset_;
  const auto whole = std::chrono::floor<std::chrono::seconds>(since);
  if (whole.count() <= deleted.seconds)
    return std::nullopt;
  const auto rest = std::chrono::duration_cast<std::chrono::microseconds>(since - whole);
  return timestamp{whole.count(), static_cast<std::int32_t>(rest.count())};
}

std::optional<instant> tuple_clock::expiry_of(const tuple& x) const {
  if (x.expiry == never)
    return std::nullopt;
  if (x.expiry == deleted)
    return instant::min();
  return instant(std::chrono::seconds(x.expiry.seconds) +
                 std::chrono::microseconds(x.expiry.microseconds) - offset_);
}

} // namespace rubicon::peis
