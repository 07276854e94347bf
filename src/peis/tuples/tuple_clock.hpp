// Time as tuples carry it (SCH-07).
#pragma once

#include <optional>

#include "core/time.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::peis {

/// Network time: ecology time plus an offset that the owner may change. Only what is written from
/// then on is dated by a new offset, and what is held expires when it was to.
class tuple_clock {
public:
  explicit tuple_clock(duration offset = {}) : offset_(offset) {}

  void set_offset(duration offset) { offset_ = offset; }

  /// Network time of an ecology time; nothing where seconds have meanings of their own: `deleted`
  /// and all below.
  [[nodiscard]] std::optional<timestamp> to_timestamp(instant x) const;

  /// The same, with `never` for what cannot be carried.
  [[nodiscard]] timestamp network_time(instant now) const {
    return to_timestamp(now).value_or(never);
  }

  /// When it expires; nothing if it lives until it is deleted.
  [[nodiscard]] std::optional<instant> expiry_of(const tuple& x) const;

private:
  duration offset_;
};

} // namespace rubicon::peis
