// When a mote reports to the sink where it is, and whose child.
#pragma once

#include <optional>

#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/places/coordinates.hpp"

namespace rubicon::network {

/// At least once in `period`, and `gap` after a change: twice as long with each further change.
class place_reports {
public:
  static constexpr duration period = 8min;
  static constexpr duration gap = 5s;

  place_reports() = default;
  explicit place_reports(instant now) : reported_(now), gap_(gap) {}

  /// Of a mote with a route. @param place where it is likely to be
  [[nodiscard]] instant due(std::optional<virtual_coordinates> place, mote_id parent) const;

  /// A packet leaves for the sink, whose header contains the parent.
  void on_packet(mote_id parent) { parent_ = parent; }
  /// The sink has forgotten our place.
  void on_forgotten(random_stream& rng) { gap_ = gap + rng.between(0s, gap); }

  /// A report of this place is sent now. @param is_held others wait for the same turn: who has
  /// begun with them does not go on with them
  void on_report(std::optional<virtual_coordinates> place, bool is_held, instant now,
                 random_stream& rng);

private:
  std::optional<virtual_coordinates> place_; ///< as it was reported
  mote_id parent_ = no_mote;                 ///< the same
  instant reported_;                         ///< when it was reported last
  duration gap_{};                           ///< from then to the report of a change
};

} // namespace rubicon::network
