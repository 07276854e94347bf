// The one broadcast frame that keeps an island together: links, tree, coordinates, clock.
#pragma once

#include <cstdint>
#include <vector>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "core/time.hpp"
#include "network/clock/clock_stamp.hpp"
#include "network/places/coordinates.hpp"
#include "network/tree/gradient.hpp"
#include "network/tree/neighbours.hpp"
#include "network/wire.hpp"

namespace rubicon::network {

/// uint16 sequence, uint16 next, gradient (9 octets), coordinates (26), clock (27 or 37), then for
/// each neighbour heard uint16 mote, uint8 quality; network byte order.
struct beacon {
  std::uint16_t sequence = 0;
  std::uint16_t next_quarters = 0; ///< the next beacon comes within so many quarters of a second
  gradient_part gradient;
  coordinates_part coordinates;
  clock_stamp clock{};                        ///< of root 0: none
  std::vector<neighbours::heard_entry> heard; ///< at most heard_max()

  static constexpr std::size_t header_size =
      4 + gradient_part::size + coordinates_part::size + clock_stamp_size;
  /// Where the clock's age lies, for the radio.
  static constexpr std::size_t age_at =
      4 + gradient_part::size + coordinates_part::size + clock_stamp_age_at;
  [[nodiscard]] static constexpr std::size_t heard_max(const clock_stamp& clock) {
    return (frame_payload_max - header_size - (clock.network ? network_line_size : 0)) / 3;
  }

  /// So many neighbours listed fill a mote's table: there may be no room for more.
  static constexpr std::size_t crowd = neighbours_config{}.capacity;

  /// What this beacon says of its sender's link to `self`, which has a route to the sink or not.
  [[nodiscard]] link_report report(mote_id source, mote_id self, bool has_route) const;

  friend bool operator==(const beacon&, const beacon&) = default;
};

/// @returns `x` in quarters of a second, rounded up, 65535 at most
[[nodiscard]] std::uint16_t quarters(duration x);

/// @pre x.heard.size() <= beacon::heard_max(x.clock)
[[nodiscard]] bytes encode(const beacon& x);

/// Errors: truncated (also within the list), too_long, bad_value (a mote in the list whose id no
/// mote has).
[[nodiscard]] result<beacon> decode_beacon(byte_view octets);

} // namespace rubicon::network
