// What actors' counters become in the report.
#pragma once

#include <cstddef>

#include "actors/messages.hpp"
#include "mote/node.hpp"
#include "mote/sink.hpp"
#include "runtime/report.hpp"
#include "transport/endpoint.hpp"

namespace rubicon {

/// @param open reliable sends still waiting for their outcome
[[nodiscard]] inline runtime::message_report report_of(const transport::endpoint_counters& x,
                                                       std::size_t open) {
  runtime::message_report r;
  r.reliable_sent = x.reliable_sent;
  r.reliable_acked = x.reliable_acked;
  r.reliable_failed = x.reliable_failed;
  r.reliable_open = open;
  r.unreliable_sent = x.unreliable_sent;
  r.received = x.received;
  r.duplicates = x.duplicates;
  return r;
}

/// @param own what the clock of this mote or sink shows `now`
[[nodiscard]] network_status status_of(mote_address address, const mote::node& x, instant own,
                                       instant now);

[[nodiscard]] network_status status_of(mote_address address, const mote::sink& x, instant own,
                                       instant now);

} // namespace rubicon
