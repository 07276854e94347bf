// Motes with plain programs, as the gateway's core knows them.
#include <algorithm>
#include <iterator>

#include "gateway/gateway_parts.hpp"

namespace rubicon::gateway {

outputs gateway::on_plain_packet(const sink_packet& x, instant now) {
  now_ = now;
  outputs out;
  if (!config_.has_real_line)
    on_line_input(out);
  plain_pause_ = std::max(plain_pause_, last_plain_input_ ? now - *last_plain_input_ : duration{});
  last_plain_input_ = now;
  refresh(x.source, out);
  is_plain_said_ = true;
  std::ranges::move(dispatch(x.source, x.am_type, x.payload, now), std::back_inserter(out));
  is_plain_said_ = false;
  return out;
}

outputs gateway::on_plain_done(std::uint64_t number, bool acked, instant now) {
  now_ = now;
  outputs out;
  const bool is_sent = acked && !(config_.is_forwarded && is_plain_silent());
  if (const auto found = plain_pending_.extract(number); !found.empty())
    report_outcome(found.mapped(), is_sent ? input_outcome::sent : input_outcome::failed, out);
  return out;
}

/// Whether nothing has come from plain motes for so long that their forwarder may hang.
bool gateway::is_plain_silent() const {
  return !last_plain_input_ ||
         now_ - *last_plain_input_ >= std::max(config_.line_silence_max, 2 * plain_pause_);
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
