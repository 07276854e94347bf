#include "gateway/gateway.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/device_keys.hpp"
#include "gateway/strict.hpp"
#include "network/am.hpp"
#include "network/wire.hpp"
#include "transport/segment.hpp"

namespace rubicon::gateway {

namespace {

constexpr std::size_t assemblies_max = 64; ///< long packets that come up at the same time

publish text_tuple(std::string key, std::string_view text) {
  return {std::move(key), to_bytes(text), true};
}

std::string line_text(std::string_view state, instant since) {
  return std::string(state) + ' ' + to_text(since);
}

publish presence_tuple(mote_id mote, const device_status& x) {
  return text_tuple(device_status_key(mote), to_string(x));
}

publish status_tuple(mote_id mote, std::uint16_t channel, std::uint64_t sequence,
                     input_outcome result) {
  return text_tuple(device_input_status_key(mote, channel),
                    to_string(input_status{sequence, result}));
}

/// Whether a message between islands asks for reliable transfer: its segment says so. An
/// acknowledgement goes unreliably, since a lost one is asked for again end to end.
bool wants_reliable(byte_view segment) {
  const auto decoded = transport::decode_segment(segment);
  return decoded && decoded->what == transport::segment::kind::reliable;
}

endpoint::pc_config pc_of(const gateway_config& config) {
  endpoint::pc_config x;
  x.self = gateway_of(config.island);
  x.incarnation = config.incarnation;
  x.sends_max = config.inputs_outstanding_max;
  return x;
}

} // namespace

/// The program that exchanges messages between motes and tuples: keeps what it is told until the
/// gateway takes it.
class device_messages final : public mote::communication_events {
public:
  void receiveFrom(mote_address source, byte_view buf, std::uint8_t am_type) override {
    received.push_back({source, am_type, to_bytes(buf)});
  }
  void ackOf(std::uint32_t number, mote::status success) override {
    outcomes.push_back({number, success == mote::SUCCESS});
  }

  std::optional<mote::communication> layer;
  std::vector<transport::received> received;
  std::vector<transport::outcome> outcomes;
};

gateway::gateway() = default;
gateway::gateway(gateway&& x) noexcept = default;
gateway& gateway::operator=(gateway&& x) noexcept = default;
gateway::~gateway() = default;

gateway::gateway(gateway_config config, random_stream dice)
    : config_(config), pc_(pc_of(config), random_stream(dice.next())),
      messages_(std::make_unique<device_messages>()), pieces_({.packets_max = assemblies_max}),
      others_(config.others, random_stream(dice.next())) {
  messages_->layer = pc_.attach_for_rest(*messages_);
}

outputs gateway::start(instant now) {
  now_ = now;
  clock_settled_ = config_.incarnation > 0 ? now + config_.clock_settling : now;
  outputs out{device_list(), text_tuple(std::string(device_line_key), line_text("silent", now)),
              ask_about(broadcast_mote)}; // the sink may have run for long
  others_.start(now);
  requests_ = output_requests(config_.requests, config_.incarnation > 0, now);
  for (auto& x : take(pc_.start(now)))
    out.push_back(std::move(x));
  return out;
}

mote::communication gateway::attach(mote::communication_events& events) {
  return pc_.attach(events);
}

outputs gateway::on_packet(mote_id source, std::uint8_t am_type, byte_view payload, instant now) {
  now_ = now;
  outputs out;
  on_line_heard(out);
  refresh(source, out);
  outputs more;
  if (am_type == network::am::to_gateway) {
    more = on_island_packet(payload, now);
  } else if (am_type == network::am::packet) {
    if (const auto whole = pieces_.on_piece(source, payload, now))
      more = on_island_packet(*whole, now);
  } else if (am_type != network::am::sink_event) {
    ++counters_.unknown_type;
  } else if (const auto event = network::decode_sink_event(payload)) {
    more = std::visit([this, now](const auto& x) { return on_event(x, now); }, *event);
  } else {
    ++counters_.malformed;
  }
  std::ranges::move(more, std::back_inserter(out));
  return out;
}

void gateway::on_line_heard(outputs& out) {
  const auto before = std::exchange(line_heard_, now_);
  if (std::exchange(line_up_, true))
    return;
  out.emplace_back(text_tuple(std::string(device_line_key), line_text("up", now_)));
  out.emplace_back(line_changed{true, before ? now_ - *before : duration{}});
}

/// A mote was heard.
void gateway::refresh(mote_id mote, outputs& out) {
  const auto listed = devices_.find(mote);
  if (listed != devices_.end() && std::exchange(listed->second.stale, false))
    out.emplace_back(presence_tuple(mote, {device_presence::listed, {}, now_}));
}

void gateway::make_stale(outputs& out) {
  for (auto& [mote, x] : devices_) {
    if (!std::exchange(x.stale, true))
      out.emplace_back(presence_tuple(mote, {device_presence::stale, {}, now_}));
  }
}

outputs gateway::on_island_packet(byte_view payload, instant now) {
  auto packet = network::decode_island_packet(payload);
  if (!packet) {
    ++counters_.malformed;
    return {};
  }
  const bool here = packet->island == config_.island || packet->island == own_island;
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
  const auto peer = others_.gateway_for(island);
  auto said = std::optional(std::move(x));
  if (form_with(peer) == wire_form::strict54)
    said = to_strict(*std::move(said));
  if (said)
    out.emplace_back(to_gateway{peer, encode(*said), reliable});
  else
    ++counters_.unsayable;
}

outputs gateway::on_packet_for_us(const network::island_packet& x, instant now) {
  const auto decoded = transport::decode_segment(x.body);
  if (x.channel <= 0xff && decoded && !devices_.contains(decoded->source)) {
    // Its join was lost on the serial line. Unacknowledged, a reliable message will come again.
    ++counters_.undeliverable;
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
      return {};
    }
    packet = *std::move(said);
  }
  const auto island = others_.island_of(source);
  if (packet->mote == no_mote)
    return take(pc_.on_packet(island, packet->channel, packet->body, now));
  if (packet->mote != broadcast_mote && !devices_.contains(packet->mote)) {
    ++counters_.undeliverable;
    return {};
  }
  ++counters_.forwarded_in;
  outputs out;
  down({island, packet->mote, packet->channel, std::move(packet->body)}, out);
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
  const auto listed = devices_.find(mote);
  if (listed == devices_.end()) {
    ++counters_.undeliverable;
    return {status_tuple(mote, channel, sequence, input_outcome::pending),
            status_tuple(mote, channel, sequence, input_outcome::unreachable)};
  }
  listed->second.input_channels.insert(channel);
  const auto number = channel > 0xff
                          ? std::nullopt // not an AM type: reserved for streams (WIR-01)
                          : messages_->layer->send_numbered({config_.island, mote}, octets, true,
                                                            static_cast<std::uint8_t>(channel));
  outputs out{status_tuple(mote, channel, sequence, input_outcome::pending)};
  if (!number) {
    out.emplace_back(status_tuple(mote, channel, sequence, input_outcome::failed));
    return out;
  }
  pending_[*number] = {mote, channel, sequence};
  for (auto& x : settle())
    out.push_back(std::move(x));
  return out;
}

void gateway::on_period(mote_id mote, std::uint16_t channel, std::string_view text, instant now) {
  const auto period = parse_output_period(text);
  if (period && devices_.contains(mote))
    requests_.on_period(mote, channel, *period, now);
  else
    ++(period ? counters_.undeliverable : counters_.bad_periods);
}

outputs gateway::on_time(instant now) {
  now_ = now;
  auto out = take(pc_.on_time(now));
  if (line_up_ && *line_heard_ + config_.line_silence_max <= now) {
    line_up_ = false;
    out.emplace_back(text_tuple(std::string(device_line_key), line_text("silent", *line_heard_)));
    out.emplace_back(line_changed{});
    make_stale(out);
  }
  if (others_.on_time(now))
    out.emplace_back(
        announce{encode(announcement{config_.island, config_.form, config_.incarnation})});
  ask_for_outputs(out, now);
  return out;
}

std::optional<instant> gateway::deadline() const {
  auto due = earliest(pc_.deadline(), earliest(others_.deadline(), requests_.deadline()));
  if (line_up_)
    due = earliest(due, *line_heard_ + config_.line_silence_max);
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
  for (auto& x : settle())
    out.push_back(std::move(x));
}

outputs gateway::on_event(const network::mote_joined& x, instant now) {
  const auto [listed, is_new] = devices_.try_emplace(x.mote);
  const bool restarted = listed->second.incarnation != x.incarnation;
  if (restarted)
    pc_.forget_incarnation({config_.island, x.mote});
  listed->second.incarnation = x.incarnation;
  listed->second.stale = false;
  requests_.on_listed(x.mote, x.incarnation, now);
  outputs out{publish{device_type_key(x.mote), device_type_octets(x.type), false},
              publish{device_descriptor_key(x.mote), x.descriptor, false}, device_list(),
              presence_tuple(x.mote, {device_presence::listed, {}, now})};
  if (is_new || restarted) {
    out.emplace_back(member_changed{x.mote, true, x.incarnation, {}});
    for (auto& y : take(pc_.on_mote_joined(x.mote, x.descriptor, now)))
      out.push_back(std::move(y));
  }
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
    if (!roster_seen_.contains(mote) && !may_rejoin)
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

/// Without an answer a sink goes on with what it knows, which is better than a time that others are
/// about to correct.
outputs gateway::on_event(const network::time_request& x, instant now) {
  if (!clock_offset_ || now < clock_settled_)
    return {};
  const auto time =
      std::chrono::floor<std::chrono::microseconds>(now.time_since_epoch() + *clock_offset_);
  return {to_sink{broadcast_mote, network::am::sink_event,
                  network::encode(network::time_answer{x.number, time})}};
}

outputs gateway::on_event(const network::time_answer&, instant) {
  ++counters_.unknown_type; // only gateways answer
  return {};
}

outputs gateway::take(endpoint::outputs from_pc) {
  outputs out;
  for (auto& x : from_pc) {
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
    return;
  }
  ++counters_.outputs;
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
  const auto [mote, channel, sequence] = found.mapped();
  out.emplace_back(status_tuple(mote, channel, sequence,
                                x.acked ? input_outcome::acknowledged : input_outcome::failed));
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

/// Whole if it fits one serial packet, or in pieces. @param x its island is where it comes from
void gateway::down(const network::island_packet& x, outputs& out) {
  auto octets = encode(x);
  if (octets.size() <= network::frame_payload_max) {
    out.emplace_back(to_sink{x.mote, network::am::from_gateway, std::move(octets)});
    return;
  }
  const auto pieces = transport::cut(octets, network::frame_payload_max, tag_++);
  for (const auto& piece : *pieces) // packet_max octets never are too many
    out.emplace_back(to_sink{x.mote, network::am::packet, piece});
}

std::vector<mote_id> gateway::devices() const {
  std::vector<mote_id> ids;
  for (const auto& [mote, entry] : devices_)
    ids.push_back(mote);
  return ids;
}

} // namespace rubicon::gateway
