#include "gateway/gateway.hpp"

#include <utility>

#include "core/account/message_ledger.hpp"
#include "gateway/tuples.hpp"

namespace rubicon::gateway {

namespace {

/// `{20,21}`, in the order in which they take over.
std::string text_of(const std::vector<peer_id>& gateways) {
  std::string text;
  for (const auto id : gateways)
    text += (text.empty() ? "{" : ",") + to_string(id);
  return text + '}';
}

} // namespace

gateway::gateway(gateway_config config, random_stream rng)
    : config_(std::move(config)),
      lead_({config_.gateways.empty(), config_.incarnation, config_.lead_lease}),
      motes_({config_.devices_max, config_.rejoin_wait, config_.has_real_line}),
      sink_(silence_max()), inputs_(config_), plain_silence_(config_.line_silence_max) {
  random_stream first_term(rng.next());
  others_ = other_islands(config_, random_stream(rng.next()));
  pc_ = island_pc(config_, first_term, random_stream(rng.next()));
}

duration gateway::silence_max() const {
  return lead_.alone() ? config_.line_silence_max : config_.shared_silence_max;
}

occasion gateway::begun(instant now, outputs& out) {
  now_ = now;
  return {now, out, counters_};
}

outputs gateway::start(instant now) {
  outputs out;
  const auto at = begun(now, out);
  out.emplace_back(motes_.list_tuple());
  out.emplace_back(text_tuple(std::string(device_line_key), line_text("silent", now)));
  out.emplace_back(ask_about(broadcast_mote)); // the sink may have run for long
  pc_.start(now);
  others_.start(now);
  requests_ = output_requests(config_.requests, config_.incarnation > 0, now);
  if (lead_.alone()) {
    take(pc_.term().start(now), at);
  } else {
    out.emplace_back(text_tuple(std::string(device_gateways_key), text_of(config_.gateways)));
    out.emplace_back(text_tuple(std::string(device_role_key), device_role_text(false, now)));
  }
  return out;
}

outputs gateway::flush() {
  outputs out;
  take(pc_.term().flush(), begun(now_, out));
  return out;
}

outputs gateway::on_packet(mote_id source, std::uint8_t am_type, byte_view payload, instant now) {
  outputs out;
  const auto at = begun(now, out);
  on_line_input(at);
  motes_.refresh(source, at);
  dispatch(source, am_type, payload, at);
  return out;
}

outputs gateway::on_plain_packet(const sink_packet& x, instant now) {
  outputs out;
  auto at = begun(now, out);
  at.of_plain = true;
  if (!config_.has_real_line)
    on_line_input(at);
  plain_silence_.on_packet(now);
  motes_.refresh(x.source, at);
  dispatch(x.source, x.am_type, x.payload, at);
  return out;
}

outputs gateway::on_plain_done(std::uint64_t number, bool acked, instant now) {
  outputs out;
  const bool is_sent = acked && !(config_.is_forwarded && plain_silence_.is_silent(now));
  inputs_.on_plain_done(number, is_sent, begun(now, out));
  return out;
}

outputs gateway::on_plain_line_lost(instant now) {
  outputs out;
  motes_.make_plain_stale(begun(now, out));
  return out;
}

outputs gateway::on_message(peer_id source, std::uint16_t port, byte_view octets, instant now) {
  outputs out;
  if (port == announcement_port) {
    others_.gateways().on_announcement(source, octets, now);
    return out;
  }
  const auto at = begun(now, out);
  if (port == relay_port)
    on_relay(source, octets, at);
  else if (auto x = others_.on_message(source, octets, at); !x)
    return out;
  else if (lead_.leads())
    accept(x->source, std::move(x->packet), at);
  else
    pass_on(x->source, std::move(x->packet), at);
  return out;
}

/// A message for this island, or for its PC.
void gateway::accept(island_id source, network::gateway_packet x, const occasion& at) {
  if (x.mote == no_mote) {
    take(pc_.term().on_packet(source, x.channel, x.body, at.now), at);
  } else if (x.mote != broadcast_mote && (!motes_.is_listed(x.mote) || motes_.is_plain(x.mote))) {
    ++counters_.undeliverable;
    note_loss(loss::not_listed);
  } else {
    ++counters_.forwarded_in;
    send({source, x.mote, x.channel, std::move(x.body)}, at);
  }
}

outputs gateway::on_input(mote_id mote, std::uint16_t channel, byte_view octets, instant now) {
  outputs out;
  begin(now);
  const auto at = begun(now, out);
  const auto what = inputs_.begin(mote, channel, at);
  if (!what)
    return out;
  if (!motes_.is_listed(mote)) {
    ++counters_.undeliverable;
    inputs_.report(*what, input_outcome::unreachable, at);
    return out;
  }
  motes_.note_input(mote, channel);
  if (motes_.is_plain(mote))
    inputs_.send_to_plain(*what, octets, at);
  else if (lead_.leads())
    submit(*what, octets, at);
  else
    inputs_.pass_on(*what, others_.gateways().leader_of(config_.island), octets, at);
  return out;
}

void gateway::submit(const pending_input& x, byte_view octets, const occasion& at) {
  const auto number = x.channel > 0xff
                          ? std::nullopt // not an AM type: reserved for streams (WIR-01)
                          : pc_.send(x.mote, octets, static_cast<std::uint8_t>(x.channel));
  if (!number) {
    inputs_.report(x, input_outcome::failed, at);
    return;
  }
  inputs_.sent(*number, x);
  take(pc_.term().flush(), at);
}

void gateway::on_period(mote_id mote, std::uint16_t channel, std::string_view text, instant now) {
  const auto period = parse_output_period(text);
  if (period && motes_.is_listed(mote) && !motes_.is_plain(mote))
    requests_.on_period(mote, channel, *period, now);
  else
    ++(period ? counters_.undeliverable : counters_.bad_periods);
}

outputs gateway::on_clock(duration offset, instant now) {
  outputs out;
  take(pc_.on_clock(offset, now), begun(now, out));
  return out;
}

outputs gateway::on_time(instant now) {
  outputs out;
  const auto at = begun(now, out);
  change_lead(lead_.on_time(now), at);
  if (lead_.leads())
    take(pc_.term().on_time(now), at);
  inputs_.on_time(at);
  if (sink_.on_time(at)) {
    pc_.term().set_line(false);
    motes_.make_stale(at);
  }
  if (others_.gateways().on_time(now))
    out.emplace_back(announce{
        encode(announcement{config_.island, config_.form, config_.incarnation,
                            lead_.alone() ? std::nullopt : std::optional(lead_.leads())})});
  if (lead_.leads())
    request_outputs(at);
  return out;
}

std::optional<instant> gateway::deadline() const {
  auto due = earliest(others().deadline(), lead_.deadline());
  if (lead_.leads())
    due = earliest(due, earliest(pc_.deadline(), requests_.deadline()));
  return earliest(due, earliest(sink_.deadline(), inputs_.deadline()));
}

void gateway::request_outputs(const occasion& at) {
  begin(at.now);
  for (const auto& [mote, wanted] : requests_.due(at.now)) {
    ++counters_.requests;
    if (const auto number = pc_.send(mote, encode(wanted), network::am::outputs_wanted)) {
      requested_[*number] = mote;
    } else {
      ++counters_.requests_failed;
      requests_.on_outcome(mote, false, at.now);
    }
  }
  take(pc_.term().flush(), at);
}

void gateway::take(communication::outputs from_pc, const occasion& at) {
  for (auto& x : from_pc) {
    const acting_on its(x.from);
    const auto [island, mote] = x.destination;
    if (island == config_.island)
      send({island, mote, x.channel, std::move(x.segment)}, at);
    else
      others_.send(island, {mote, x.channel, std::move(x.segment)}, false, at);
  }
  for (const auto& x : pc_.take_received())
    publish_output(x, at);
  for (const auto& x : pc_.take_outcomes()) {
    if (const auto request = requested_.extract(x.id); !request.empty()) {
      counters_.requests_failed += x.acked ? 0 : 1;
      requests_.on_outcome(request.mapped(), x.acked, at.now);
    } else {
      inputs_.on_outcome(x, at);
    }
  }
}

void gateway::publish_output(const transport::received& x, const occasion& at) {
  if (x.source.island != config_.island || !motes_.is_listed(x.source.mote)) {
    ++counters_.undeliverable;
    note_loss(loss::not_listed);
    return;
  }
  ++counters_.outputs_published;
  note_arrival(message_kind::message, x.source);
  motes_.note_output(x.source.mote, x.am_type);
  at.out.emplace_back(publish{device_output_key(x.source.mote, x.am_type), x.payload, false});
}

/// @param x its island is where it comes from
void gateway::send(const network::island_packet& x, const occasion& at) {
  if (motes_.is_plain(x.mote)) {
    ++counters_.undeliverable;
    note_loss(loss::no_program);
    return;
  }
  sink_.send(x, at);
}

} // namespace rubicon::gateway
