// One gateway among several of its island: when it leads, and what it passes on to who does
// (GW-14).
#include <algorithm>
#include <iterator>
#include <utility>

#include "core/account/message_ledger.hpp"

#include "gateway/gateway_parts.hpp"

namespace rubicon::gateway {

namespace {

void add(transport::messenger_counters& to, const transport::messenger_counters& x) {
  to.reliable_sent += x.reliable_sent;
  to.reliable_acked += x.reliable_acked;
  to.reliable_failed += x.reliable_failed;
  to.unreliable_sent += x.unreliable_sent;
  to.failed_unanswered += x.failed_unanswered;
  to.failed_refused += x.failed_refused;
  to.failed_left += x.failed_left;
  to.refused += x.refused;
  to.refused_crowded += x.refused_crowded;
  to.retries += x.retries;
  to.hellos += x.hellos;
  to.received += x.received;
  to.duplicates += x.duplicates;
  to.throttled += x.throttled;
  to.strangers += x.strangers;
  to.malformed += x.malformed;
  to.stray_answers += x.stray_answers;
}

/// `{20,21}`, in the order in which they take over.
std::string text_of(const std::vector<peer_id>& gateways) {
  std::string text;
  for (const auto id : gateways)
    text += (text.empty() ? "{" : ",") + to_string(id);
  return text + '}';
}

} // namespace

bool gateway::is_here(island_id x) const {
  return x == config_.island || x == own_island ||
         std::ranges::find(config_.gateways, gateway_of(x)) != config_.gateways.end();
}

duration gateway::silence_max() const {
  return lead_.alone() ? config_.line_silence_max : config_.shared_silence_max;
}

transport::messenger_counters gateway::messages() const {
  auto sum = above().messages().counters();
  add(sum, earlier_terms_);
  return sum;
}

communication::layer_counters gateway::offers() const {
  auto sum = above().counters();
  sum.offered += earlier_offers_.offered;
  sum.unjoined += earlier_offers_.unjoined;
  sum.misaddressed += earlier_offers_.misaddressed;
  return sum;
}

void gateway::start_sharing(outputs& out) {
  out.emplace_back(text_tuple(std::string(device_gateways_key), text_of(config_.gateways)));
  out.emplace_back(text_tuple(std::string(device_role_key), device_role_text(false, now_)));
}

void gateway::change_lead(leadership::change x, outputs& out) {
  if (x == leadership::change::none)
    return;
  end_work(out);
  if (x == leadership::change::taken)
    take_lead(out);
  out.emplace_back(text_tuple(std::string(device_role_key), device_role_text(lead_.leads(), now_)));
  out.emplace_back(lead_changed{lead_.leads(), lead_.term()});
  others_.announce_soon(now_);
}

/// It is the PC of the island from here on, as one that has just been started.
void gateway::take_lead(outputs& out) {
  add(earlier_terms_, above().messages().counters());
  earlier_terms_.reliable_failed += outstanding(); // nobody waits for their answers any more
  earlier_terms_.failed_left += outstanding();
  earlier_offers_.offered += above().counters().offered;
  earlier_offers_.unjoined += above().counters().unjoined;
  earlier_offers_.misaddressed += above().counters().misaddressed;
  messages_->layer.reset();
  const stopping its_messages;
  pc_ = communication::pc(pc_of(config_, lead_.term()), random_stream(rng_.next()));
  pc_.observe(observer_);
  pc_.set_line(line_up_);
  messages_->layer = pc_.attach_for_rest(*messages_);
  requests_.forget_confirmed(now_);
  std::ranges::move(take(pc_.start(now_)), std::back_inserter(out));
}

/// Whoever leads next may have the answers to what was in flight, and does not know the questions.
void gateway::end_work(outputs& out) {
  for (const auto& [number, x] : std::exchange(pending_, {}))
    report_outcome(x, input_outcome::failed, out);
  for (const auto& [number, x] : std::exchange(waiting_, {}))
    report_outcome(x.what, input_outcome::failed, out);
  asked_.clear();
  messages_->received.clear();
  messages_->outcomes.clear();
  for (auto& [mote, x] : devices_) { // the newest ones are another gateway's
    for (const auto channel : std::exchange(x.output_channels, {}))
      out.emplace_back(erase{device_output_key(mote, channel)});
  }
}

void gateway::report_outcome(const pending_input& x, input_outcome outcome, outputs& out) const {
  if (x.asker)
    out.emplace_back(relay_to{
        *x.asker, encode(relay(relayed_outcome{static_cast<std::uint32_t>(x.sequence), outcome}))});
  else
    out.emplace_back(status_tuple(x.mote, x.channel, x.sequence, outcome));
}

void gateway::pass_on(const pending_input& x, byte_view octets, outputs& out) {
  const auto leader = others_.leader_of(config_.island);
  if (!leader) {
    report_outcome(x, input_outcome::unreachable, out);
    return;
  }
  if (octets.size() > network::body_max || waiting_.size() >= config_.inputs_outstanding_max) {
    report_outcome(x, input_outcome::failed, out);
    return;
  }
  ++counters_.relayed_out;
  const auto slack = slack_of(config_.slacks, {config_.island, x.mote}).there_and_back;
  const auto longest = config_.relay_wait + 2 * transport::messenger_config::attempts_max * slack;
  waiting_[++relay_number_] = {x, now_ + longest};
  out.emplace_back(relay_to{
      *leader, encode(relay(relayed_input{relay_number_, x.mote, x.channel, to_bytes(octets)}))});
}

outputs gateway::pass_on(island_id source, network::gateway_packet x) {
  const auto leader = others_.leader_of(config_.island);
  if (!leader) {
    ++counters_.undeliverable;
    note_loss(loss::not_leading);
    return {};
  }
  ++counters_.relayed_out;
  return {relay_to{*leader, encode(relay(relayed_message{source, std::move(x)}))}};
}

void gateway::fail_waiting(instant now, outputs& out) {
  for (auto x = waiting_.begin(); x != waiting_.end();) {
    if (x->second.expires > now) {
      ++x;
      continue;
    }
    report_outcome(x->second.what, input_outcome::failed, out);
    x = waiting_.erase(x);
  }
}

outputs gateway::on_relay(peer_id source, byte_view octets, instant now) {
  begin(now);
  auto x = decode_relay(octets);
  const bool is_one_of_us = std::ranges::find(config_.gateways, source) != config_.gateways.end();
  if (!x || !is_one_of_us) {
    ++counters_.malformed;
    return {};
  }
  return std::visit([this, source](auto& y) { return on_relayed(source, std::move(y)); }, *x);
}

/// Not passed on again: two that hold each other for the leader would not end.
outputs gateway::on_relayed(peer_id, relayed_message x) {
  if (!lead_.leads()) {
    ++counters_.undeliverable;
    note_loss(loss::not_leading);
    return {};
  }
  ++counters_.relayed_in;
  return accept(x.source, std::move(x.packet));
}

outputs gateway::on_relayed(peer_id source, relayed_input x) {
  outputs out;
  const pending_input what{x.mote, x.channel, x.number, source};
  if (!lead_.leads() || !devices_.contains(x.mote)) {
    ++counters_.undeliverable;
    report_outcome(what, input_outcome::unreachable, out);
    return out;
  }
  ++counters_.relayed_in;
  submit(what, x.octets, out);
  return out;
}

outputs gateway::on_relayed(peer_id, const relayed_outcome& x) {
  outputs out;
  if (const auto found = waiting_.extract(x.number); !found.empty())
    report_outcome(found.mapped().what, x.outcome, out);
  return out;
}

} // namespace rubicon::gateway
