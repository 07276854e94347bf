#include "gateway/gateway.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "gateway/gateway_parts.hpp"
#include "gateway/strict.hpp"
#include "network/am.hpp"
#include "network/wire.hpp"
#include "transport/segment.hpp"

namespace rubicon::gateway {

namespace {

constexpr std::size_t assemblies_max = 64; ///< long packets that come up at the same time

/// Whether a message between islands asks for reliable transfer: its segment says so. An
/// acknowledgement goes unreliably, since a lost one is asked for again end to end.
bool wants_reliable(byte_view segment) {
  const auto decoded = transport::decode_segment(segment);
  return decoded && decoded->what == transport::segment::kind::reliable;
}

} // namespace

gateway::gateway() = default;
gateway::gateway(gateway&& x) noexcept = default;
gateway& gateway::operator=(gateway&& x) noexcept = default;
gateway::~gateway() = default;

gateway::gateway(gateway_config config, random_stream rng)
    : config_(std::move(config)),
      lead_({config_.gateways.empty(), config_.incarnation, config_.lead_lease}),
      pc_(pc_of(config_, config_.incarnation), random_stream(rng.next())),
      messages_(std::make_unique<device_messages>()), fragments_({.packets_max = assemblies_max}),
      others_(config_.others, random_stream(rng.next())) {
  rng_ = random_stream(rng.next());
  pc_.set_line(false); // until the sink has sent
  messages_->layer = pc_.attach_for_rest(*messages_);
}

void gateway::observe(std::function<void(const communication::program_note&)> observer) {
  observer_ = std::move(observer);
  pc_.observe(observer_);
}

outputs gateway::start(instant now) {
  now_ = now;
  clock_valid_from_ = config_.incarnation > 0 ? now + config_.clock_wait : now;
  outputs out{device_list(), text_tuple(std::string(device_line_key), line_text("silent", now)),
              ask_about(broadcast_mote)}; // the sink may have run for long
  others_.start(now);
  requests_ = output_requests(config_.requests, config_.incarnation > 0, now);
  if (!lead_.alone()) {
    start_sharing(out);
    return out;
  }
  for (auto& x : take(pc_.start(now)))
    out.push_back(std::move(x));
  return out;
}

communication::interface gateway::attach(communication::communication_events& events) {
  return pc_.attach(events);
}

outputs gateway::on_packet(mote_id source, std::uint8_t am_type, byte_view payload, instant now) {
  now_ = now;
  outputs out;
  on_line_input(out);
  refresh(source, out);
  std::ranges::move(dispatch(source, am_type, payload, now), std::back_inserter(out));
  return out;
}

/// A packet of the sink, or what it might have said.
outputs gateway::dispatch(mote_id source, std::uint8_t am_type, byte_view payload, instant now) {
  outputs more;
  const bool is_packet = am_type == network::am::to_gateway || am_type == network::am::packet;
  if (is_packet && !lead_.leads()) { // its sender will repeat it to who does
    ++counters_.undeliverable;
    note_loss(loss::not_leading);
  } else if (am_type == network::am::to_gateway) {
    more = on_island_packet(payload, now);
  } else if (am_type == network::am::packet) {
    if (const auto whole = fragments_.on_fragment(source, payload, now))
      more = on_island_packet(*whole, now);
  } else if (am_type != network::am::sink_event) {
    ++counters_.unknown_type;
  } else if (const auto event = network::decode_sink_event(payload)) {
    has_own_sink_ = has_own_sink_ || !is_plain_said_;
    more = std::visit([this, now](const auto& x) { return on_event(x, now); }, *event);
  } else {
    ++counters_.malformed;
  }
  return more;
}

void gateway::on_line_input(outputs& out) {
  const auto before = std::exchange(last_line_input_, now_);
  if (std::exchange(line_up_, true))
    return;
  pc_.set_line(true);
  out.emplace_back(text_tuple(std::string(device_line_key), line_text("up", now_)));
  out.emplace_back(line_changed{true, before ? now_ - *before : duration{}});
}

/// A mote has sent: it is not stale.
void gateway::refresh(mote_id mote, outputs& out) {
  const auto listed = devices_.find(mote);
  if (listed != devices_.end() && std::exchange(listed->second.stale, false))
    out.emplace_back(presence_tuple(mote, {device_presence::listed, {}, now_}));
}

void gateway::make_stale(outputs& out) {
  for (auto& [mote, x] : devices_)
    if (!x.plain || !config_.has_real_line)
      make_stale(x, mote, out);
}

void gateway::make_stale(device& x, mote_id mote, outputs& out) {
  if (!std::exchange(x.stale, true))
    out.emplace_back(presence_tuple(mote, {device_presence::stale, {}, now_}));
}

outputs gateway::on_island_packet(byte_view payload, instant now) {
  auto packet = network::decode_island_packet(payload);
  if (!packet) {
    ++counters_.malformed;
    note_loss(loss::malformed);
    return {};
  }
  const bool here = is_here(packet->island);
  if (here && packet->mote == no_mote)
    return on_packet_for_us(*packet, now);
  if (here) { // a sink sends these on itself; one of another make may not
    outputs out;
    packet->island = config_.island;
    down(*packet, out);
    return out;
  }
  ++counters_.forwarded_out;
  const bool reliable = wants_reliable(packet->body);
  outputs out;
  send_out(packet->island, {packet->mote, packet->channel, std::move(packet->body)}, reliable, out);
  return out;
}

wire_form gateway::form_with(peer_id peer) const {
  return config_.form == wire_form::strict54 ? config_.form : others_.form_of(peer);
}

void gateway::send_out(island_id island, network::gateway_packet x, bool reliable, outputs& out) {
  if (const auto meant = others_.meant_by(island); meant != island)
    talks_.note(island, meant, x.mote, x.body);
  const auto peer = others_.gateway_for(island);
  auto said = std::optional(std::move(x));
  if (form_with(peer) == wire_form::strict54)
    said = to_strict(*std::move(said));
  if (said) {
    out.emplace_back(to_gateway{peer, encode(*said), reliable});
  } else {
    ++counters_.unsayable;
    note_loss(loss::not_expressible);
  }
}

outputs gateway::on_packet_for_us(const network::island_packet& x, instant now) {
  const auto decoded = transport::decode_segment(x.body);
  if (x.channel <= 0xff && decoded && !devices_.contains(decoded->source)) {
    // Its join was lost on the serial line. Unacknowledged, a reliable message will come again.
    ++counters_.undeliverable;
    note_loss(loss::not_listed);
    return {ask_about(decoded->source)};
  }
  return take(pc_.on_packet(config_.island, x.channel, x.body, now));
}

outputs gateway::on_message(peer_id source, byte_view octets, instant now) {
  now_ = now;
  auto packet = network::decode_gateway_packet(octets);
  if (!packet || source.value <= 0) {
    ++counters_.malformed;
    return {};
  }
  if (form_with(source) == wire_form::strict54) {
    auto said = from_strict(*std::move(packet), ++strict_counter_);
    if (!said) {
      ++counters_.unsayable;
      note_loss(loss::not_expressible);
      return {};
    }
    packet = *std::move(said);
  }
  const auto island = talks_.source_of(others_.island_of(source), packet->mote, packet->body);
  return lead_.leads() ? accept(island, *std::move(packet)) : pass_on(island, *std::move(packet));
}

/// A message for this island, or for its PC.
outputs gateway::accept(island_id source, network::gateway_packet x) {
  if (x.mote == no_mote)
    return take(pc_.on_packet(source, x.channel, x.body, now_));
  if (x.mote != broadcast_mote && (!devices_.contains(x.mote) || is_plain(x.mote))) {
    ++counters_.undeliverable;
    note_loss(loss::not_listed);
    return {};
  }
  ++counters_.forwarded_in;
  outputs out;
  down({source, x.mote, x.channel, std::move(x.body)}, out);
  return out;
}

outputs gateway::on_input(mote_id mote, std::uint16_t channel, byte_view octets, instant now) {
  begin(now);
  const auto counter = input_sequences_.find({mote, channel});
  if (counter == input_sequences_.end() && input_sequences_.size() >= config_.input_channels_max) {
    ++counters_.inputs_refused;
    return {};
  }
  ++counters_.inputs;
  const auto sequence = ++input_sequences_[{mote, channel}];
  const pending_input what{mote, channel, sequence};
  outputs out{status_tuple(mote, channel, sequence, input_outcome::pending)};
  const auto listed = devices_.find(mote);
  if (listed == devices_.end()) {
    ++counters_.undeliverable;
    report_outcome(what, input_outcome::unreachable, out);
    return out;
  }
  listed->second.input_channels.insert(channel);
  if (listed->second.plain) {
    ++counters_.plain_inputs;
    plain_pending_[++plain_number_] = what;
    out.emplace_back(to_plain{plain_number_, mote, channel, to_bytes(octets)});
  } else if (lead_.leads())
    submit(what, octets, out);
  else
    pass_on(what, octets, out);
  return out;
}

void gateway::submit(const pending_input& x, byte_view octets, outputs& out) {
  const auto number = x.channel > 0xff
                          ? std::nullopt // not an AM type: reserved for streams (WIR-01)
                          : messages_->layer->send_numbered({config_.island, x.mote}, octets, true,
                                                            static_cast<std::uint8_t>(x.channel));
  if (!number) {
    report_outcome(x, input_outcome::failed, out);
    return;
  }
  pending_[*number] = x;
  for (auto& each : flush())
    out.push_back(std::move(each));
}

void gateway::on_period(mote_id mote, std::uint16_t channel, std::string_view text, instant now) {
  const auto period = parse_output_period(text);
  if (period && devices_.contains(mote) && !is_plain(mote))
    requests_.on_period(mote, channel, *period, now);
  else
    ++(period ? counters_.undeliverable : counters_.bad_periods);
}

outputs gateway::on_time(instant now) {
  now_ = now;
  outputs out;
  change_lead(lead_.on_time(now), out);
  if (lead_.leads())
    std::ranges::move(take(pc_.on_time(now)), std::back_inserter(out));
  fail_waiting(now, out);
  if (line_up_ && *last_line_input_ + silence_max() <= now) {
    line_up_ = false;
    pc_.set_line(false);
    out.emplace_back(
        text_tuple(std::string(device_line_key), line_text("silent", *last_line_input_)));
    out.emplace_back(line_changed{});
    make_stale(out);
  }
  if (others_.on_time(now))
    out.emplace_back(announce{
        encode(announcement{config_.island, config_.form, config_.incarnation,
                            lead_.alone() ? std::nullopt : std::optional(lead_.leads())})});
  if (lead_.leads())
    ask_for_outputs(out, now);
  return out;
}

std::optional<instant> gateway::deadline() const {
  auto due = earliest(others_.deadline(), lead_.deadline());
  if (lead_.leads())
    due = earliest(due, earliest(pc_.deadline(), requests_.deadline()));
  if (line_up_)
    due = earliest(due, *last_line_input_ + silence_max());
  for (const auto& [number, x] : waiting_)
    due = earliest(due, x.expires);
  return due;
}

void gateway::ask_for_outputs(outputs& out, instant now) {
  begin(now);
  for (const auto& [mote, wanted] : requests_.due(now)) {
    ++counters_.requests;
    const auto number = messages_->layer->send_numbered({config_.island, mote}, encode(wanted),
                                                        true, network::am::outputs_wanted);
    if (number) {
      asked_[*number] = mote;
    } else {
      ++counters_.requests_failed;
      requests_.on_outcome(mote, false, now);
    }
  }
  for (auto& x : flush())
    out.push_back(std::move(x));
}

outputs gateway::take(communication::outputs from_pc) {
  outputs out;
  for (auto& x : from_pc) {
    const acting_on its(x.from);
    const auto [island, mote] = x.destination;
    if (island == config_.island) {
      down({island, mote, x.channel, std::move(x.segment)}, out);
    } else {
      send_out(island, {mote, x.channel, std::move(x.segment)}, false, out);
    }
  }
  for (const auto& x : std::exchange(messages_->received, {}))
    publish_output(x, out);
  for (const auto& x : std::exchange(messages_->outcomes, {}))
    publish_outcome(x, out);
  return out;
}

void gateway::publish_output(const transport::received& x, outputs& out) {
  const auto listed = devices_.find(x.source.mote);
  if (x.source.island != config_.island || listed == devices_.end()) {
    ++counters_.undeliverable;
    note_loss(loss::not_listed);
    return;
  }
  ++counters_.outputs_published;
  note_arrival(message_kind::message, x.source);
  listed->second.output_channels.insert(x.am_type);
  out.emplace_back(publish{device_output_key(x.source.mote, x.am_type), x.payload, false});
}

void gateway::publish_outcome(const transport::outcome& x, outputs& out) {
  if (const auto asked = asked_.extract(x.id); !asked.empty()) {
    counters_.requests_failed += x.acked ? 0 : 1;
    requests_.on_outcome(asked.mapped(), x.acked, now_);
    return;
  }
  const auto found = pending_.extract(x.id);
  if (found.empty())
    return;
  report_outcome(found.mapped(), x.acked ? input_outcome::acknowledged : input_outcome::failed,
                 out);
}

outputs gateway::remove(mote_id mote, network::leave_cause cause) {
  const auto found = devices_.find(mote);
  if (found == devices_.end())
    return {};
  const auto entry = std::move(found->second);
  devices_.erase(found);
  requests_.on_unlisted(mote);
  outputs out{presence_tuple(mote, {device_presence::left, network::to_string(cause), now_}),
              device_list(), erase{device_type_key(mote)}, erase{device_descriptor_key(mote)}};
  for (const auto channel : entry.output_channels)
    out.emplace_back(erase{device_output_key(mote, channel)});
  for (const auto channel : entry.input_channels)
    out.emplace_back(erase{device_input_status_key(mote, channel)});
  out.emplace_back(member_changed{mote, false, entry.incarnation, cause});
  return out;
}

publish gateway::device_list() const {
  return text_tuple(std::string(devices_key), device_list_text(devices()));
}

to_sink gateway::ask_about(mote_id mote) {
  return {mote, network::am::sink_event, network::encode(network::describe{mote})};
}

/// Whole if it fits one serial packet, or in fragments. @param x its island is where it comes from
void gateway::down(const network::island_packet& x, outputs& out) {
  if (is_plain(x.mote)) {
    ++counters_.undeliverable;
    note_loss(loss::no_program);
    return;
  }
  auto octets = encode(x);
  if (octets.size() <= network::frame_payload_max) {
    out.emplace_back(to_sink{x.mote, network::am::from_gateway, std::move(octets)});
    return;
  }
  const auto fragments = transport::cut(octets, network::frame_payload_max, tag_++);
  for (const auto& fragment : *fragments) // packet_max octets never are too many
    out.emplace_back(to_sink{x.mote, network::am::packet, fragment});
}

std::vector<mote_id> gateway::devices() const {
  std::vector<mote_id> ids;
  for (const auto& [mote, entry] : devices_)
    ids.push_back(mote);
  return ids;
}

} // namespace rubicon::gateway
