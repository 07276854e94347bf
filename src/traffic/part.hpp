// What one mote knows about a flow of packets; the parts of all motes add up to the flow.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/delay_histogram.hpp"
#include "core/time.hpp"

namespace rubicon::traffic {

struct part {
  mote_address from;
  mote_address to;
  std::uint64_t sent = 0;                    ///< the origin's: packets for which it asked its MAC
  std::uint64_t delivered = 0;               ///< the target's, each once
  std::uint64_t octets = 0;                  ///< MAC payload delivered
  std::uint64_t transmissions = 0;           ///< of this mote, for this flow, repeats included
  std::map<std::string, std::uint64_t> lost; ///< on the hop out of this mote, by cause
  duration active{};     ///< the origin's: from its first request to the end of the run or
                         ///< to when it stops sending
  delay_histogram delay; ///< the target's: from the origin's request to delivery

  /// A part without addresses takes those of `x`. @pre otherwise the same flow
  part& operator+=(const part& x);
};
RUBICON_FIELDS(part, from, to, sent, delivered, octets, transmissions, lost, active, delay);

} // namespace rubicon::traffic
