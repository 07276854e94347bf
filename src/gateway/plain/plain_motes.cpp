#include "gateway/plain/plain_motes.hpp"

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

/// What follows version and interval of the settings in packets of Oscilloscope and MViz
/// (docs/tinyos.md 4.4), 2 octets each: address, count, ten
/// readings; address, count, a reading, ETX, quality of the link, parent.
constexpr std::size_t oscilloscope_rest = 2 + 2 + 10 * 2;
constexpr std::size_t mviz_rest = 6 * 2;

bool has_settings(plain_form x) {
  return x == plain_form::oscilloscope || x == plain_form::mviz;
}

/// The 2 octets that all forms but one take; nothing: they are not 2.
std::optional<std::uint16_t> number_in_octets(byte_view x) {
  byte_reader in(x);
  const auto number = in.big<std::uint16_t>();
  return in.ok() && in.remaining() == 0 ? std::optional(number) : std::nullopt;
}

/// @returns nothing if the payload ends before the address, or it is no mote's
std::optional<mote_id> address_by(const plain_rule& rule, mote_id source, byte_view payload) {
  if (!rule.id_offset)
    return source;
  byte_reader in(payload.subspan(std::min<std::size_t>(*rule.id_offset, payload.size())));
  const mote_id found(in.big<std::uint16_t>());
  return in.ok() && found.value <= mote_id_max ? std::optional(found) : std::nullopt;
}

bool has_pattern(const plain_rule& rule, byte_view payload) {
  const std::size_t end = rule.pattern_offset + rule.pattern.size();
  return rule.pattern.empty() ||
         (payload.size() >= end &&
          std::ranges::equal(payload.subspan(rule.pattern_offset, rule.pattern.size()),
                             rule.pattern));
}

} // namespace

std::optional<std::vector<sink_packet>> plain_motes::on_packet(mote_id source,
                                                               std::optional<std::uint8_t> am_type,
                                                               byte_view payload, instant now) {
  const auto [mote, rule] = sender_of(source, am_type, payload);
  if (rule == nullptr)
    return {};
  std::vector<sink_packet> out;
  if (members_.size() == motes_max && !members_.contains(mote))
    return out;
  auto& x = members_[mote];
  x.last_received = now;
  if (has_settings(rule->input_form))
    x.version = std::max(x.version, byte_reader(payload).big<std::uint16_t>());
  if (!x.listed) {
    x.listed = true;
    out.push_back(event_of(mote, network::mote_joined{mote, ++x.lives, rule->type, {}}));
  }
  out.push_back(message_of(mote, rule->channel, payload));
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
  case plain_form::oscilloscope:
  case plain_form::mviz: {
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
  if (has_settings(rule->input_form))
    payload.append(bytes(rule->input_form == plain_form::mviz ? mviz_rest : oscilloscope_rest));
  out.payload = payload.finish();
  return out;
}

/// Motes that were listed when the line was lost get their whole keep-alive time again.
void plain_motes::on_line(bool there, instant now) {
  if (std::exchange(there_, there) == there || !there)
    return;
  for (auto& [mote, x] : members_)
    x.last_received = now;
}

std::vector<sink_packet> plain_motes::on_time(instant now) {
  std::vector<sink_packet> out;
  if (!there_)
    return out;
  for (auto& [mote, x] : members_) {
    if (!x.listed || x.last_received + config_.keep_alive > now)
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
      due = earliest(due, std::optional(x.last_received + config_.keep_alive));
  return due;
}

plain_motes::sender plain_motes::sender_of(mote_id source, std::optional<std::uint8_t> am_type,
                                           byte_view payload) const {
  std::optional<mote_id> unknown_sender;
  for (const auto& rule : config_.rules) {
    const auto mote = rule.am_type == am_type && has_pattern(rule, payload)
                          ? address_by(rule, source, payload)
                          : std::nullopt;
    if (mote && rule.first <= mote->value && mote->value <= rule.last)
      return {*mote, &rule};
    unknown_sender = unknown_sender ? unknown_sender : mote;
  }
  return {unknown_sender.value_or(source), nullptr};
}

const plain_rule* plain_motes::input_rule_for(mote_id mote, std::uint16_t channel) const {
  const auto found = std::ranges::find_if(config_.rules, [&](const plain_rule& x) {
    return x.input != 0 && x.input == channel && x.first <= mote.value && mote.value <= x.last;
  });
  return found == config_.rules.end() ? nullptr : &*found;
}

} // namespace rubicon::gateway
