// What actors' counters become in the report.
#pragma once

#include <cstddef>

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

} // namespace rubicon
