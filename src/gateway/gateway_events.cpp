// The events that the sink sends its gateway.
#include <utility>

#include "core/hash.hpp"
#include "gateway/gateway_parts.hpp"
#include "network/am.hpp"

namespace rubicon::gateway {

outputs gateway::on_event(const network::mote_joined& x, instant now) {
  if (devices_.size() >= config_.devices_max && !devices_.contains(x.mote)) {
    ++counters_.devices_refused;
    return {};
  }
  const auto [listed, is_new] = devices_.try_emplace(x.mote);
  const auto said = fold64().add(x.type).add(byte_view(x.descriptor)).value();
  const bool restarted = listed->second.incarnation != x.incarnation;
  if (restarted)
    pc_.forget_incarnation({config_.island, x.mote});
  // A mote is the same all its life: one of two that differ is a lie. The sink knows.
  const bool contradicts = !is_new && !restarted && listed->second.said != said;
  listed->second.incarnation = x.incarnation;
  listed->second.said = said;
  listed->second.stale = false;
  listed->second.plain = is_plain_said_;
  if (!is_plain_said_)
    requests_.on_listed(x.mote, x.incarnation, now);
  outputs out{publish{device_type_key(x.mote), device_type_octets(x.type), false},
              publish{device_descriptor_key(x.mote), x.descriptor, false}, device_list(),
              presence_tuple(x.mote, {device_presence::listed, {}, now})};
  if (is_new || restarted) {
    out.emplace_back(member_changed{x.mote, true, x.incarnation, {}});
    for (auto& y : take(pc_.on_mote_joined(x.mote, x.descriptor, now)))
      out.push_back(std::move(y));
  }
  if (contradicts)
    out.emplace_back(ask_about(x.mote));
  return out;
}

outputs gateway::on_event(const network::mote_left& x, instant) {
  return remove(x.mote, x.cause);
}

outputs gateway::on_event(const network::roster& x, instant now) {
  if (roster_number_ != x.number) {
    roster_number_ = x.number;
    roster_seen_.clear();
    roster_pages_seen_ = 0;
  }
  ++roster_pages_seen_;
  outputs out;
  for (const auto& entry : x.entries) {
    roster_seen_.insert(entry.mote);
    const auto known = devices_.find(entry.mote);
    if (known == devices_.end() || known->second.incarnation != entry.incarnation)
      out.emplace_back(ask_about(entry.mote));
    else
      refresh(entry.mote, out);
  }
  if (roster_pages_seen_ < x.pages)
    return out;
  for (const auto& [mote, listed] : devices_) {
    const bool may_rejoin = listed.stale && now < rejoin_until_;
    if (!roster_seen_.contains(mote) && !may_rejoin && !listed.plain)
      out.emplace_back(ask_about(mote));
  }
  roster_number_.reset();
  return out;
}

outputs gateway::on_event(const network::describe&, instant) {
  ++counters_.unknown_type; // a question only gateways ask
  return {};
}

/// Its motes are there as before, but it will know so only when they have joined again.
outputs gateway::on_event(const network::sink_started&, instant now) {
  outputs out;
  rejoin_until_ = now + config_.rejoin_wait;
  make_stale(out);
  return out;
}

outputs gateway::on_clock(duration offset, instant now) {
  clock_offset_ = offset;
  return take(pc_.on_clock(offset, now));
}

/// Without an answer a sink goes on with what it knows, which is better than a time that others are
/// about to correct.
outputs gateway::on_event(const network::time_request& x, instant now) {
  if (!clock_offset_ || now < clock_valid_from_)
    return {};
  const auto time =
      std::chrono::floor<std::chrono::microseconds>(now.time_since_epoch() + *clock_offset_);
  return {answer_sink{network::time_answer{x.number, time}}};
}

outputs gateway::on_event(const network::gateway_poll& x, instant now) {
  if (lead_.alone()) {
    ++counters_.unknown_type;
    return {};
  }
  const auto change = lead_.on_poll(x, now);
  outputs out{answer_sink{lead_.answer()}};
  change_lead(change, out);
  return out;
}

outputs gateway::on_event(const network::gateway_answer&, instant) {
  ++counters_.unknown_type;
  return {};
}

outputs gateway::on_event(const network::time_answer&, instant) {
  ++counters_.unknown_type; // only gateways answer
  return {};
}

} // namespace rubicon::gateway
