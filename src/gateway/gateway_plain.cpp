// Motes with plain programs, as the gateway's core knows them.
#include <algorithm>
#include <iterator>

#include "gateway/gateway_parts.hpp"

namespace rubicon::gateway {

outputs gateway::on_plain_packet(const sink_packet& x, instant now) {
  now_ = now;
  outputs out;
  if (!config_.has_real_line)
    on_line_heard(out);
  refresh(x.source, out);
  is_plain_said_ = true;
  std::ranges::move(dispatch(x.source, x.am_type, x.payload, now), std::back_inserter(out));
  is_plain_said_ = false;
  return out;
}

outputs gateway::on_plain_done(std::uint64_t number, bool acked, instant now) {
  now_ = now;
  outputs out;
  if (const auto found = plain_pending_.extract(number); !found.empty())
    tell_outcome(found.mapped(), acked ? input_outcome::sent : input_outcome::failed, out);
  return out;
}

outputs gateway::on_plain_line_lost(instant now) {
  now_ = now;
  outputs out;
  for (auto& [mote, x] : devices_)
    if (x.plain)
      make_stale(x, mote, out);
  return out;
}

bool gateway::is_plain(mote_id x) const {
  const auto listed = devices_.find(x);
  return listed != devices_.end() && listed->second.plain;
}

} // namespace rubicon::gateway
