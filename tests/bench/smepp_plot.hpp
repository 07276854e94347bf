// The experiment of D1.1 3.4.4 as a drawing: charge, and time in each state of the radio.
#pragma once

#include <iosfwd>
#include <vector>

namespace bench {

/// What s2 does on average; times are shares of all.
struct smepp_row {
  unsigned subscriptions = 0;
  bool saves = true; ///< the energy efficiency module is on
  double mah = 0;
  double inactive = 0;
  double ready = 0;
  double receiving = 0;
  double sending = 0;
  double delivery = 0;     ///< of events
  double frames = 0;       ///< of all motes
  double frame_octets = 0; ///< of each, on average, without the radio's headers
};

/// Writes an SVG with charge over subscriptions, and the states as stacked bars.
void draw_smepp(std::ostream& out, const std::vector<smepp_row>& rows);

/// What a change of a group's keys costs all its members together.
struct key_change_row {
  unsigned members = 0; ///< before one leaves
  double frames = 0;
  double mah = 0;
};

/// Writes an SVG with frames and charge over the size of the group.
void draw_key_changes(std::ostream& out, const std::vector<key_change_row>& rows);

} // namespace bench
