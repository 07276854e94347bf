#include "gateway/mote_inputs.hpp"

#include "gateway/tuples.hpp"
#include "network/island_packet.hpp"

namespace rubicon::gateway {

mote_inputs::mote_inputs(const gateway_config& config)
    : island_(config.island), outstanding_max_(config.inputs_outstanding_max),
      channels_max_(config.input_channels_max), relay_wait_(config.relay_wait),
      slacks_(config.slacks) {}

std::optional<pending_input> mote_inputs::begin(mote_id mote, std::uint16_t channel,
                                                const occasion& at) {
  if (!sequences_.contains({mote, channel}) && sequences_.size() >= channels_max_) {
    ++at.counters.inputs_refused;
    return std::nullopt;
  }
  ++at.counters.inputs;
  const pending_input x{mote, channel, ++sequences_[{mote, channel}]};
  report(x, input_outcome::pending, at);
  return x;
}

void mote_inputs::on_outcome(const transport::outcome& x, const occasion& at) {
  if (const auto found = sent_.extract(x.id); !found.empty())
    report(found.mapped(), x.acked ? input_outcome::acknowledged : input_outcome::failed, at);
}

void mote_inputs::send_to_plain(const pending_input& x, byte_view octets, const occasion& at) {
  ++at.counters.plain_inputs;
  plain_[++plain_number_] = x;
  at.out.emplace_back(to_plain{plain_number_, x.mote, x.channel, to_bytes(octets)});
}

void mote_inputs::on_plain_done(std::uint64_t number, bool arrived, const occasion& at) {
  if (const auto found = plain_.extract(number); !found.empty())
    report(found.mapped(), arrived ? input_outcome::sent : input_outcome::failed, at);
}

void mote_inputs::report(const pending_input& x, input_outcome outcome, const occasion& at) const {
  if (x.asker)
    at.out.emplace_back(relay_to{
        *x.asker, encode(relay(relayed_outcome{static_cast<std::uint32_t>(x.sequence), outcome}))});
  else
    at.out.emplace_back(status_tuple(x.mote, x.channel, x.sequence, outcome));
}

void mote_inputs::pass_on(const pending_input& x, std::optional<peer_id> leader, byte_view octets,
                          const occasion& at) {
  if (!leader) {
    report(x, input_outcome::unreachable, at);
    return;
  }
  if (octets.size() > network::body_max || relayed_.size() >= outstanding_max_) {
    report(x, input_outcome::failed, at);
    return;
  }
  ++at.counters.relayed_out;
  relayed_[++relay_number_] = {x, at.now + relay_wait(x.mote)};
  at.out.emplace_back(relay_to{
      *leader, encode(relay(relayed_input{relay_number_, x.mote, x.channel, to_bytes(octets)}))});
}

duration mote_inputs::relay_wait(mote_id mote) const {
  const auto slack = slack_of(slacks_, {island_, mote}).there_and_back;
  return relay_wait_ + 2 * transport::messenger_config::attempts_max * slack;
}

void mote_inputs::on_relayed(const relayed_outcome& x, const occasion& at) {
  if (const auto found = relayed_.extract(x.number); !found.empty())
    report(found.mapped().what, x.outcome, at);
}

void mote_inputs::fail_all(const occasion& at) {
  for (const auto& [number, x] : std::exchange(sent_, {}))
    report(x, input_outcome::failed, at);
  for (const auto& [number, x] : std::exchange(relayed_, {}))
    report(x.what, input_outcome::failed, at);
}

void mote_inputs::on_time(const occasion& at) {
  for (auto x = relayed_.begin(); x != relayed_.end();) {
    if (x->second.expires > at.now) {
      ++x;
      continue;
    }
    report(x->second.what, input_outcome::failed, at);
    x = relayed_.erase(x);
  }
}

std::optional<instant> mote_inputs::deadline() const {
  std::optional<instant> due;
  for (const auto& [number, x] : relayed_)
    due = earliest(due, x.expires);
  return due;
}

} // namespace rubicon::gateway
