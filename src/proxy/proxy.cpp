#include "proxy/proxy.hpp"

#include <algorithm>
#include <set>

namespace rubicon::proxy {

namespace {

/// Longest unknown word that an outcome tuple repeats; anybody may write anything to an input.
constexpr std::size_t shown_word_max = 64;

std::string shown(std::string_view word, request_outcome outcome) {
  if (outcome != request_outcome::refused)
    return std::string(word);
  const bool plain =
      word.size() <= shown_word_max &&
      std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c <= '~'; });
  return plain ? std::string(word) : "?";
}

std::string words_of(const input& x) {
  std::string text;
  for (const auto& [word, octets] : x.words) {
    if (!text.empty())
      text += ' ';
    text += word;
  }
  return text;
}

} // namespace

std::string_view to_string(proxy::state x) {
  switch (x) {
  case proxy::state::active:
    return "active";
  case proxy::state::inactive:
    return "inactive";
  case proxy::state::stale:
    return "stale";
  case proxy::state::lost:
    return "lost";
  }
  return "unknown";
}

proxy::proxy(proxy_class what, proxy_identity who, proxy_settings settings)
    : class_(std::move(what)), who_(std::move(who)), settings_(settings),
      prefix_(key_prefix(class_.prefix, who_)) {
  for (const auto& input : class_.inputs)
    channels_.try_emplace(input.channel, settings_.answer_timeout);
}

proxy::outputs proxy::start(instant now) {
  outputs out;
  last_sensed_ = now;
  say_prior_information(out);
  say_state(now, out);
  return out;
}

std::vector<watch> proxy::watches() const {
  std::vector<watch> list;
  std::set<std::uint16_t> output_channels;
  for (const auto& input : class_.inputs) {
    if (input.meta)
      list.push_back({watch::source::meta, key_of("mi-" + input.name), input.name});
    else
      list.push_back({watch::source::own, key_of(input.name), input.name});
  }
  for (const auto& field : class_.fields)
    output_channels.insert(field.channel);
  for (const auto channel : output_channels)
    list.push_back({watch::source::gateway, device_output_key(who_.mote.mote, channel), {}});
  for (const auto& [channel, requests] : channels_)
    list.push_back({watch::source::gateway, device_input_status_key(who_.mote.mote, channel), {}});
  return list;
}

bool proxy::consumes(const signature& percept) const {
  return percept.channel == wsn_channel && percept.hardware_id == proxy_id(who_.mote);
}

proxy::outputs proxy::on_gateway_tuple(std::string_view key, byte_view value, instant now) {
  const auto parsed = parse_device_key(key);
  if (parsed && parsed->mote == who_.mote.mote) {
    if (parsed->what == device_tuple::output)
      return on_output(parsed->channel, value, now);
    if (parsed->what == device_tuple::input_status)
      return on_input_status(parsed->channel, tuple_text(value), now);
  }
  ++counters_.foreign_tuples;
  return {};
}

proxy::outputs proxy::on_output(std::uint16_t channel, byte_view payload, instant now) {
  outputs out;
  sensed(now, out);
  if (!reads_channel(class_, channel)) {
    ++counters_.unread_messages;
    return out;
  }
  auto readings = decode(class_, channel, payload);
  if (!readings) {
    ++counters_.short_messages;
    return out;
  }
  ++counters_.messages;
  for (auto& x : *readings) {
    say(key_of(x.name), x.text, out);
    newest_.insert_or_assign(x.name, std::move(x));
  }
  return out;
}

proxy::outputs proxy::on_input_status(std::uint16_t channel, std::string_view text, instant now) {
  outputs out;
  const auto found = channels_.find(channel);
  if (found == channels_.end()) {
    ++counters_.foreign_tuples;
    return out;
  }
  const auto status = parse_input_status(text);
  if (!status) {
    ++counters_.bad_statuses;
    return out;
  }
  if (status->outcome == input_outcome::acknowledged)
    sensed(now, out);
  apply(channel, found->second.on_status(*status, now), out);
  return out;
}

proxy::outputs proxy::on_input(std::string_view name, std::string_view text, instant now) {
  outputs out;
  const auto found = std::find_if(class_.inputs.begin(), class_.inputs.end(),
                                  [&](const auto& x) { return x.name == name; });
  if (found == class_.inputs.end()) {
    ++counters_.foreign_tuples;
    return out;
  }
  const auto index = static_cast<std::size_t>(found - class_.inputs.begin());
  auto octets = encode(*found, text);
  if (!octets && (text.empty() || text == nothing_word))
    return out;
  ++counters_.requested;
  if (!octets)
    tell(index, text, request_outcome::refused, out);
  else if (state_ == state::lost)
    tell(index, text, request_outcome::unreachable, out);
  else
    apply(found->channel,
          channels_.at(found->channel).add({index, std::string(text), *std::move(octets)}, now),
          out);
  return out;
}

proxy::outputs proxy::on_presence(device_presence x, std::string_view cause, instant now) {
  outputs out;
  if (x == device_presence::left) {
    if (state_ != state::lost)
      lost_since_ = now;
    const bool is_news = state_ == state::lost && cause_ != cause;
    cause_ = cause;
    enter(state::lost, now, out);
    if (is_news)
      say(key_of("status.cause"), cause_, out);
    for (auto& [channel, requests] : channels_)
      apply(channel, requests.drop_waiting(now), out);
    return out;
  }
  last_sensed_ = now;
  retired_ = false;
  cause_ = nothing_word;
  enter(x == device_presence::stale ? state::stale : state::active, now, out);
  return out;
}

proxy::outputs proxy::on_gateway_changed(instant now) {
  outputs out;
  for (auto& [channel, requests] : channels_)
    apply(channel, requests.on_gateway_changed(now), out);
  return out;
}

proxy::outputs proxy::on_time(instant now) {
  outputs out;
  for (auto& [channel, requests] : channels_)
    apply(channel, requests.on_time(now), out);
  const auto due = presence_deadline();
  if (due && now >= *due) {
    if (state_ == state::lost) {
      retired_ = true;
      out.emplace_back(retire{});
    } else {
      enter(state::inactive, now, out);
    }
  }
  return out;
}

std::optional<instant> proxy::deadline() const {
  auto due = presence_deadline();
  for (const auto& [channel, requests] : channels_)
    due = earliest(due, requests.deadline());
  return due;
}

std::size_t proxy::open_requests() const {
  std::size_t open = 0;
  for (const auto& [channel, requests] : channels_)
    open += requests.open();
  return open;
}

std::vector<std::pair<std::string, std::string>> proxy::values() const {
  std::vector<std::pair<std::string, std::string>> list;
  for (const auto& [name, x] : newest_)
    list.emplace_back(name, x.unit.empty() ? x.text : x.text + ' ' + x.unit);
  return list;
}

std::string proxy::key_of(std::string_view suffix) const {
  return prefix_ + '.' + key_parts(suffix);
}

void proxy::say(std::string key, std::string text, outputs& out) {
  if (fits_tuple_key(key))
    out.emplace_back(publish{std::move(key), std::move(text)});
  else
    ++counters_.bad_keys;
}

void proxy::say_prior_information(outputs& out) {
  say(key_of("class"), class_.name, out);
  say(key_of("id"), proxy_id(who_.mote), out);
  say(key_of("island"), who_.island_name.empty() ? to_string(who_.mote.island) : who_.island_name,
      out);
  for (const auto& [name, text] : class_.properties)
    say(key_of(name), text, out);
  for (const auto& field : class_.fields)
    if (!field.unit.empty())
      say(key_of(field.name + ".unit"), field.unit, out);
  for (const auto& input : class_.inputs) {
    say(key_of(input.name + ".words"), words_of(input), out);
    say(key_of(input.name + ".latency"), to_text(instant(latency_of(input.channel))), out);
    say(key_of(input.name), std::string(nothing_word), out);
    if (input.meta)
      declare_meta(input.name, out);
  }
}

void proxy::declare_meta(const std::string& input, outputs& out) {
  auto key = key_of("mi-" + input);
  if (fits_tuple_key(key))
    out.emplace_back(declare{std::move(key), key_of(input)});
  else
    ++counters_.bad_keys;
}

void proxy::enter(state next, instant now, outputs& out) {
  if (state_ == next)
    return;
  state_ = next;
  say_state(now, out);
}

void proxy::say_state(instant now, outputs& out) {
  say(key_of("status.cause"), cause_, out);
  say(key_of("status.since"), to_text(now), out);
  say(key_of("status"), std::string(to_string(state_)), out);
}

/// Signs of life keep a proxy active; that a lost mote is back is the manager's to say.
void proxy::sensed(instant now, outputs& out) {
  last_sensed_ = now;
  if (state_ == state::inactive)
    enter(state::active, now, out);
}

/// In which a request has its outcome for certain: those before it on the channel come first.
duration proxy::latency_of(std::uint16_t channel) const {
  const auto before = std::ranges::count(class_.inputs, channel, &input::channel);
  return (before + 1) * settings_.answer_timeout;
}

void proxy::apply(std::uint16_t channel, input_channel::outputs todo, outputs& out) {
  for (auto& x : todo) {
    if (auto* const work = std::get_if<submit>(&x))
      out.emplace_back(write_device{who_.mote, channel, std::move(work->octets)});
    else if (const auto* const end = std::get_if<settled>(&x)) {
      tell(end->input, end->word, end->outcome, out);
      if (end->outcome != request_outcome::acknowledged)
        continue;
      counters_.slowest = std::max(counters_.slowest, end->after);
      counters_.latency.add(end->after);
    }
  }
}

void proxy::tell(std::size_t input, std::string_view word, request_outcome outcome, outputs& out) {
  const std::string text(to_string(outcome));
  if (outcome == request_outcome::acknowledged)
    ++counters_.acknowledged;
  else
    ++counters_.failed[text];
  say(key_of(class_.inputs[input].name + ".outcome"), shown(word, outcome) + ' ' + text, out);
}

std::optional<instant> proxy::presence_deadline() const {
  if (!last_sensed_ || retired_)
    return std::nullopt;
  if (state_ == state::active && settings_.inactive_after)
    return *last_sensed_ + *settings_.inactive_after;
  if (state_ == state::lost && settings_.retire_after)
    return lost_since_ + *settings_.retire_after;
  return std::nullopt;
}

} // namespace rubicon::proxy
