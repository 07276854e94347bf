#include "gateway/plain_motes.hpp"

#include <algorithm>

#include "core/codec.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "network/sink_event.hpp"
#include "transport/segment.hpp"

namespace rubicon::gateway {

namespace {

sink_packet event_of(mote_id mote, const network::sink_event& x) {
  return {mote, network::am::sink_event, encode(x)};
}

/// Nobody waits for an answer to it.
sink_packet message_of(mote_id mote, std::uint8_t channel, byte_view payload) {
  transport::segment x;
  x.source = mote;
  x.am_type = channel;
  x.payload = to_bytes(payload);
  return {mote, network::am::to_gateway,
          encode(network::island_packet{own_island, no_mote, channel, encode(x)})};
}

/// Of Oscilloscope (tinyos.md names its AM type only; the layout is the program's own): version of
/// the settings, interval, address, count, ten readings, 2 octets each.
constexpr std::size_t oscilloscope_rest = 2 + 2 + 10 * 2;

/// The 2 octets that all forms but one take; nothing: they are not 2.
std::optional<std::uint16_t> number_in_octets(byte_view x) {
  byte_reader in(x);
  const auto number = in.big<std::uint16_t>();
  return in.ok() && in.remaining() == 0 ? std::optional(number) : std::nullopt;
}

} // namespace

std::optional<std::vector<sink_packet>> plain_motes::on_packet(mote_id source, std::uint8_t am_type,
                                                               byte_view payload, instant now) {
  const auto* rule = rule_for(source, am_type);
  if (rule == nullptr)
    return {};
  std::vector<sink_packet> out;
  if (members_.size() == motes_max && !members_.contains(source))
    return out;
  auto& x = members_[source];
  x.heard = now;
  if (rule->input_form == plain_form::oscilloscope)
    x.version = std::max(x.version, byte_reader(payload).big<std::uint16_t>());
  if (!x.listed) {
    x.listed = true;
    out.push_back(event_of(source, network::mote_joined{source, ++x.lives, rule->type, {}}));
  }
  out.push_back(message_of(source, rule->channel, payload));
  return out;
}

std::optional<plain_packet> plain_motes::on_input(mote_id mote, std::uint16_t channel,
                                                  byte_view octets) {
  const auto* rule = input_rule_for(mote, channel);
  if (rule == nullptr)
    return {};
  plain_packet out{rule->input_am_type, {}};
  const auto number = number_in_octets(octets);
  byte_writer payload;
  switch (rule->input_form) {
  case plain_form::octets:
    out.payload = to_bytes(octets);
    return out;
  case plain_form::count:
    break;
  case plain_form::blink:
    payload.big(std::uint16_t{0});
    break;
  case plain_form::oscilloscope: {
    // A mote takes settings of a newer version only, and a count above its own.
    const auto known = members_.find(mote);
    if (!number || known == members_.end() || known->second.version == UINT16_MAX)
      return {};
    payload.big(++known->second.version);
    break;
  }
  }
  if (!number)
    return {};
  payload.big(*number);
  if (rule->input_form == plain_form::oscilloscope)
    payload.append(bytes(oscilloscope_rest));
  out.payload = payload.finish();
  return out;
}

/// Whoever was there when the line was lost has its time anew.
void plain_motes::on_line(bool there, instant now) {
  if (std::exchange(there_, there) == there || !there)
    return;
  for (auto& [mote, x] : members_)
    x.heard = now;
}

std::vector<sink_packet> plain_motes::on_time(instant now) {
  std::vector<sink_packet> out;
  if (!there_)
    return out;
  for (auto& [mote, x] : members_) {
    if (!x.listed || x.heard + config_.keep_alive > now)
      continue;
    x.listed = false;
    out.push_back(event_of(mote, network::mote_left{mote, network::leave_cause::silence}));
  }
  return out;
}

std::optional<instant> plain_motes::deadline() const {
  std::optional<instant> due;
  if (!there_)
    return due;
  for (const auto& [mote, x] : members_)
    if (x.listed)
      due = earliest(due, std::optional(x.heard + config_.keep_alive));
  return due;
}

const plain_rule* plain_motes::rule_for(mote_id source, std::uint8_t am_type) const {
  const auto found = std::ranges::find_if(config_.rules, [&](const plain_rule& x) {
    return x.am_type == am_type && x.first <= source.value && source.value <= x.last;
  });
  return found == config_.rules.end() ? nullptr : &*found;
}

const plain_rule* plain_motes::input_rule_for(mote_id mote, std::uint16_t channel) const {
  const auto found = std::ranges::find_if(config_.rules, [&](const plain_rule& x) {
    return x.input != 0 && x.input == channel && x.first <= mote.value && mote.value <= x.last;
  });
  return found == config_.rules.end() ? nullptr : &*found;
}

} // namespace rubicon::gateway
